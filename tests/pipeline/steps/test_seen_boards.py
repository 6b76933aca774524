"""Boards of a scan, in the pictures in which they are looked for."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.fan.poses.target_plane import target_plane
from core.calibrate.results import NO_FAN, CameraCalibration
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.files.recording.rig import KnownPlaneTarget, rig_to_toml
from core.pipeline.steps.scan.known_planes import see_boards
from core.pipeline.steps.workspace import Calibration
from core.progress import silent
from core.simulate.effects.boards import BoardsBeside
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from core.simulate.truth import load_truth

PLATE = Scenario(scale=0.25, frames=3, camera_views=1, plane_poses=1, seed=4, boards=BoardsBeside(plate=True))


def test_a_board_without_a_picture_of_its_own_is_seen_in_that_of_the_fan_alone(tmp_path):
    simulate_set(PLATE, tmp_path)
    truth, rig = load_truth(tmp_path), open_set(tmp_path).rig
    (tmp_path / "scan" / "planes" / "plate.png").rename(tmp_path / "scan" / "reference.png")
    stated = KnownPlaneTarget(rig.plane_target, rig.plane_board)
    (tmp_path / "rig.toml").write_text(rig_to_toml(replace(rig, known_planes={"plate": stated})))
    found = open_set(tmp_path)
    assert found.known_planes[0].pictures == ()
    reader, camera = (
        PictureReader(found),
        CameraCalibration(truth.camera, 1e-4 * np.eye(10), (), 0.1, 0.1, 1.0, 0.5, 0.01),
    )
    (plate,) = see_boards(reader, Calibration(camera, NO_FAN), silent).calibration.planes
    assert (plate.name, plate.pictures) == ("plate", 1)
    assert plate.pi == pytest.approx(target_plane(truth.known_planes["plate"]), rel=2e-3, abs=2e-6)
    assert set(reader.hashes) == {"scan/reference.png"}
