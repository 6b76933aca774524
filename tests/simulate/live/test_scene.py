"""Poses in which the simulated hand holds a plate: enough of them, unlike each other."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.camera.capture import CaptureJudge
from core.calibrate.camera.missing import PLANE_POSES
from core.image.targets.target_view import TargetView
from core.simulate.live.scene import PLANE_RESTS, LiveScene
from core.simulate.sample import sample_scenario, simulated_project


@pytest.mark.parametrize("unseen", [{0, 8}, {1, 3, 6}])
def test_a_calibration_has_its_poses_though_the_target_is_not_found_in_some(unseen):
    """Where a line of the fan lies along the edge of the square: so for this seed in the first and the ninth."""
    scene = LiveScene(replace(sample_scenario(), seed=4))
    camera, points = scene.rig.camera, simulated_project("").rig.plane_target.points
    judge = CaptureJudge(camera.image_size, camera, series=PLANE_POSES)
    for rest, pose in enumerate(scene.motion("planes").poses):
        view = TargetView(points, camera.project_pose(pose, points), np.full(len(points), 0.05))
        if rest % PLANE_RESTS in unseen and rest < PLANE_RESTS:
            continue
        at = 10.0 * rest
        judge.judge(view, 1.0, at)
        if judge.judge(view, 1.0, at + 0.5).take:
            judge.record_taken(view, at)
    assert not judge.missing()
