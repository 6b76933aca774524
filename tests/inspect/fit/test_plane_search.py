"""Planes found in a cloud one after the other."""

import numpy as np
import pytest

from core.inspect.fit.plane_search import find_planes
from tests.inspect.block_scan import NORMAL, TABLE_MM, axes, cloud_at


@pytest.mark.parametrize("seed", range(6))
def test_stairs_are_levels_and_not_the_plane_that_slants_through_all_of_them(seed):
    rng, (right, up) = np.random.default_rng(seed), axes()
    treads = []
    for level in range(5):
        place = rng.uniform((10.0 * level, 0.0), (10.0 * level + 10, 40.0), (100, 2))
        treads.append((TABLE_MM - 10.0 * level) * NORMAL + place @ np.array([right, up]))
    points = np.concatenate(treads)
    cloud = cloud_at(points + rng.normal(0, 0.25, (len(points), 1)) * NORMAL, sigma=0.25)
    planes = find_planes(cloud, seed=seed)
    assert sorted(round((TABLE_MM - plane.distance) / 10.0) for plane in planes) == [0, 1, 2, 3, 4]
    assert all(abs(plane.normal @ NORMAL) > 0.999 for plane in planes)
