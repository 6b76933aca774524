"""The skewness of a stripe's section, as the centreline tells it."""

import numpy as np
import pytest

from core.image.stripes.extraction import StripeSettings, extract_centrelines
from core.image.stripes.noise import NoiseModel
from tests.image.synthetic_stripes import expose, straight

SIGMA = 2.0
SHAPE = (160, 220)


def one_sided(angle: float, share: float, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Light of which a share comes evenly from 0 to `reach` σ to one side, and the unit vector (2,) to that side."""
    v, u = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(float)
    distance = straight((110.3, 80.2), angle)
    away = distance(u, v)
    light = (1 - share) * np.exp(-0.5 * (away / SIGMA) ** 2)
    for place in np.linspace(0, reach * SIGMA, 31):
        light += share / 31 * np.exp(-0.5 * ((away - place) / SIGMA) ** 2)
    there = np.array([distance(np.array([1.0]), np.array([0.0])), distance(np.array([0.0]), np.array([1.0]))])[:, 0]
    return 150 * light, there - distance(np.array([0.0]), np.array([0.0]))


def skewness(light: np.ndarray, towards: np.ndarray) -> float:
    rng = np.random.default_rng(1)
    found = extract_centrelines(
        expose(light, rng).astype(np.float32), StripeSettings(4 * SIGMA, 150.0), noise=NoiseModel(1.0, 0.02)
    )
    assert len(found) == 1
    return float(np.mean(found[0].skewness * np.sign(found[0].normal @ towards)))


@pytest.mark.parametrize("angle_deg", [3.0, 50.0, 94.0, 200.0])
def test_a_symmetric_stripe_is_not_skewed(angle_deg):
    assert abs(skewness(*one_sided(np.radians(angle_deg), 0.0, 1.0))) < 0.015


@pytest.mark.parametrize("angle_deg", [3.0, 50.0, 94.0, 200.0])
def test_skewness_tells_the_side_to_which_light_reaches_further(angle_deg):
    """0.12 by a fit to the very section (35 % of the light evenly over 1.5 σ)."""
    assert skewness(*one_sided(np.radians(angle_deg), 0.35, 1.5)) == pytest.approx(0.12, abs=0.03)
    assert skewness(*one_sided(np.radians(angle_deg), 0.35, -1.5)) == pytest.approx(-0.12, abs=0.03)
