"""What the target's points leave over in all poses alike, over the target and over the picture."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.fan.calibration import fit_fan
from core.calibrate.results import FanCalibration
from core.model import Camera
from tests.calibrate.fan.test_calibration import THREE
from tests.calibrate.fan_scenes import CAMERA, GRID, SQUARE, Noise, features, poses

CODES = ("fan.point_off_target", "fan.points_off_in_region")
FEW = ("fan.points_not_judged", "fan.few_poses")
ASIDE = GRID + 0.3 * np.eye(3)[0] * (np.arange(len(GRID)) == 10)[:, None]


def calibrated(
    seed: int,
    points: np.ndarray = GRID,
    printed: np.ndarray | None = None,
    camera: Camera = CAMERA,
    *,
    count: int = 9,
    noise: Noise | None = None,
) -> FanCalibration:
    """A fan calibrated with a target said to have `points`, but `printed` so, by such a `camera`."""
    seen = features(poses(count, seed), noise or Noise(), seed, points=points if printed is None else printed)
    seen = [replace(one, view=replace(one.view, points=points)) for one in seen if one.view is not None]
    return fit_fan(seen, camera, THREE)


def told(seed: int, points: np.ndarray = GRID, printed: np.ndarray | None = None, camera: Camera = CAMERA) -> list:
    """What is said of points that lie off."""
    return [note for note in calibrated(seed, points, printed, camera).notes if note.code in CODES]


def test_a_point_that_is_printed_aside_is_told_with_place_and_direction():
    (note,) = told(1, printed=ASIDE)
    assert note.code == "fan.point_off_target"
    assert (note.values["x"], note.values["y"]) == tuple(GRID[10, :2])
    assert note.values["dx"] == pytest.approx(0.3, abs=0.03)
    assert abs(note.values["dy"]) < 0.03


def test_a_camera_that_is_not_as_calibrated_is_told():
    """Its centre is 20 px aside: no pose is worse than the others for it."""
    matrix = CAMERA.matrix.copy()
    matrix[:2, 2] += (20, -20)
    (note,) = told(1, camera=replace(CAMERA, matrix=matrix))
    assert note.code == "fan.points_off_in_region"
    assert note.values["px"] > 0.05


@pytest.mark.parametrize("seeds", [range(1), pytest.param(range(1, 4), marks=pytest.mark.accuracy)], ids=str)
@pytest.mark.parametrize("points", [GRID, SQUARE], ids=["grid", "square"])
def test_a_true_target_before_a_true_camera_is_not_accused(points, seeds):
    assert [seed for seed in seeds if told(seed, points)] == []


@pytest.mark.parametrize("count", [3, 5])
def test_points_that_lie_off_in_poses_too_few_to_tell_are_not_known_and_told_once(count):
    """By chance, or by a print that is not true: three to seven poses do not say."""
    found = calibrated(1, printed=ASIDE, count=count)
    assert found.points_off_alike is None
    assert [note.code for note in found.notes if note.code in (*CODES, *FEW)] == ["fan.points_not_judged"]


@pytest.mark.parametrize("points", [GRID, SQUARE], ids=["grid", "square"])
@pytest.mark.parametrize("corner_px", [0.02, 0.15])
def test_few_poses_whose_points_lie_as_their_noise_lets_them_are_not_doubted(points, corner_px):
    """What poses have in common within their scatter is in U, which takes the scatter for noise."""
    found = [calibrated(seed, points, count=5, noise=Noise(corner_px=corner_px)) for seed in range(4)]
    assert [one.points_off_alike for one in found] == [False] * 4


def test_points_that_lie_off_in_enough_poses_are_a_fact():
    assert [calibrated(1, printed=printed).points_off_alike for printed in (ASIDE, None)] == [True, False]
