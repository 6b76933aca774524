"""A laser that somebody else photographed: 12 poses of a circle grid, laser off and on, one line, colour JPEG."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.plane_pose import measure_plane_pose
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration
from core.image.targets import CircleGrid
from core.model import Camera
from tests.shared import REAL_SETS

FOLDER = REAL_SETS / "linelight"
GREEN, RED = 1, 2
CENTROID_PLANE = np.array([0.02402, 0.98773, -0.15429, 47.651])
"""n and d in mm of the plane n·X + d = 0 that centroids of the green difference gave, says whoever checked the set."""
PUBLISHED_CAMERA = Camera(
    (1920, 1080),
    np.array([[1144.4393, 0, 916.0594], [0, 1142.4883, 522.0497], [0, 0, 1]]),
    np.array([-0.02961, -0.000335, 0.007891, -0.000394, 0.04591]),
)

pytestmark = [
    pytest.mark.accuracy,
    pytest.mark.skipif(not FOLDER.is_dir(), reason="the real pictures of linelight are not here"),
]


def one_channel(path: Path, channel: int) -> np.ndarray:
    picture = cv2.imread(str(path))
    assert picture is not None
    return np.ascontiguousarray(picture[:, :, channel])


def features(channel: int, poses: range) -> list[PoseFeatures]:
    found = []
    for number in poses:
        off = one_channel(FOLDER / f"calib_picture/calib{number}.jpg", channel)
        on = one_channel(FOLDER / f"light_picture/light{number}.jpg", channel)
        found.append(measure_plane_pose(f"light{number}", on, off, CircleGrid(7, 7, 37.5)))
    return found


@pytest.fixture(scope="module")
def green() -> list[PoseFeatures]:
    return features(GREEN, range(12))


@pytest.fixture(scope="module")
def calibration(green) -> FanCalibration:
    camera = calibrate_camera([pose.view for pose in green], (1920, 1080)).camera
    return fit_fan(green, camera, FanOptions(lines=1))


def test_no_pose_moved_between_off_and_on(green):
    assert [pose.reason for pose in green] == [None] * 12


def test_the_plane_fits_all_points_within_a_tenth_of_a_millimetre(calibration):
    assert all(pose.used for pose in calibration.poses)
    assert sum(len(pose.points[0]) for pose in calibration.poses) > 4000
    assert calibration.rms_mm[0] <= 0.10


def test_the_plane_is_that_of_an_independent_evaluation(green):
    result = fit_fan(green, PUBLISHED_CAMERA, FanOptions(lines=1))
    plane = result.fan.planes[0]
    tilt = np.degrees(np.linalg.norm(np.cross(plane.normal, CENTROID_PLANE[:3])))
    assert tilt < 0.05
    points = np.vstack([pose.points[0] for pose in result.poses])
    on_plane = points - plane.distances(points)[:, None] * plane.normal
    assert np.abs(on_plane @ CENTROID_PLANE[:3] + CENTROID_PLANE[3]).max() < 0.1


def test_one_line_has_no_pencil(calibration):
    assert calibration.constraint_suits is None
    assert calibration.fan.lines == 1


def test_the_saturated_red_channel_is_warned_of():
    result = fit_fan(features(RED, range(0, 12, 4)), PUBLISHED_CAMERA, FanOptions(lines=1))
    assert any("saturated" in str(note) for note in result.notes)
