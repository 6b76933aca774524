"""Every point of every line found in rendered pictures, held against the true curve of the light.

Whole pictures hold what small ones of one stripe don't: faint light on a dark mark, stripes saturated for long
stretches, the edges of plates, shadows. A root mean square over all points hides a line of which a part went astray, so
every single point is judged by its own standard uncertainty.
"""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.calibrate.fan.poses.even_plate import DARK
from core.calibrate.fan.poses.plane_pose import measure_plane_pose
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.image.stripes.centreline import Centreline
from core.image.targets import BlackSquare
from core.simulate.calibration import CalibrationPictures
from core.simulate.rays import ray_map
from core.simulate.recording import scenario_rig
from core.simulate.rig import Rig
from core.simulate.sample import sample_scenario

UNSUSPICIOUS_PX = 1.0
LARGEST_Z = 6.0
"""Errors over stated σ: among some thousand points of Gaussian errors the largest is 4; speckle's tails are longer."""
NEAR_EDGE_PX = 14
"""Light so near to an edge of the plate or of its mark need not be found: 2.5 filter σ are cut, and the edge pulls."""


class Poses:
    """Poses of the fan's plane target as the sample shows them, rendered one at a time."""

    def __init__(self) -> None:
        scenario = sample_scenario()
        self.rig: Rig = scenario_rig(scenario)
        self._pictures = CalibrationPictures(scenario, self.rig, ray_map(self.rig.camera))

    def measured(self, name: str) -> tuple[PoseFeatures, np.ndarray, np.ndarray]:
        """What is found in a pose, its picture without laser, and the plate's plane (3,) in inverse depths."""
        (_, on), (_, off) = self._pictures.render(name)
        pose = self._pictures.plane_poses[name]
        normal = pose.rotation[:, 2]
        found = measure_plane_pose(name, on, off, BlackSquare(60.0), self.rig.camera)
        return found, off, normal / (normal @ pose.translation)

    def across(self, uv: np.ndarray, line: int, plate: np.ndarray) -> np.ndarray:
        """Distances (N,) in px of pictures' points from where a line's light truly lies on the plate."""
        towards = self.rig.fan.planes[line].pi - plate

        def level(points: np.ndarray) -> np.ndarray:
            return self.rig.camera.rays(points) @ towards

        du, dv = np.array([0.5, 0.0]), np.array([0.0, 0.5])
        return level(uv) / np.hypot(level(uv + du) - level(uv - du), level(uv + dv) - level(uv - dv))

    def true_light(self, line: int, plate: np.ndarray, off: np.ndarray) -> np.ndarray:
        """Pixels (N, 2) that a line's light on the light part of the plate crosses, away from all edges."""
        level = DARK * np.quantile(off, 0.98)
        lit = cv2.erode((off > level).astype(np.uint8), np.ones((2 * NEAR_EDGE_PX + 1,) * 2, np.uint8))
        pixels = np.argwhere(lit)[:, ::-1].astype(np.float64)
        return pixels[np.abs(self.across(pixels, line, plate)) < 0.5]


@pytest.fixture(scope="module")
def poses() -> Poses:
    return Poses()


def hold(line: Centreline, error: np.ndarray) -> None:
    """No point of a line may be astray, nor err by more than its σ allows."""
    assert np.abs(error).max() < UNSUSPICIOUS_PX
    assert np.abs(error / line.sigma).max() < LARGEST_Z
    assert np.sqrt(np.mean((error / line.sigma) ** 2)) < 1.5


@pytest.mark.accuracy
@pytest.mark.parametrize("name", ["pose00", "pose04", "pose06"])
def test_every_line_on_a_plate_is_where_its_light_is(poses: Poses, name: str) -> None:
    """Stripes saturated for long, faint ones on the dark mark, and ones of two brightnesses in one picture."""
    found, off, plate = poses.measured(name)
    for line in found.centrelines:
        errors = [poses.across(line.uv, k, plate) for k in range(3)]
        hold(line, min(errors, key=lambda error: float(np.median(np.abs(error)))))
    points = cKDTree(np.concatenate([line.uv for line in found.centrelines]))
    for k in range(3):
        light = poses.true_light(k, plate, off)
        assert len(light) > 300
        assert np.mean(points.query(light)[0] < 1.5) > 0.99
