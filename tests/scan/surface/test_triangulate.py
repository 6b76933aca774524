"""Points of a centreline on a light plane, and their σ."""

import numpy as np

from core.image.stripes.centreline import Centreline
from core.scan.surface.triangulate import triangulate
from core.simulate.recording import scenario_rig
from core.simulate.scenario import Scenario


def test_points_of_a_plane_whose_covariance_is_lost_in_rounding_are_left_out():
    """A σ of 0 would be the best of all points; the file of the cloud cannot hold it either."""
    rig = scenario_rig(Scenario(scale=0.25))
    width, height = rig.camera.image_size
    uv = np.column_stack([np.linspace(0.2 * width, 0.8 * width, 50), np.full(50, height / 2)])
    same = np.ones(50)
    line = Centreline(uv, np.tile([0.0, 1.0], (50, 1)), same, 100 * same, 0.05 * same, same < 0, 1.0)
    pi, rays = rig.fan.planes[1].pi, rig.camera.rays(uv)
    middle = rays.mean(axis=0)
    across = np.cross(middle, [0.0, 1.0, 0.0])
    lost = -1e-12 * np.outer(across, across)  # below 0 but in the middle of the line
    assert len(triangulate(line, pi, np.zeros((3, 3)), rig.camera, 0, 0)) == 50
    assert len(triangulate(line, pi, lost, rig.camera, 0, 0)) <= 1
    known = triangulate(line, pi, -lost, rig.camera, 0, 0)
    assert len(known) == 50 and np.all(known.sigma > 0)
