"""A laser that somebody else photographed: 12 poses of a circle grid, laser off and on, one line, colour JPEG."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import cv2
import numpy as np
import pytest

from core.acquire.channel import Channel
from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.plane_pose import ExtraPictures, measure_plane_pose
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration
from core.files.pictures import compression_of
from core.image.targets import CircleGrid
from core.model import Camera
from tests.shared import REAL_SETS

FOLDER = REAL_SETS / "linelight"
BLUE, GREEN, RED = 0, 1, 2
CENTROID_PLANE = np.array([0.02402, 0.98773, -0.15429, 47.651])
"""n and d in mm of the plane n·X + d = 0 that centroids of the green difference gave, says whoever checked the set."""
PUBLISHED_CAMERA = Camera(
    (1920, 1080),
    np.array([[1144.4393, 0, 916.0594], [0, 1142.4883, 522.0497], [0, 0, 1]]),
    np.array([-0.02961, -0.000335, 0.007891, -0.000394, 0.04591]),
)

ONE = FanOptions(lines=1)

pytestmark = [
    pytest.mark.accuracy,
    pytest.mark.skipif(not FOLDER.is_dir(), reason="the real pictures of linelight are not here"),
]


def one_channel(path: Path, channel: int) -> np.ndarray:
    picture = cv2.imread(str(path))
    assert picture is not None
    return np.ascontiguousarray(picture[:, :, channel])


def features(channel: int, poses: range, others: Mapping[Channel, int] = MappingProxyType({})) -> list[PoseFeatures]:
    found = []
    for number in poses:
        lit, dark = (FOLDER / f"{kind}_picture/{kind}{number}.jpg" for kind in ("light", "calib"))
        beside = {
            str(name): (one_channel(lit, other), one_channel(dark, other), compression_of(lit, name))
            for name, other in others.items()
        }
        on, off = one_channel(lit, channel), one_channel(dark, channel)
        target = CircleGrid(7, 7, 37.5)
        found.append(measure_plane_pose(f"light{number}", on, off, target, beside=ExtraPictures(others=beside)))
    return found


@pytest.fixture(scope="module")
def green() -> list[PoseFeatures]:
    return features(GREEN, range(12), {"blue": BLUE})


@pytest.fixture(scope="module")
def calibration(green) -> FanCalibration:
    camera = calibrate_camera([pose.view for pose in green], (1920, 1080)).camera
    return fit_fan(green, camera, ONE)


def test_no_pose_moved_between_off_and_on(green):
    assert [pose.reason for pose in green] == [None] * 12


def test_the_plane_fits_all_points_within_a_tenth_of_a_millimetre(calibration):
    assert all(pose.used for pose in calibration.poses)
    assert sum(len(pose.points[0]) for pose in calibration.poses) > 4000
    assert calibration.rms_mm[0] <= 0.10


def test_the_plane_is_that_of_an_independent_evaluation(green):
    result = fit_fan(green, PUBLISHED_CAMERA, ONE)
    plane = result.fan.planes[0]
    tilt = np.degrees(np.linalg.norm(np.cross(plane.normal, CENTROID_PLANE[:3])))
    assert tilt < 0.05
    points = np.vstack([pose.points[0] for pose in result.poses])
    on_plane = points - plane.distances(points)[:, None] * plane.normal
    assert np.abs(on_plane @ CENTROID_PLANE[:3] + CENTROID_PLANE[3]).max() < 0.1


def test_blue_light_gives_another_plane_than_green_and_the_uncertainty_holds_both(calibration, green):
    """By 3.2 times what both leave uncertain without that."""
    camera = calibrate_camera([pose.view for pose in green], (1920, 1080)).camera
    blue = fit_fan([replace(pose, centrelines=pose.others["blue"], others={}) for pose in green], camera, ONE)
    step = (blue.fan.pis - calibration.fan.pis).ravel()
    alone = fit_fan([replace(pose, others={}) for pose in green], camera, ONE)
    sums = [one.fan.covariance + blue.fan.covariance for one in (alone, calibration)]
    without, with_it = (np.sqrt(step @ np.linalg.solve(one, step) / 3) for one in sums)
    assert without > 2.5
    assert with_it < 1
    (note,) = (note for note in calibration.notes if note.code == "fan.channels_differ")
    assert 0.05 < note.values["mm"] < 0.15


def test_one_line_has_no_pencil(calibration):
    assert calibration.constraint_suits is None
    assert calibration.fan.lines == 1


def test_the_saturated_red_channel_is_warned_of():
    result = fit_fan(features(RED, range(0, 12, 4)), PUBLISHED_CAMERA, ONE)
    assert any("saturated" in str(note) for note in result.notes)
