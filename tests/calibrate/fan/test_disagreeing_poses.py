"""Poses that disagree: scattered plates, nearly parallel ones, and what is said of them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.calibrate.board_shape import BoardShape, BoardTolerance
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.results import FanCalibration
from core.errors import InputError
from core.model import Pose
from tests.calibrate.fan.test_calibration import THREE, normalised, worst_mm
from tests.calibrate.fan_scenes import CAMERA, GRID, PAPER, Noise, bowed, features, poses


def scattered(seed: int, scatter_mm: float, lines: int = 3, count: int = 14) -> FanCalibration:
    seen = features(poses(count, seed), Noise(scatter_mm=scatter_mm), seed, points=GRID, pis=PAPER[:lines])
    return fit_fan(seen, CAMERA, THREE if lines == 3 else FanOptions(lines))


@pytest.mark.accuracy
@pytest.mark.parametrize("lines", [1, 3])
def test_scattered_poses_all_count_and_widen_the_uncertainty(lines):
    """Plates 2 mm from where their points say: 8 of 20 were used, and the error was six times its uncertainty."""
    errors = []
    for seed in range(6):
        result = scattered(seed, 2.0, lines, 20)
        assert all(pose.used for pose in result.poses)
        off = (result.fan.pis - PAPER[:lines]).ravel()
        covariance = result.fan.covariance
        freedom = np.linalg.matrix_rank(covariance, tol=1e-9 * np.trace(covariance), hermitian=True)
        errors.append(off @ np.linalg.pinv(covariance, rcond=1e-9, hermitian=True) @ off / freedom)
    assert 0.7 < np.sqrt(np.mean(errors)) < 1.4


@pytest.mark.accuracy
@pytest.mark.parametrize(("lines", "scatter_mm", "count"), [(3, 0.0, 14), (3, 0.02, 14), (3, 0.05, 8), (1, 0.1, 14)])
def test_the_uncertainty_is_true_whether_poses_scatter_or_not(lines, scatter_mm, count):
    """Also where they do by less than the noise of a stripe: it was 1.6 times too small for 0.02 mm."""
    errors = []
    for seed in range(16):
        result = scattered(seed, scatter_mm, lines, count)
        off = (result.fan.pis - PAPER[:lines]).ravel()
        covariance = result.fan.covariance
        freedom = np.linalg.matrix_rank(covariance, tol=1e-9 * np.trace(covariance), hermitian=True)
        errors.append(off @ np.linalg.pinv(covariance, rcond=1e-9, hermitian=True) @ off / freedom)
    assert 0.7 < np.sqrt(np.mean(errors)) < 1.4


def test_scattered_poses_are_told_with_figures():
    result = scattered(1, 2.0)
    told = next(note for note in result.notes if note.code == "fan.poses_scatter")
    assert 0.2 < told.values["scatter"] < 1.5
    assert told.values["times"] > 10
    assert not any(note.code == "fan.poses_scatter" for note in scattered(1, 0.0).notes)


def test_poses_left_out_keep_their_distance():
    seen = features(poses(7, 1), Noise(), 2, points=GRID)
    without = fit_fan(seen, CAMERA, THREE, excluded={seen[1].name})
    assert 0 < without.poses[1].rms_mm < 0.1
    assert without.minority is None
    few = fit_fan(seen, CAMERA, THREE, excluded={pose.name for pose in seen[:4]})
    assert few.minority is None  # left out by hand is a decision


def nearly_parallel(count: int, seed: int, tilt_deg: float = 1.5) -> list[Pose]:
    """Boards that face the camera at 500 mm."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        tilt = Rotation.from_euler("yx", rng.uniform(-tilt_deg, tilt_deg, 2), degrees=True)
        centre = np.array([rng.uniform(-20, 20), 37.5 + rng.uniform(-10, 10), 500 + rng.uniform(-2, 2)])
        found.append(Pose(tilt.as_matrix(), centre - tilt.apply([30.0, 30.0, 0.0])))
    return found


def test_nearly_parallel_boards_are_refused_with_the_missing_tilt():
    """Their own plane goes through all stripes: 73 degrees off, with an RMS of 0.004 mm, was the answer."""
    seen = features(nearly_parallel(12, 1), Noise(), 1, points=GRID, pis=PAPER[:1])
    with pytest.raises(InputError, match="too alike") as caught:
        fit_fan(seen, CAMERA, FanOptions(1))
    assert caught.value.todo.code == "advice.turn_target"
    assert 5 < caught.value.todo.values["more"] < 40


def test_a_bow_beyond_what_was_stated_is_refused():
    seen = features(poses(9, 302), Noise(), 2, points=GRID, shape=bowed(3.0, 3.0, 0.0))
    with pytest.raises(InputError, match="times its flatness of"):
        fit_fan(seen, CAMERA, FanOptions(3, THREE.angle, target=BoardTolerance(0.05, 0.0)))


def seen_by_camera(*bow: float) -> BoardShape:
    """The board's shape as the camera's views tell it, to 0.02 mm."""
    return replace(bowed(*bow), covariance=0.02**2 * np.eye(4))


def test_a_bow_that_the_camera_has_seen_is_taken_over_and_the_planes_are_right():
    """Nothing is said of its flatness: taken for flat, planes are off by more than their uncertainty."""
    seen = features(poses(9, 302), Noise(), 2, points=GRID, shape=bowed(0.7, 0.5, 0.0))
    by_camera = seen_by_camera(0.7, 0.5, 0.0)
    known = fit_fan(seen, CAMERA, FanOptions(3, THREE.angle, target=BoardTolerance(), board=by_camera))
    flat = fit_fan(seen, CAMERA, THREE)
    assert "target.flatness_assumed" not in {note.code for note in known.notes}
    assert known.board.values[:3] == pytest.approx([0.7, 0.5, 0.0], abs=0.06)
    assert worst_mm(known.fan.pis, PAPER) < 0.4 * worst_mm(flat.fan.pis, PAPER)
    assert normalised(known) < 4


def test_a_board_bowed_otherwise_than_the_camera_saw_it_is_refused():
    seen = features(poses(9, 302), Noise(), 2, points=GRID, shape=bowed(-0.7, -0.5, 0.0))
    with pytest.raises(InputError, match="views of the same target"):
        fit_fan(seen, CAMERA, FanOptions(3, THREE.angle, board=seen_by_camera(0.7, 0.5, 0.0)))
