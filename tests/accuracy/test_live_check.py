"""Checks of rigs that have not changed, by pictures as the live simulated rig takes them, against many calibrations."""

from pathlib import Path

import numpy as np
import pytest

from core.acquire.source import Lasers
from core.calibrate.change import P_TOLD, changes, judge
from core.calibrate.deviations import calibration_deviations
from core.calibrate.fan.interim_check import check_poses
from core.calibrate.fan.poses.plane_pose import measure_plane_pose
from core.files.recording.recording_set import open_set
from core.image.targets import BlackSquare
from core.pipeline.live.planes import CHECK_POSES
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.workspace import Calibration, Workspace
from core.simulate.live.scene import LiveScene, Moment
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from tests.simulated import SMALL

RIGS, CALIBRATIONS = 6, 12
WITHIN_REST_S = 0.3


def pictures(seed: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """The poses of a check with the fan on and off."""
    scene = LiveScene(Scenario(scale=SMALL.scale, seed=seed))
    motion = scene.motion("check")
    assert motion is not None

    def shot(pose: int, number: int) -> np.ndarray:
        time_s = pose * (motion.rest_s + motion.move_s) + WITHIN_REST_S
        return scene.picture(Moment("check", Lasers(fan=number % 2 == 0, hand=False), time_s, 0.0, number))

    return [(shot(pose, 20 * pose + 50), shot(pose, 20 * pose + 51)) for pose in range(CHECK_POSES)]


def calibration(seed: int, folder: Path) -> Calibration:
    scenario = Scenario(
        scale=SMALL.scale, frames=1, camera_views=SMALL.camera_views, plane_poses=SMALL.plane_poses, seed=seed
    )
    simulate_set(scenario, folder / "set")
    work = Workspace.open(open_set(folder / "set"), folder / "out")
    camera_step(work)
    planes_step(work)
    return work.calibration()


def chi_square(known: Calibration, shown: list[tuple[np.ndarray, np.ndarray]]) -> tuple[float, float]:
    """p, and χ² over its freedom."""
    camera = known.camera.camera
    deviations = (*calibration_deviations(known.camera, known.fan), *changes(camera, known.fan.fan))
    poses = [measure_plane_pose("", on, off, BlackSquare(60.0), camera, None) for on, off in shown]
    _, evidence = check_poses(poses, camera, known.fan, deviations)
    change = judge(camera, known.fan.fan, deviations, evidence, None)
    return change.p, change.times**2


@pytest.mark.accuracy
def test_live_pictures_of_rigs_that_have_not_changed_are_as_calibrations_let_one_expect(tmp_path):
    """With twenty calibrations and these six rigs χ² over its freedom was 0.91 in the mean; p never below 0.019."""
    shown = [pictures(seed) for seed in range(1, RIGS + 1)]
    found = np.array(
        [
            [chi_square(known, one) for one in shown]
            for known in (calibration(seed, tmp_path / str(seed)) for seed in range(1, CALIBRATIONS + 1))
        ]
    )
    p, share = found[..., 0], found[..., 1]
    print(f"χ² over its freedom {share.mean():.2f}, by rig {share.mean(axis=0).round(2)}; least p {p.min():.2g}")
    assert np.mean(p < P_TOLD) <= 0.02
    assert np.mean(p < 0.1) <= 0.15
    assert 0.6 < share.mean() < 1.3
