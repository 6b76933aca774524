"""The skew is solved for only where that predicts views left out better."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.options import CameraOptions
from core.calibrate.camera.skew import FEWEST_VIEWS
from tests.calibrate.camera_views import TRUTH, board, changed, random_pose, synthetic_views


def views_without_skew(seed):
    matrix = TRUTH.matrix.copy()
    matrix[0, 1] = 0.0
    camera = replace(TRUTH, matrix=matrix)
    rng = np.random.default_rng(seed)
    poses = [random_pose(rng, board(), 0.6) for _ in range(14)]
    like = synthetic_views(seed)
    return [
        changed(view, camera.project_pose(pose, board()) + rng.normal(0, 0.03, view.uv.shape))
        for view, pose in zip(like, poses, strict=True)
    ]


def test_a_skew_that_is_there_is_found_and_the_solution_is_that_with_the_skew_free():
    views = synthetic_views(3)
    by_itself = calibrate_camera(views, TRUTH.image_size)
    asked_for = calibrate_camera(views, TRUTH.image_size, CameraOptions(skew=True))
    assert np.array_equal(by_itself.camera.matrix, asked_for.camera.matrix)
    assert by_itself.camera.matrix[0, 1] == pytest.approx(0.39, abs=0.15)


def test_a_gain_within_its_own_scatter_does_not_free_the_skew():
    """These views are foretold better by 4 in a million, a hundredth of that gain's standard error."""
    calibration = calibrate_camera(views_without_skew(2), TRUTH.image_size)
    assert calibration.camera.matrix[0, 1] == 0
    assert calibration.sd["gamma"] > 0


@pytest.mark.accuracy
def test_a_skew_that_is_not_there_stays_zero():
    cameras = [calibrate_camera(views_without_skew(seed), TRUTH.image_size).camera for seed in range(4)]
    assert [camera.matrix[0, 1] for camera in cameras] == [0, 0, 0, 0]


def test_few_views_do_not_tell():
    views = synthetic_views(3)[: FEWEST_VIEWS - 1]
    calibration = calibrate_camera(views, TRUTH.image_size)
    assert calibration.camera.matrix[0, 1] == 0


def test_a_skew_left_at_zero_is_as_uncertain_as_if_it_were_solved_for():
    """Nobody has said that it is 0: the truth of these views is 0.39, and six of them do not show it."""
    views = synthetic_views(3)[: FEWEST_VIEWS - 1]
    left_out = calibrate_camera(views, TRUTH.image_size)
    free = calibrate_camera(views, TRUTH.image_size, CameraOptions(skew=True))
    assert 0.9 * free.sd["gamma"] < left_out.sd["gamma"] < 3 * free.sd["gamma"]
    assert abs(TRUTH.matrix[0, 1]) < 3 * left_out.sd["gamma"]
    said = calibrate_camera(views, TRUTH.image_size, CameraOptions(skew=False))
    assert said.sd["gamma"] == 0
    assert said.sd["u0"] <= left_out.sd["u0"]
