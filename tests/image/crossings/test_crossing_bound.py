"""Crossings against their bound and σ against sampling, on simulated centrelines and on rendered stripes.

`pytest -rP` prints the table. All is measured with the noise that extraction leaves: correlated along the line.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from core.image.crossings.crossing import Crossing, cross_centrelines
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import StripeSettings, extract_centrelines
from core.image.stripes.noise import NoiseModel
from tests.image.crossing_bound import Line, crossing_bound, curvature_integral, kriging_bound, section_density
from tests.image.synthetic_stripes import draw, expose, speckle, straight

SIGMA, CORRELATION = 0.02, 7.4
DENSITY = SIGMA * np.sqrt(CORRELATION)
ARM = 120.0
ANGLES = (20.0, 30.0, 45.0, 60.0, 90.0)
Shape = Callable[[np.ndarray], np.ndarray]


def flat(x: np.ndarray) -> np.ndarray:
    return np.zeros_like(x)


def noisy_line(
    shape: Shape, angle: float, rng: np.random.Generator, first: float = -ARM, last: float = ARM
) -> Centreline:
    """A curve y(x) through the origin, turned by `angle`, with noise as a Gaussian filter along it leaves it."""
    x = np.arange(first - rng.uniform(0, 1), last)
    filter_px = CORRELATION / (2 * np.sqrt(np.pi))
    white = rng.standard_normal(len(x) + 80)
    noise = gaussian_filter1d(white, filter_px)[40:-40] * SIGMA * np.sqrt(CORRELATION)
    y = shape(x)
    slope = np.gradient(y, x)
    across = np.column_stack([-slope, np.ones(len(x))]) / np.hypot(1, slope)[:, None]
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    uv = (np.column_stack([x, y]) + noise[:, None] * across) @ turn
    ones = np.ones(len(x))
    return Centreline(
        uv, -across @ turn, 1.5 * ones, 100 * ones, SIGMA * ones, np.zeros(len(x), dtype=bool), CORRELATION
    )


def sampled(shape: Shape, angle_deg: float, count: int, seed: int = 1) -> list[Crossing]:
    """Crossings at the origin of two lines of one shape, each with noise of its own, turned anyhow."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        first = rng.uniform(0, 2 * np.pi)
        lines = [noisy_line(shape, angle, rng) for angle in (first, first + np.radians(angle_deg))]
        found += [crossing for _, _, crossing in cross_centrelines([lines[0]], [lines[1]], 40.0, 0.2)]
    assert len(found) > 0.97 * count
    return found


def rms_error(crossings: list[Crossing], place: tuple[float, float] = (0.0, 0.0)) -> float:
    return float(np.sqrt(np.mean([np.sum((c.uv - place) ** 2) for c in crossings])))


def normalised_error(crossings: list[Crossing]) -> float:
    """Root mean square of the errors in their own standard uncertainties: 1 where the covariance is true."""
    return float(np.sqrt(np.mean([c.uv @ np.linalg.solve(c.covariance, c.uv) / 2 for c in crossings])))


def best(angle_deg: float, degree: int) -> float:
    line = Line(DENSITY, -ARM, ARM, degree)
    return float(np.sqrt(np.trace(crossing_bound(line, line, np.radians(angle_deg)))))


def test_the_bound_is_that_of_a_mean_for_straight_lines_and_half_as_much_again_for_parabolas() -> None:
    line = DENSITY / np.sqrt(2 * ARM)
    assert best(90.0, 1) == pytest.approx(np.sqrt(2) * line, rel=1e-3)
    assert best(30.0, 1) == pytest.approx(np.sqrt(2) * line / 0.5, rel=1e-3)
    assert best(90.0, 2) == pytest.approx(1.5 * best(90.0, 1), rel=2e-3)
    x = np.linspace(-ARM, ARM, 161)
    assert kriging_bound(DENSITY, x, 1e-9, 60.0) == pytest.approx(line, rel=0.01)
    assert kriging_bound(DENSITY, x, 1e-3, 1e12) == pytest.approx(1.5 * line, rel=0.01)


def bent(x: np.ndarray) -> np.ndarray:
    """As lens distortion bends a line: 0.3 px from its chord."""
    return 2e-5 * x**2


@pytest.mark.parametrize("shape", [flat, bent])
def test_lines_cross_at_the_bound(shape: Shape) -> None:
    """At that of parabolas, at any angle: whether a line is straight is not known before."""
    ratios, honest = [], []
    for angle_deg in ANGLES:
        found = sampled(shape, angle_deg, 300, seed=int(angle_deg))
        ratios.append(rms_error(found) / best(angle_deg, 2))
        honest.append(normalised_error(found))
        print(f"{shape.__name__} {angle_deg:3.0f}°: {ratios[-1]:.3f} × the bound, normalised error {honest[-1]:.3f}")
    assert np.sqrt(np.mean(np.square(ratios))) < 1.1
    assert max(ratios) < 1.2
    assert 0.95 < np.sqrt(np.mean(np.square(honest))) < 1.05


@pytest.mark.parametrize(
    ("curvature", "length"),
    [(1e-4, 100.0), *(pytest.param(1e-3, length, marks=pytest.mark.accuracy) for length in (40.0, 20.0))],
)
def test_lines_of_changing_curvature_cross_as_if_one_knew_how_it_changes(curvature: float, length: float) -> None:
    """The bound is that of kriging that knows the standard deviation (1/px) and correlation length of the curvature."""
    rng = np.random.default_rng(7)
    places = np.arange(-ARM - 2, ARM + 2)
    integral = curvature_integral(places)
    decay = np.exp(-1 / length)

    def wavy(x: np.ndarray) -> np.ndarray:
        steps = rng.standard_normal(len(places)) * np.sqrt(1 - decay**2)
        steps[0] = rng.standard_normal()
        return np.interp(x, places, integral @ lfilter([1.0], [1.0, -decay], curvature * steps))

    found = sampled(wavy, 90.0, 500)
    limit = np.sqrt(2) * kriging_bound(DENSITY, places[2:-2], curvature, length)
    ratio, honest = rms_error(found) / limit, normalised_error(found)
    print(f"curvature {curvature}/px over {length:.0f} px: {ratio:.3f} × the bound, normalised error {honest:.3f}")
    assert ratio < 1.25
    assert 0.85 < honest < 1.2


def test_near_the_end_of_a_line_sigma_grows_and_stays_true() -> None:
    rng = np.random.default_rng(3)
    errors, sigmas = [], []
    for _ in range(300):
        line, other = noisy_line(flat, 0.0, rng, first=-12.0), noisy_line(flat, 1.3, rng)
        ((_, _, crossing),) = cross_centrelines([line], [other], 40.0, 0.2)
        normal = np.array([-crossing.tangent_a[1], crossing.tangent_a[0]])
        errors.append(crossing.uv @ normal / crossing.sigma_a)
        sigmas.append(crossing.sigma_a)
    assert np.median(sigmas) > 1.5 * DENSITY / np.sqrt(2 * ARM)
    # the other line's error lies along this one and does not count
    assert 0.8 < np.sqrt(np.mean(np.square(errors))) < 1.1


def crossings_near_a_break(shape: Shape, at: float, count: int = 150) -> tuple[float, float]:
    """RMS of the error across a line that breaks `at` px beyond the crossing: in px, and in its own σ."""
    rng = np.random.default_rng(5)
    errors, normalised = [], []
    for _ in range(count):
        line, other = noisy_line(lambda x: shape(x - at), 0.0, rng), noisy_line(flat, np.pi / 2, rng)
        for _, _, crossing in cross_centrelines([line], [other], 40.0, 0.2):
            errors.append(crossing.uv[1])
            normalised.append(errors[-1] / crossing.sigma_a)
    assert len(errors) > 0.9 * count  # a kink that hardly shows may be looked for just where the lines cross
    return float(np.sqrt(np.mean(np.square(errors)))), float(np.sqrt(np.mean(np.square(normalised))))


def one_sided(at: float) -> float:
    """Bound of a parabola that ends at `at`."""
    line = Line(DENSITY, -ARM, at, 2)
    return float(np.sqrt(crossing_bound(line, Line(1e-6, -ARM, ARM), np.pi / 2)[1, 1]))


@pytest.mark.parametrize("at", [16.0, 40.0, 80.0])
@pytest.mark.parametrize("kink", [0.005, 0.02, 0.06])
def test_a_fit_does_not_cross_the_ridge_of_a_roof(kink: float, at: float) -> None:
    error, normalised = crossings_near_a_break(lambda x: kink * np.maximum(x, 0), at)
    print(
        f"kink of {kink} rad {at:.0f} px away: {error:.4f} px, {error / one_sided(at):.2f} × one side's bound, "
        f"normalised error {normalised:.2f}"
    )
    assert error < 1.6 * one_sided(at)
    assert normalised < 1.5


@pytest.mark.parametrize("at", [16.0, 40.0])
@pytest.mark.parametrize("step", [0.2, 0.5, 3.0])
def test_a_fit_does_not_cross_a_step(step: float, at: float) -> None:
    error, normalised = crossings_near_a_break(lambda x: step * (x > 0), at)
    print(
        f"step of {step} px {at:.0f} px away: {error:.4f} px, {error / one_sided(at):.2f} × one side's bound, "
        f"normalised error {normalised:.2f}"
    )
    assert error < 1.6 * one_sided(at)
    assert normalised < 1.5


def test_crossings_on_one_line_share_their_errors_as_the_table_says() -> None:
    """Correlation of the errors across one line at 0 … 160 px from each other, sampled and from cells and shares."""
    rng = np.random.default_rng(9)
    places = np.array([0.0, 20.0, 60.0, 160.0])
    errors, stated = [], []
    for _ in range(400):
        line = noisy_line(flat, 0.0, rng, -200.0, 360.0)
        row, fits = [], []
        for place in places:
            other = noisy_line(flat, np.pi / 2, rng)
            moved = Centreline(
                other.uv + [place, 0], other.normal, other.width, other.strength, other.sigma, other.saturated, 7.4
            )
            ((_, _, crossing),) = cross_centrelines([line], [moved], 40.0, 0.2)
            row.append(crossing.uv[1])
            fits.append(np.zeros(40))
            fits[-1][crossing.cell_a : crossing.cell_a + len(crossing.share_a)] = crossing.share_a / crossing.sigma_a
        errors.append(row)
        stated.append([fits[0] @ fit for fit in fits[1:]])
    sampled_correlation = np.corrcoef(np.array(errors).T)[0, 1:]
    print("sampled", np.round(sampled_correlation, 2), "stated", np.round(np.mean(stated, axis=0), 2))
    np.testing.assert_allclose(np.mean(stated, axis=0), sampled_correlation, atol=0.25)


NOISE = NoiseModel(1.0, 0.02)
WIDTH, HEIGHT, SIDE = 1.5, 120.0, 230


@functools.cache
def rendered(angle_deg: float, contrast: float, count: int) -> tuple[tuple[np.ndarray, Crossing], ...]:
    """Errors (2,) of crossings of two rendered straight stripes, with speckle of the given contrast."""
    rng = np.random.default_rng(int(angle_deg) + 1)
    settings = StripeSettings(4 * WIDTH, HEIGHT)
    found = []
    for _ in range(count):
        centre = SIDE / 2 + rng.uniform(-0.5, 0.5, 2)
        first = rng.uniform(0, np.pi)
        lines = []
        for angle in (first, first + np.radians(angle_deg)):
            light = draw((SIDE, SIDE), straight(tuple(centre), angle), WIDTH, HEIGHT, samples=3)
            if contrast:
                light = light * speckle(light.shape, contrast, 1.4, rng)
            lines.append(extract_centrelines(expose(light, rng).astype(np.float32), settings, noise=NOISE))
        for _, _, crossing in cross_centrelines(lines[0], lines[1], 40.0, 0.2):
            found.append((crossing.uv - centre, crossing))
    return tuple(found)


@pytest.mark.accuracy
@pytest.mark.parametrize("angle_deg", ANGLES)
def test_rendered_stripes_cross_near_the_bound_of_their_pixels(angle_deg: float) -> None:
    found = rendered(angle_deg, 0.0, 40)
    assert len(found) >= 39
    line = Line(section_density(HEIGHT, WIDTH, 1.0, 0.02), -105.0, 105.0, 2)
    limit = np.sqrt(np.trace(crossing_bound(line, line, np.radians(angle_deg))))
    ratio = np.sqrt(np.mean([e @ e for e, _ in found])) / limit
    honest = np.sqrt(np.mean([e @ np.linalg.solve(c.covariance, e) / 2 for e, c in found]))
    print(f"rendered  {angle_deg:3.0f}°: {ratio:.3f} × the bound, normalised error {honest:.3f}")
    assert ratio < 1.5
    assert 0.65 < honest < 1.3


@pytest.mark.accuracy
def test_rendered_stripes_with_speckle_are_as_sure_as_they_say() -> None:
    found = rendered(60.0, 0.18, 60)
    assert len(found) >= 57
    honest = np.sqrt(np.mean([e @ np.linalg.solve(c.covariance, e) / 2 for e, c in found]))
    print(f"rendered, speckle contrast 0.18: normalised error {honest:.3f}")
    assert 0.75 < honest < 1.25
