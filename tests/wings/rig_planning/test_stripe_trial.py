import numpy as np
import pytest

from core.simulate.rig import Optics
from core.wings.rig_planning.prediction.seen_stripes import Light, try_stripes

LIGHT = Light(width_px=1.5, background_grey=25.0, single=False)


def test_what_the_extraction_states_of_a_trial_is_how_far_its_points_are_off():
    quality = try_stripes(LIGHT, (20.0, 120.0), Optics(), 0.5)

    assert quality.stated == pytest.approx(quality.actual, rel=0.25)
    assert quality.correlation_px == pytest.approx(quality.actual_correlation_px, rel=0.4)


def test_speckle_costs_precision_that_brightness_does_not_buy_back():
    speckled = try_stripes(LIGHT, (20.0, 120.0), Optics(), 0.5)
    even = try_stripes(LIGHT, (20.0, 120.0), Optics(speckle_contrast=0.0), 0.5)
    bright = np.array([120.0])

    assert speckled.sigma(bright) > 2 * even.sigma(bright)
    assert even.sigma(np.array([20.0])) > 2 * even.sigma(bright)


def test_errors_drawn_scatter_and_hang_together_as_those_of_the_trial():
    quality = try_stripes(LIGHT, (20.0, 120.0), Optics(), 0.5)
    errors = quality.errors(np.full(200_000, 60.0), np.random.default_rng(1))

    assert errors.std() == pytest.approx(np.interp(60.0, quality.heights, quality.actual), rel=0.1)
    of_means = errors.reshape(-1, 200).mean(axis=1).std()
    assert of_means == pytest.approx(errors.std() * np.sqrt(quality.actual_correlation_px / 200), rel=0.1)


def test_the_same_trial_gives_the_same_figures():
    first, second = (try_stripes(LIGHT, (20.0, 100.0 + step), Optics(), 0.5) for step in (0, 0))

    assert np.array_equal(first.stated, second.stated)


def test_light_too_faint_to_be_found_is_no_stripe():
    with pytest.raises(ValueError, match="not found"):
        try_stripes(LIGHT, (0.1, 0.2), Optics(read_noise_grey=10.0), 0.5)
