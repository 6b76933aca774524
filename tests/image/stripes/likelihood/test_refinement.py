"""Centrelines at the Cramér–Rao bound, with and without speckle, and what must not pull them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval

from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings, extract_centrelines
from core.image.stripes.likelihood.influence import REACH, influences
from core.image.stripes.likelihood.refinement import cuts_of, residuals
from core.image.stripes.noise import NoiseModel
from core.image.stripes.profile import Sections
from core.image.stripes.speckle import NO_SPECKLE, Speckle, measure_speckle
from tests.image.bound import Stripe, bound_of_mean, bound_per_root_px
from tests.image.synthetic_stripes import Distance, circle, draw, expose, speckle, straight

NOISE = NoiseModel(float(np.sqrt(1 + 1 / 12)), 0.02)
"""Read noise of one grey level, rounding, and shot noise."""
QUIET = NoiseModel(0.3)
LENGTH = 60
"""Stripe px that are averaged, much more than a grain."""

PLAIN = [(Stripe(2.5, 150.0), NO_SPECKLE), (Stripe(1.5, 150.0), NO_SPECKLE), (Stripe(2.5, 30.0), NO_SPECKLE)]
SPECKLED = [
    (Stripe(2.5, 150.0), Speckle(0.2, 2.0)),
    (Stripe(1.5, 150.0), Speckle(0.2, 2.0)),
    (Stripe(2.5, 150.0), Speckle(0.18, 2.24)),  # the twin's, at full
    (Stripe(1.5, 150.0), Speckle(0.18, 1.41)),  # and at half resolution
    (Stripe(2.5, 150.0, 20.0, 0.1), Speckle(0.2, 2.0)),
]


def find(light: np.ndarray, stripe: Stripe, noise: NoiseModel = QUIET, **masks: np.ndarray) -> tuple[Centreline, ...]:
    settings = StripeSettings(4 * stripe.width, stripe.height)
    return extract_centrelines(light.astype(np.float32), settings, noise=noise, **masks)


def errors(line: Centreline, truth: Distance) -> np.ndarray:
    return truth(line.uv[:, 0], line.uv[:, 1])


@cache
def sampled(
    stripe: Stripe, grains: Speckle, pictures: int = 14, length: int = 3000
) -> list[tuple[np.ndarray, Centreline]]:
    """Errors and centrelines of seeded pictures of a long slanting stripe."""
    rng = np.random.default_rng(8)
    found = []
    for _ in range(pictures):
        half = int(np.ceil(10 * stripe.width)) + 8
        truth = straight((half + 26 + rng.random(), length / 2), np.radians(89.0))
        v, u = np.mgrid[:length, : 2 * half + 52]
        x = truth(u, v)
        blurred = np.sqrt(stripe.width**2 + 1 / 12)
        light = stripe.height * stripe.width / blurred * np.exp(-0.5 * (x / blurred) ** 2)
        if grains.contrast > 0:
            light *= speckle(light.shape, grains.contrast, grains.grain_px / np.sqrt(2), rng)
        picture = np.round(expose(light + stripe.background + stripe.slope * x, rng))
        (line,) = find(picture, stripe, NOISE)
        found.append((errors(line, truth), line))
    return found


def means(error: np.ndarray, length: int) -> np.ndarray:
    number = len(error) // length
    return error[: number * length].reshape(number, length).mean(axis=1)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def overlap(stripe: Stripe, length: int) -> float:
    """By how much means over so many px scatter less because averaged points reach a little over their ends."""
    filter_px = StripeSettings(4 * stripe.width, stripe.height).filter_px
    return float(np.sqrt(1 - 2 / np.sqrt(np.pi) * filter_px / length))


def inefficiency(stripe: Stripe, grains: Speckle) -> float:
    """Scatter of means over LENGTH px over their bound."""
    scatter = rms(np.concatenate([means(error, LENGTH) for error, _ in sampled(stripe, grains)]))
    return scatter * np.sqrt(LENGTH) / overlap(stripe, LENGTH) / bound_per_root_px(stripe, NOISE, grains)


@pytest.mark.parametrize(("stripe", "grains"), PLAIN)
def test_without_speckle_the_bound_is_reached(stripe: Stripe, grains: Speckle) -> None:
    assert inefficiency(stripe, grains) < 1.05


@pytest.mark.parametrize(("stripe", "grains"), SPECKLED)
def test_with_speckle_the_same_estimator_is_near_its_bound(stripe: Stripe, grains: Speckle) -> None:
    assert inefficiency(stripe, grains) < 1.25


@pytest.mark.parametrize(("stripe", "grains"), PLAIN + SPECKLED)
def test_points_and_their_means_are_as_uncertain_as_stated(stripe: Stripe, grains: Speckle) -> None:
    found = sampled(stripe, grains)
    assert rms(np.concatenate([error / line.sigma for error, line in found])) == pytest.approx(1.0, abs=0.06)
    for length in (LENGTH, 150):
        stated = [np.median(line.sigma) * np.sqrt(line.correlation_px / length) for _, line in found]
        scale = overlap(stripe, length)
        normalised = [means(error, length) / (scale * s) for (error, _), s in zip(found, stated, strict=True)]
        assert rms(np.concatenate(normalised)) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("grains", [NO_SPECKLE, Speckle(0.2, 2.0)])
@pytest.mark.parametrize("width", [1.5, 2.5])
def test_a_sloping_background_does_not_pull(grains: Speckle, width: float) -> None:
    found = sampled(Stripe(width, 150.0, 20.0, 0.1), grains, 7)
    assert abs(np.concatenate([error for error, _ in found]).mean()) < 0.006


def test_the_bound_of_a_long_stripe_is_the_one_per_root_px() -> None:
    stripe, grains = Stripe(1.5, 150.0), Speckle(0.2, 1.4)
    assert bound_of_mean(stripe, NOISE, None, 20) * np.sqrt(20) == pytest.approx(bound_per_root_px(stripe, NOISE))
    of_forty = bound_of_mean(stripe, NOISE, grains, 40) * np.sqrt(40)
    assert of_forty == pytest.approx(bound_per_root_px(stripe, NOISE, grains), rel=0.03)


@pytest.mark.parametrize("width", [1.0, 1.5, 2.5])
@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 45.0, 90.0])
def test_places_within_a_pixel_agree(width: float, angle_deg: float) -> None:
    across = np.array([-np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg))])
    found = []
    for place in np.linspace(0, 1, 7, endpoint=False):
        truth = straight(tuple(np.array([70.0, 60.0]) + place * across), np.radians(angle_deg))
        (line,) = find(draw((120, 140), truth, width, 150.0, samples=6), Stripe(width, 150.0))
        found.append(errors(line, truth))
    assert np.abs(np.concatenate(found)).max() < 0.002


@pytest.mark.parametrize(("radius", "width"), [(60.0, 1.5), (120.0, 2.5), (400.0, 2.5)])
def test_bent_stripes_are_where_they_are(radius: float, width: float) -> None:
    truth = circle((110.2, radius + 30.4), radius)
    lines = find(draw((160, 220), truth, width, 150.0), Stripe(width, 150.0))
    assert np.abs(np.concatenate([errors(line, truth) for line in lines])).max() < 0.003


@pytest.mark.parametrize("width", [1.5, 2.5])
def test_the_tightest_circles_keep_their_size(width: float) -> None:
    """Of 17 stripe σ radius: a bend does not pull, even where the open ends of a stripe are a hundredth of a px off."""
    radius = 17 * width
    truth = circle((radius + 40.2, radius + 40.4), radius)
    lines = find(draw((int(2 * radius) + 90,) * 2, truth, width, 150.0), Stripe(width, 150.0))
    error = np.concatenate([errors(line, truth) for line in lines])
    assert abs(error.mean()) < 0.003
    assert np.abs(error).max() < 0.02
    assert len(error) > 0.75 * 2 * np.pi * radius


@pytest.mark.parametrize("over", [1.5, 4.0])
@pytest.mark.parametrize("angle_deg", [3.0, 30.0])
def test_saturation_does_not_pull(over: float, angle_deg: float) -> None:
    truth = straight((110.0, 80.3), np.radians(angle_deg))
    light = draw((160, 220), truth, 2.5, 255.0 * over)
    (line,) = find(np.minimum(light, 255.0), Stripe(2.5, 255.0), saturated=light >= 255)
    assert line.saturated.all()
    assert np.abs(errors(line, truth)).max() < 0.003


@pytest.mark.parametrize("angle_deg", [20.0, 70.0])
def test_the_border_of_the_picture_does_not_pull(angle_deg: float) -> None:
    truth = straight((110.0, 80.3), np.radians(angle_deg))
    (line,) = find(draw((160, 220), truth, 2.5, 150.0), Stripe(2.5, 150.0))
    reach = 7 * StripeSettings(10.0, 150.0).filter_px  # of the filter, and what is cut from the end of a stripe
    assert min(line.uv.min(), *(np.array([220, 160]) - 1 - line.uv.max(axis=0))) < reach
    assert np.abs(errors(line, truth)).max() < 0.003


def test_other_light_beside_a_stripe_pulls_little() -> None:
    truth = straight((110.0, 80.3), 0.1)
    v, u = np.mgrid[:160, :220]
    spot = 120 * np.exp(-0.5 * ((u - 100) ** 2 + (truth(u, v) - 12) ** 2) / 1.5**2)
    (line,) = find(draw((160, 220), truth, 2.5, 150.0) + spot, Stripe(2.5, 150.0))
    assert np.abs(errors(line, truth)).max() < 0.02


ACROSS = np.linspace(-REACH, REACH, 73)
"""Places on a section, in its σ."""


def weights(height: float, background: float, width: float, grains: Speckle) -> np.ndarray:
    (found,), _ = influences((height,), background, width, NOISE, grains)
    return np.asarray(ACROSS * polyval(2 * (ACROSS / REACH) ** 2 - 1, found))


def test_without_speckle_the_weights_are_the_plain_ones() -> None:
    x = ACROSS * 2.0
    section = 120.0 * np.exp(-0.5 * (x / 2.0) ** 2)
    variance = NOISE.variance(10.0 + section)
    plain = section * x / 4.0 / variance
    plain -= np.sum(plain * x) / np.sum(x**2 / variance) * x / variance
    assert influences((120.0,), 10.0, 2.0, NOISE, NO_SPECKLE)[1] == pytest.approx(0.0, abs=1e-9)
    assert np.abs(weights(120.0, 10.0, 2.0, NO_SPECKLE) - plain).max() < 0.05 * np.abs(plain).max()


def test_speckle_moves_the_weight_to_the_flanks() -> None:
    grains = Speckle(0.2, 2.0)
    plain, speckled = (np.abs(weights(150.0, 0.0, 2.5, g)) for g in (NO_SPECKLE, grains))
    assert np.average(np.abs(ACROSS), weights=speckled) > np.average(np.abs(ACROSS), weights=plain) + 0.12
    assert 0.5 < influences((150.0,), 0.0, 2.5, NOISE, grains)[1][0] < 1


@pytest.mark.parametrize("grains", [Speckle(0.1, 2.0), Speckle(0.2, 1.41), Speckle(0.2, 2.24)])
@pytest.mark.parametrize("angle_deg", [88.0, 40.0])
def test_speckle_is_measured_on_the_stripe(grains: Speckle, angle_deg: float) -> None:
    found = _residuals_of(grains, angle_deg, lambda x: np.exp(-0.5 * (x / 2.0) ** 2))
    assert found.contrast == pytest.approx(grains.contrast, rel=0.15)
    assert found.grain_px == pytest.approx(grains.grain_px, rel=0.2)


def test_neither_noise_nor_a_section_of_another_shape_is_speckle() -> None:
    assert _residuals_of(NO_SPECKLE, 88.0, lambda x: np.exp(-0.5 * (x / 2.0) ** 2)) == NO_SPECKLE
    assert _residuals_of(NO_SPECKLE, 88.0, lambda x: np.exp(-((np.abs(x) / 2.8) ** 2.4))).contrast < 0.02


def _residuals_of(grains: Speckle, angle_deg: float, section: Callable[[np.ndarray], np.ndarray]) -> Speckle:
    """What is measured on a noisy stripe of this cross-section."""
    rng = np.random.default_rng(4)
    angle = np.radians(angle_deg)
    length = 1500
    shape = (int(length * np.sin(angle)) + 40, int(length * np.cos(angle)) + 40)
    truth = straight((shape[1] / 2, shape[0] / 2), angle)
    v, u = np.mgrid[: shape[0], : shape[1]]
    light = 120.0 * section(truth(u, v))
    if grains.contrast > 0:
        light *= speckle(light.shape, grains.contrast, grains.grain_px / np.sqrt(2), rng)
    picture = np.round(expose(light, rng)).astype(np.float32)
    along = np.linspace(-length / 2 + 60, length / 2 - 60, length - 120)
    across = np.array([-np.sin(angle), np.cos(angle)])
    run = np.column_stack([shape[1] / 2 + along * np.cos(angle), shape[0] / 2 + along * np.sin(angle)])
    flat = np.ones(len(run))
    width = np.hypot(2.0, 12**-0.5)
    sections = Sections(120.0 * 2.0 / width * flat, width * flat, 0 * flat, 0 * flat)
    state = np.zeros(shape, dtype=np.uint8)
    curve = np.column_stack([run, np.tile(across, (len(run), 1)), 0 * flat])
    return measure_speckle([residuals(picture, state, curve, sections)], 2.0)


def test_where_the_section_is_no_gaussian_speckle_does_not_move_the_place() -> None:
    """Weights on the flanks of a spot with a halo would; and a calibration may have less speckle than a scan."""
    rng = np.random.default_rng(6)
    truth = straight((60.3, 400.0), np.radians(89.0))
    v, u = np.mgrid[:800, :120]
    x = truth(u, v)
    light = 150.0 * (np.exp(-0.5 * (x / 2.5) ** 2) + 0.08 * np.exp(-0.5 * ((x - 6) / 3.0) ** 2))
    places = []
    for contrast in (0.0, 0.05, 0.2):
        grains = speckle(light.shape, contrast, 1.4, rng) if contrast else 1.0
        lines = [find(np.round(expose(light * grains, rng)), Stripe(2.5, 150.0), NOISE) for _ in range(2)]
        places.append(np.mean([errors(line, truth).mean() for (line,) in lines]))
    assert np.ptp(places) < 0.06


@pytest.mark.parametrize("spacing", [0.7, 1.0, 2.4])
@pytest.mark.parametrize("angle_deg", range(0, 360, 15))
def test_rows_and_columns_cut_a_line_in_order_whichever_way_it_runs(angle_deg: int, spacing: float) -> None:
    angle = np.radians(angle_deg + 1.0)
    along = np.arange(0, 60, spacing)
    tangent = np.array([np.cos(angle), np.sin(angle)])
    run = np.column_stack([np.outer(along, tangent) + 100.3, np.full((len(along), 2), [tangent[1], -tangent[0]])])
    cuts = cuts_of(run, along)
    assert np.all(np.diff(cuts[:, 0]) > 0)
    assert len(cuts) == pytest.approx(along[-1] * np.abs(tangent).max(), abs=1)


@pytest.mark.parametrize("degrees", [20.0, 44.0, 110.0, 140.0])
@pytest.mark.parametrize("fade", [0.02, -0.02], ids=["fading", "brightening"])
@pytest.mark.parametrize("width", [1.5, 2.5])
def test_a_slanting_stripe_that_fades_along_itself_is_not_pulled_aside(degrees, fade, width):
    truth = straight((100.0, 100.0), np.radians(degrees))
    along = straight((100.0, 100.0), np.radians(degrees + 90.0))
    v, u = np.mgrid[:200, :200].astype(float)
    light = 100 * np.exp(-0.5 * (truth(u, v) / width) ** 2 - fade * along(u, v))
    (line,) = find(light, Stripe(width, 100.0), NOISE)
    middle = np.abs(along(*line.uv.T)) < 40
    assert np.abs(errors(line, truth)[middle]).max() < 0.002
