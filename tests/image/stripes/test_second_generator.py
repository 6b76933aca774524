"""Centrelines on pictures of a second generator are near the bound, whichever way they run, speckled or not."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings, extract_centrelines
from core.image.stripes.positions import _disagreement_px
from core.image.stripes.runs import arc_length
from core.image.stripes.speckle import NO_SPECKLE, Speckle
from core.image.stripes.told_width import as_measured, stated_width_notes
from tests.image.bound import Stripe
from tests.image.second_generator import NOISE, bound, picture

ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 90.0)
STRIPE, GRAINS = Stripe(2.5, 150.0, 20.0), Speckle(0.2, 2.0)
MEAN_PX, MARGIN_PX = 60, 40


@cache
def found(angle_deg: float, speckle: Speckle, told: float = 1.0) -> list[tuple[np.ndarray, Centreline]]:
    """Errors in px of seeded stripes of some 400 px, told to be `told` times as wide as they are."""
    rng, lines = np.random.default_rng([5, int(angle_deg)]), []
    length, pictures = (700, 20) if speckle == NO_SPECKLE else (400, 12)
    across = np.array([-np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg))])
    shape = tuple(int(length * abs(side)) + 2 * MARGIN_PX for side in (across[0], across[1]))
    for _ in range(pictures):
        point = np.array(shape[::-1]) / 2 + rng.random(2)
        light = picture((shape[0], shape[1]), (point[0], point[1]), angle_deg, STRIPE, speckle, rng)
        settings = StripeSettings(4 * STRIPE.width * told, STRIPE.height)
        _, seen = as_measured(settings, partial(extract_centrelines, light, noise=NOISE))
        lines.append(((seen[0].uv - point) @ across, seen[0]))
    return lines


def means(angle_deg: float, speckle: Speckle, told: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Means over MEAN_PX of arc, over their bound and over their stated σ; windows reach a little over the ends."""
    over_bound, over_sigma = [], []
    filter_px = StripeSettings(4 * STRIPE.width, STRIPE.height).filter_px
    overlap = np.sqrt(1 - 2 / np.sqrt(np.pi) * filter_px / MEAN_PX)
    for error, line in found(angle_deg, speckle, told):
        part = (arc_length(line.uv) // MEAN_PX).astype(int)
        for number in range(part.max()):
            mean = float(error[part == number].mean())
            over_bound.append(mean * np.sqrt(MEAN_PX) / overlap / bound(STRIPE, speckle))
            sigma = float(np.median(line.sigma[part == number]))
            over_sigma.append(mean / (overlap * sigma * np.sqrt(line.correlation_px / MEAN_PX)))
    return np.array(over_bound), np.array(over_sigma)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.accuracy
@pytest.mark.parametrize(("speckle", "most"), [(NO_SPECKLE, 1.05), (GRAINS, 1.15)], ids=["plain", "speckled"])
def test_means_along_a_stripe_are_near_the_bound(speckle: Speckle, most: float) -> None:
    """Each angle has few means, and is allowed three standard errors more; all together have many."""
    ratios = {angle: means(angle, speckle) for angle in ANGLES}
    for angle, (over_bound, over_sigma) in ratios.items():
        print(f"{angle:3.0f}°: {rms(over_bound):.3f} × the bound, {rms(over_sigma):.3f} × σ, {len(over_bound)} means")
        assert rms(over_bound) < most + 3 / np.sqrt(2 * len(over_bound))
    assert rms(np.concatenate([one for one, _ in ratios.values()])) < most
    assert rms(np.concatenate([one for _, one in ratios.values()])) == pytest.approx(1.0, abs=0.06)


def test_a_short_speckled_stripe_is_not_taken_for_a_skewed_one_by_chance() -> None:
    """348 points, 0.043 px apart on the whole by two estimators, scattered by 0.14 px over 12 px: seen, and no skew."""
    assert _disagreement_px([(348, 0.0429, 0.0187)], 12.4) == 0.0
    assert _disagreement_px([(3480, 0.0429, 0.0187)], 12.4) == pytest.approx(0.042, abs=0.002)
    assert _disagreement_px([], 12.4) == 0.0


@pytest.mark.parametrize("told", [0.6, 1.6])
@pytest.mark.parametrize("angle_deg", [0.0, pytest.param(30.0, marks=pytest.mark.accuracy)])
def test_a_wrong_width_makes_neither_the_line_nor_its_sigma_worse(angle_deg: float, told: float) -> None:
    wrong, right = (means(angle_deg, NO_SPECKLE, width) for width in (told, 1.0))
    assert rms(wrong[0]) == pytest.approx(rms(right[0]), rel=0.1)
    assert rms(wrong[1]) == pytest.approx(rms(right[1]), rel=0.1)


def test_a_width_is_told_to_be_wrong_only_where_it_is_quite_another() -> None:
    told, near, far = StripeSettings(6.0, 100.0), StripeSettings(7.0, 90.0), StripeSettings(10.04, 80.0)
    assert stated_width_notes(told, [near, None]) == ()
    assert stated_width_notes(None, [far]) == ()
    (note,) = stated_width_notes(told, [near, far])
    assert "told to be 6.0 px wide, but are 10.0 px" in str(note)
