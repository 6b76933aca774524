"""Boards of a scan, in the pictures in which they are looked for."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.fan.poses.target_plane import target_plane
from core.calibrate.results import NO_FAN, CameraCalibration
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.files.recording.rig import KnownPlaneTarget, rig_to_toml
from core.inspect.uncertainty.part import TargetTemperature
from core.pipeline.steps.scan.known_planes import see_boards
from core.pipeline.steps.workspace import Calibration
from core.progress import silent
from core.simulate.effects.boards import BoardsBeside
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from core.simulate.truth import load_truth

PLATE = Scenario(scale=0.25, frames=3, camera_views=1, plane_poses=1, seed=4, boards=BoardsBeside(plate=True))


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    """A simulated set with a plate, whose rig.toml has no table of it."""
    folder = tmp_path_factory.mktemp("sets") / "plate"
    simulate_set(PLATE, folder)
    return folder


def seen(folder, plate, stated, *, source=None, **changes):
    """The set in a new `folder` with a table of the plate in rig.toml: what is seen of its boards, and its reader."""
    shutil.copytree(source or plate, folder)
    rig = replace(open_set(folder).rig, known_planes={"plate": stated}, **changes)
    (folder / "rig.toml").write_text(rig_to_toml(rig))
    reader = PictureReader(open_set(folder))
    camera = CameraCalibration(load_truth(plate).camera, 1e-4 * np.eye(10), (), 0.1, 0.1, 1.0, 0.5, 0.01)
    return see_boards(reader, Calibration(camera, NO_FAN), silent), reader


def test_a_board_without_a_picture_of_its_own_is_seen_in_that_of_the_fan_alone(tmp_path, plate):
    shutil.copytree(plate, tmp_path / "moved")
    (tmp_path / "moved" / "scan" / "planes" / "plate.png").rename(tmp_path / "moved" / "scan" / "reference.png")
    rig = open_set(plate).rig
    stated = KnownPlaneTarget(rig.plane_target, rig.plane_board)
    boards, reader = seen(tmp_path / "set", plate, stated, source=tmp_path / "moved")
    assert reader.recording_set.known_planes[0].pictures == ()
    (one,) = boards.calibration.planes
    assert (one.name, one.pictures) == ("plate", 1)
    assert one.pi == pytest.approx(target_plane(load_truth(plate).known_planes["plate"]), rel=2e-3, abs=2e-6)
    assert set(reader.hashes) == {"scan/reference.png"}


@pytest.mark.parametrize("of_target", [None, 70.0])
def test_the_size_of_a_warm_board_counts_in_lengths_of_the_plane_target(tmp_path, plate, of_target):
    rig = open_set(plate).rig
    stated = KnownPlaneTarget(rig.plane_target, rig.plane_board)
    warm = replace(stated, temperature=TargetTemperature(120.0, 2.0, 1e-4, 1e-5))
    part = rig.part if of_target is None else replace(rig.part, target=TargetTemperature(of_target, 0.0, 5e-5, 0.0))
    cold, hot = (seen(tmp_path / name, plate, one, part=part)[0] for name, one in (("cold", stated), ("hot", warm)))
    (as_stated,), (larger,) = cold.calibration.planes, hot.calibration.planes
    share = 1e-4 * 100 - (0.0 if of_target is None else 5e-5 * 50)
    assert larger.pi * (1 + share) == pytest.approx(as_stated.pi, rel=1e-12)
    assert larger.scale_sd == pytest.approx(np.hypot(as_stated.scale_sd, np.hypot(1e-4 * 2.0, 100 * 1e-5)))
    (note,) = hot.notes
    assert cold.notes == () and note.code == "scan.board_warm"
    assert note.values["ppm"] == pytest.approx(1e6 * share)
