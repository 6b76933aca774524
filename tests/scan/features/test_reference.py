from dataclasses import replace

import numpy as np
import pytest

from core.image.background import quantile_reference, sample_indices
from core.image.stripes.centreline import Centreline
from core.scan.features.reference import check_reference, fan_stretches, picture_difference

WIDTH = 2.0


def picture(shift: float = 0.0, sweep_at: float | None = None, seed: int | None = None) -> np.ndarray:
    v, u = np.mgrid[0:200, 0:400].astype(np.float32)
    image = 20 + 120 * np.exp(-((v - 100.3 - shift) ** 2) / (2 * WIDTH**2))
    if sweep_at is not None:
        image += 100 * np.exp(-((u - sweep_at) ** 2) / (2 * WIDTH**2))
    if seed is not None:
        image += np.random.default_rng(seed).normal(0, 2, image.shape)
    return image.astype(np.float32)


def fan_line() -> Centreline:
    u = np.arange(20.0, 380.0)
    count = len(u)
    return Centreline(
        np.column_stack([u, np.full(count, 100.3)]),
        np.tile([0.0, 1.0], (count, 1)),
        np.full(count, WIDTH),
        np.full(count, 120.0),
        np.full(count, 0.05),
        np.zeros(count, bool),
    )


@pytest.mark.parametrize("shift", [0.2, 0.5, -0.8])
def test_a_moved_object_is_measured_in_pixels(shift):
    check = check_reference(picture(shift, sweep_at=150.0, seed=1) - picture(seed=2), [fan_line()])
    assert check.shift_px == pytest.approx(abs(shift), rel=0.2, abs=0.03)


def test_a_sweep_across_a_resting_object_is_no_movement():
    check = check_reference(picture(sweep_at=150.0, seed=1) - picture(seed=2), [fan_line()])
    assert check.shift_px < 0.05
    assert not check.lost


@pytest.mark.parametrize("without", [slice(None), slice(0, 360, 2), slice(7, 8)])
def test_light_without_strength_tells_of_no_shift(without):
    line = fan_line()
    strength = line.strength.copy()
    strength[without] = 0.0
    faint = replace(line, strength=strength)
    with np.errstate(divide="raise", invalid="raise"):
        check = check_reference(picture(seed=1) - picture(seed=2), [faint, line])
    stretches = fan_stretches([faint, line])
    assert check.shift_px < 0.05 and not check.lost
    assert len(check.shifts_px) == len(stretches) and np.abs(check.shifts_px).max() < 0.2
    lit = {7: 6}.get(without.start, 0)
    assert [number for number, _ in stretches] == [0] * lit + [1] * 7


def test_light_that_is_gone_is_noticed():
    assert check_reference(picture(shift=40.0) - picture(), [fan_line()]).lost


def test_brighter_room_light_is_measured():
    check = check_reference(picture() + 9 - picture(), [fan_line()])
    assert check.light == pytest.approx(9, abs=0.1)
    assert not check.lost


def test_the_quantile_of_a_scan_is_its_background():
    frames = [picture(sweep_at=20.0 + 25 * i, seed=i).round().clip(0, 255).astype(np.uint8) for i in range(14)]
    background = quantile_reference(frames).astype(float)
    assert np.abs(background - picture()).mean() < 2


def test_two_pictures_are_too_few_for_a_background():
    with pytest.raises(ValueError, match="2 pictures"):
        quantile_reference([picture().astype(np.uint8)] * 2)


def test_samples_are_spread_over_the_scan():
    assert sample_indices(5) == [0, 1, 2, 3, 4]
    assert len(sample_indices(1000)) == 15
    assert sample_indices(1000)[-1] == 999
    assert sample_indices(0) == []


@pytest.mark.parametrize(("levels", "kind"), [(np.uint8, np.int16), (np.uint16, np.float32)])
def test_a_picture_darker_than_the_reference_differs_by_less_than_nothing(levels, kind):
    rng = np.random.default_rng(3)
    highest = np.iinfo(levels).max
    one, other = (rng.integers(0, highest, (37, 53), endpoint=True).astype(levels) for _ in range(2))
    one[0, 0], other[0, 0], one[0, 1], other[0, 1] = 0, highest, highest, 0
    found = picture_difference(one[:, ::2], other[:, ::2])
    assert found.dtype == kind
    assert np.array_equal(found, one[:, ::2].astype(float) - other[:, ::2])
