"""What the target's points leave over in all poses alike, over the target and over the picture."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.fan.calibration import fit_fan
from core.model import Camera
from tests.calibrate.fan.test_calibration import THREE
from tests.calibrate.fan_scenes import CAMERA, GRID, SQUARE, Noise, features, poses

CODES = ("fan.point_off_target", "fan.points_off_in_region")


def told(seed: int, points: np.ndarray = GRID, printed: np.ndarray | None = None, camera: Camera = CAMERA) -> list:
    """Notes of a fan calibrated with a target said to have `points`, but `printed` so, by such a `camera`."""
    seen = features(poses(9, seed), Noise(), seed, points=points if printed is None else printed)
    seen = [replace(one, view=replace(one.view, points=points)) for one in seen if one.view is not None]
    return [note for note in fit_fan(seen, camera, THREE).notes if note.code in CODES]


def test_a_point_that_is_printed_aside_is_told_with_place_and_direction():
    printed = GRID.copy()
    printed[10, 0] += 0.3
    (note,) = told(1, printed=printed)
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
