"""Crossings against analytic lines: bends, gaps, edges, ends, rejections. Precision: see test_crossing_bound.py."""

from __future__ import annotations

import numpy as np
import pytest

from core.image.crossings.breaks import breaks
from core.image.crossings.crossing import cross_centrelines, search_crossings
from core.image.stripes.centreline import Centreline

S, A = 1.5, 120.0
HALF = 40.0
FIFTEEN = np.radians(15)


def polyline(uv: np.ndarray, sigma: float = 0.02, correlation: float = 7.0, saturated: object = False) -> Centreline:
    """A centreline through given points."""
    tangent = np.gradient(uv, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    ones = np.ones(len(uv))
    flags = np.broadcast_to(np.asarray(saturated), len(uv))
    return Centreline(uv, normal, S * ones, A * ones, sigma * ones, flags, correlation)


def ray(centre: tuple[float, float], angle: float, first: float = -100, last: float = 100) -> np.ndarray:
    along = np.arange(first, last + 0.5)
    return np.asarray(centre) + along[:, None] * np.array([np.cos(angle), np.sin(angle)])


def test_arcs_meet_where_they_should() -> None:
    """Two circles of radius 120 px: the bend of 7 px over the window is followed."""
    theta = np.linspace(-0.7, 0.7, 168)
    one = polyline(np.column_stack([-120 + 120 * np.cos(theta), 120 * np.sin(theta)]), 0.005)
    other = polyline(np.column_stack([120 * np.sin(theta), 120 * np.cos(theta) - 120]), 0.005)
    ((_, _, crossing),) = cross_centrelines([one], [other], HALF, FIFTEEN)
    np.testing.assert_allclose(crossing.uv, 0, atol=0.002)
    assert crossing.angle == pytest.approx(np.pi / 2, abs=1e-3)
    assert crossing.curved


def test_straight_lines_are_not_called_curved_and_sigma_shrinks_with_the_window() -> None:
    one, other = polyline(ray((50, 50), 0.2)), polyline(ray((50, 50), 1.4))
    ((i, j, short),) = cross_centrelines([one], [other], 10.0, FIFTEEN)
    ((_, _, long),) = cross_centrelines([one], [other], 40.0, FIFTEEN)
    assert (i, j) == (0, 0) and not long.curved
    np.testing.assert_allclose(long.uv, [50, 50], atol=1e-6)
    assert short.sigma_a / long.sigma_a == pytest.approx(np.sqrt(100 / 30), rel=0.1)
    # a parabola over ±100 px: 9/4 of a mean over 201 points that are worth 201/7; a little more for what it might bend
    assert 1.0 < long.sigma_a / (0.02 * np.sqrt(9 / 4 * 7 / 201)) < 1.1


def test_covariance_belongs_to_the_normals() -> None:
    """Moving line a by its σ along its normal moves the crossing along line b by σ / sin θ."""
    angle = 0.5
    ((_, _, crossing),) = cross_centrelines([polyline(ray((0, 0), 0.0))], [polyline(ray((0, 0), angle))], HALF, FIFTEEN)
    along_b = np.array([np.cos(angle), np.sin(angle)]) * crossing.sigma_a / np.sin(angle)
    along_a = np.array([1.0, 0.0]) * crossing.sigma_b / np.sin(angle)
    expected = np.outer(along_a, along_a) + np.outer(along_b, along_b)
    np.testing.assert_allclose(crossing.covariance, expected, rtol=1e-6, atol=1e-12)


def test_saturated_points_have_no_say() -> None:
    """A blob of saturated points that bulges by 1 px at the crossing does not move it."""
    uv = ray((0, 0), 0.0)
    blob = np.abs(uv[:, 0]) < 8
    bulged = uv + np.column_stack([np.zeros(len(uv)), 1.0 * blob])
    ((_, _, crossing),) = cross_centrelines(
        [polyline(bulged, saturated=blob)], [polyline(ray((0, 0), 1.2))], HALF, FIFTEEN
    )
    np.testing.assert_allclose(crossing.uv, [0, 0], atol=1e-6)


def test_a_line_is_bridged_across_a_gap_within_a_piece() -> None:
    uv = ray((0.3, 0), 0.0)
    open_line = polyline(uv[np.abs(uv[:, 0]) > 6])
    ((_, _, crossing),) = cross_centrelines([open_line], [polyline(ray((0, 0), 1.2))], HALF, FIFTEEN)
    np.testing.assert_allclose(crossing.uv, [0, 0], atol=1e-6)


def test_no_crossing_between_pieces_at_a_depth_edge() -> None:
    """The stripe jumps by 6 px just where the other line passes through the gap."""
    left, right = polyline(ray((0, 0), 0.0, -100, -5)), polyline(ray((0, 6), 0.0, 5, 100))
    assert cross_centrelines([left, right], [polyline(ray((0, 3), 1.5))], HALF, FIFTEEN) == []


def test_fit_stays_within_its_piece() -> None:
    """Close to a kink only the piece that is crossed counts."""
    left = polyline(ray((0, 0), 0.0, -100, -3))
    right = polyline(ray((0, 0), 0.6, 3, 100))
    ((piece, _, crossing),) = cross_centrelines([left, right], [polyline(ray((-12, 0), 1.5))], HALF, FIFTEEN)
    assert piece == 0
    np.testing.assert_allclose(crossing.uv, [-12, 0], atol=1e-6)
    ((_, _, far),) = cross_centrelines([left, right], [polyline(ray((-60, 0), 1.5))], HALF, FIFTEEN)
    assert crossing.sigma_a > 1.3 * far.sigma_a


def test_rejections_are_counted() -> None:
    flat = polyline(ray((0, 0), 0.0))
    assert search_crossings([flat], [polyline(ray((0, 0), 0.1))], HALF, FIFTEEN).rejected == {"angle too small": 1}
    stub = polyline(ray((0, 0), 1.2, -2, 30))
    assert search_crossings([flat], [stub], HALF, FIFTEEN).rejected == {"arm too short": 1}
    blind = polyline(ray((0, 0), 1.2), saturated=True)
    assert search_crossings([flat], [blind], HALF, FIFTEEN).rejected == {"arm too short": 1}
    assert cross_centrelines([], [flat]) == []
    assert cross_centrelines([flat], [polyline(ray((0, 300), 1.2))]) == []


def test_rough_lines_meet_once() -> None:
    rng = np.random.default_rng(4)
    one = ray((0, 0), 0.0) + rng.normal(0, [0.0, 0.3], (201, 2))
    other = ray((0, 0), 0.3) + rng.normal(0, [0.0, 0.3], (201, 2))
    found = cross_centrelines([polyline(one, 0.3, 1.0)], [polyline(other, 0.3, 1.0)], HALF, FIFTEEN)
    assert len(found) == 1


def test_two_meetings_of_the_same_pieces_are_both_found() -> None:
    theta = np.linspace(-2.5, 2.5, 500)
    ring = polyline(100 * np.column_stack([np.cos(theta), np.sin(theta)]))
    found = cross_centrelines([ring], [polyline(ray((0, 0), np.pi / 2, -150, 150))], 10.0, FIFTEEN)
    assert sorted(round(float(c.uv[1])) for _, _, c in found) == [-100, 100]


def test_a_line_of_which_only_islands_are_not_saturated_has_no_break_to_be_judged():
    """Its bins lie further apart than a break is judged from: nothing lies to the left or right of any."""
    bins = np.zeros((9, 5))
    bins[:, 0] = bins[:, 1] = 200.0 * np.arange(9)
    bins[:, 3] = 1e4

    assert not breaks(bins, 120.0).any()
