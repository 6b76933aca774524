"""The skew is solved for only where that predicts views left out better."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.adjustment import CameraOptions
from core.calibrate.camera.calibration import calibrate_camera
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


def test_a_skew_that_is_not_there_stays_zero():
    cameras = [calibrate_camera(views_without_skew(seed), TRUTH.image_size).camera for seed in range(4)]
    assert sum(camera.matrix[0, 1] == 0 for camera in cameras) >= 3


def test_few_views_do_not_tell():
    views = synthetic_views(3)[: FEWEST_VIEWS - 1]
    calibration = calibrate_camera(views, TRUTH.image_size)
    assert calibration.camera.matrix[0, 1] == 0 == calibration.sd["gamma"]
