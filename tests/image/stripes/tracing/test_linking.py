"""Places that lines have passed, told by lists of points, against distances to all of them."""

from __future__ import annotations

import numpy as np
import pytest

from core.compiled import compiled
from core.image.stripes.tracing.linking import add_point, empty_point_grid, enlarged_point_grid, is_near_point


@pytest.mark.parametrize("reach", [2, 6, 11])
def test_places_near_points_are_told_from_all_others(reach: int) -> None:
    rng = np.random.default_rng(reach)
    points = rng.uniform((0, 0), (199, 119), (60, 2))
    pixels = np.floor(points + 0.5)
    u, v = np.meshgrid(np.arange(200), np.arange(120))
    near = np.hypot(u[..., None] - pixels[:, 0], v[..., None] - pixels[:, 1]).min(axis=2) <= reach
    np.testing.assert_array_equal(_told(points, reach), near)
    assert 0.01 < near.mean() < 0.95


@compiled()
def _told(points, reach):
    """Of 120 x 200 pixels, which are near the points."""
    passed = empty_point_grid((120, 200), reach, 30)
    for number in range(60):
        if number == 30:
            passed = enlarged_point_grid(passed, 60)
        add_point(passed, points, number, reach)
    told = np.empty((120, 200), np.bool_)
    for y in range(120):
        for x in range(200):
            told[y, x] = is_near_point(passed, points, float(x), float(y), reach)
    return told
