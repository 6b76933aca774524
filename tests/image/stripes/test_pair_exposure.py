"""Two pictures of a pair: how one is exposed beside the other, whatever the laser lights in it."""

import numpy as np
import pytest

from core.image.stripes.exchanged import are_exchanged, light_off_over_on
from core.image.stripes.pair_exposure import Exposed


def pair(gain=1.0, offset=0.0, seed=1):
    """Dark room with a plate of squares, a tenth of the picture, crossed by three stripes in the first picture."""
    rng = np.random.default_rng(seed)
    off = np.full((300, 400), 4.0)
    squares = 15.0 + 65.0 * (np.indices((95, 130)).sum(axis=0) // 12 % 2)
    off[100:195, 120:250] = squares
    on = gain * off + offset
    for column in (140, 180, 220):
        on[100:195] += 60.0 * gain * np.exp(-0.5 * ((np.arange(400) - column) / 2.0) ** 2)
    return tuple(
        np.clip(np.round(each + rng.normal(0, 1.0, each.shape)), 0, 255).astype(np.uint8) for each in (on, off)
    )


@pytest.mark.parametrize(("gain", "offset"), [(0.6, 0.0), (1.4, 0.0), (1.2, 6.0)])
def test_gain_and_offset_are_those_of_the_pictures(gain, offset):
    found = Exposed.of(*pair(gain, offset), 255.0)
    assert found.gain == pytest.approx(gain, rel=0.02)
    assert found.gain * 80 + found.offset == pytest.approx(gain * 80 + offset, abs=1.0)


@pytest.mark.parametrize("seed", range(5))
def test_pictures_exposed_alike_are_left_as_they_are(seed):
    assert Exposed.of(*pair(seed=seed), 255.0) == Exposed()


def test_pictures_of_one_grey_say_nothing():
    flat = np.full((40, 40), 90, np.uint8)
    assert Exposed.of(flat, flat // 2, 255.0) == Exposed()


def test_a_longer_exposure_with_the_fan_off_is_not_taken_for_the_fan():
    assert not are_exchanged([light_off_over_on(*pair(0.4))])
    on, off = pair(0.4)
    assert are_exchanged([light_off_over_on(off, on)])
