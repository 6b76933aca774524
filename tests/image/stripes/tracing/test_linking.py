"""Places that lines have passed, told by lists of points, against distances to all of them."""

from __future__ import annotations

import numpy as np
import pytest

from core.image.stripes.tracing.linking import add_point, empty_point_grid, enlarged_point_grid, is_near_point


@pytest.mark.parametrize("reach", [2, 6, 11])
def test_places_near_points_are_told_from_all_others(reach: int) -> None:
    rng = np.random.default_rng(reach)
    points = rng.uniform((0, 0), (199, 119), (60, 2))
    passed = empty_point_grid((120, 200), reach, 30)
    for number in range(60):
        if number == 30:
            passed = enlarged_point_grid(passed, 60)
        add_point(passed, points, number, reach)
    pixels = np.floor(points + 0.5)
    u, v = np.meshgrid(np.arange(200), np.arange(120))
    near = np.hypot(u[..., None] - pixels[:, 0], v[..., None] - pixels[:, 1]).min(axis=2) <= reach
    told = [[is_near_point(passed, points, float(x), float(y), reach) for x in range(200)] for y in range(120)]
    np.testing.assert_array_equal(told, near)
    assert 0.01 < near.mean() < 0.95
