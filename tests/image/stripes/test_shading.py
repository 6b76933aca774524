import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.image.stripes.shading import shading_sigma


def line_of(strength: np.ndarray, width: float = 1.5) -> Centreline:
    count = len(strength)
    flat = np.full(count, 0.05)
    return Centreline(
        np.column_stack([np.arange(count) + 50.0, np.full(count, 80.0)]),
        np.tile([0.0, 1.0], (count, 1)),
        np.full(count, width),
        strength,
        flat,
        np.zeros(count, bool),
    )


def test_an_evenly_lit_stripe_is_not_suspected_even_if_it_speckles():
    speckled = 100 * (1 + np.random.default_rng(1).normal(0, 0.15, 400))
    assert np.median(shading_sigma(line_of(speckled))) < 0.01


def test_light_that_fades_by_two_percent_a_pixel_may_move_the_crest_by_its_share():
    fading = line_of(100 * np.exp(-0.02 * np.arange(200)))
    assert shading_sigma(fading)[60:140] == pytest.approx(1.5**2 * 0.02, rel=0.02)


def test_a_few_points_say_nothing():
    assert not shading_sigma(line_of(np.full(4, 100.0))).any()
