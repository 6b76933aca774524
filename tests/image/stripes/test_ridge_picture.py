"""Ridge strength over a whole picture: the height of a stripe that answers so."""

import numpy as np
import pytest

from core.image.stripes.ridge_picture import ridge_strength
from core.image.stripes.stripe import StripeSettings

SETTINGS = StripeSettings(width_px=8.0, contrast=50.0)


def stripe(height, sigma_px=2.0, angle=0.3, shape=(120, 160)):
    v, u = np.indices(shape)
    across = (v - shape[0] / 2) * np.cos(angle) - (u - shape[1] / 2) * np.sin(angle)
    return (height * np.exp(-0.5 * (across / sigma_px) ** 2)).astype(np.float32)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2, 1.57])
def test_a_stripe_of_the_expected_width_answers_with_its_height_at_any_angle(angle):
    assert ridge_strength(stripe(80.0, angle=angle), SETTINGS)[60, 80] == pytest.approx(80.0, rel=0.02)


def test_a_constant_or_sloping_background_and_a_dark_stripe_do_not_answer():
    slope = np.linspace(0, 100, 160, dtype=np.float32) * np.ones((120, 1), np.float32)
    inside = (slice(20, -20), slice(20, -20))
    assert ridge_strength(slope, SETTINGS)[inside].max() < 0.01
    assert ridge_strength(-stripe(80.0), SETTINGS)[60, 80] < 0.1


def test_a_wider_or_narrower_stripe_answers_less():
    for sigma in (0.7, 6.0):
        assert ridge_strength(stripe(80.0, sigma_px=sigma), SETTINGS)[60, 80] < 60
