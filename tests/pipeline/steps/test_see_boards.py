"""The boards of a recording set, found in their pictures."""

import shutil
from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.calibrate.fan.poses.target_plane import target_plane
from core.calibrate.results import NO_FAN, CameraCalibration
from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.files.recording.rig import default_rig
from core.pipeline.steps.scan.known_planes import see_boards, states_no_fan
from core.pipeline.steps.workspace import Calibration
from core.progress import silent
from core.simulate.effects.boards import BoardsBeside
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from core.simulate.truth import load_truth

CORNER = Scenario(
    scale=0.25, frames=1, camera_views=1, plane_poses=1, seed=4, fan_lines=0, boards=BoardsBeside(corner=True)
)


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("corner") / "set"
    simulate_set(CORNER, folder)
    return folder, load_truth(folder)


def calibration(truth):
    return Calibration(CameraCalibration(truth.camera, np.zeros((10, 10)), (), 0.1, 0.1, 1.0, 0.5, 0.01), NO_FAN)


def with_blank_pictures(folder, to, *names):
    shutil.copytree(folder, to)
    for name in names:
        for path in (to / "scan" / "planes").glob(f"{name}*.png"):
            cv2.imwrite(str(path), np.full_like(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), 90))
    return open_set(to)


def test_boards_are_found_where_they_are_and_their_pictures_are_inputs(simulated):
    folder, truth = simulated
    reader = PictureReader(open_set(folder))
    seen = see_boards(reader, calibration(truth), silent)
    assert seen.notes == () and [plane.name for plane in seen.calibration.planes] == ["far", "near"]
    for plane in seen.calibration.planes:
        true = target_plane(truth.known_planes[plane.name])
        off = plane.pi - true
        assert off @ np.linalg.solve(plane.covariance, off) < 25, "χ² of three numbers"
        assert np.linalg.norm(off) < 0.01 * np.linalg.norm(true)
    pictures = {f"scan/planes/{path.name}" for path in (folder / "scan" / "planes").glob("*.png")}
    assert pictures <= set(reader.hashes)
    assert states_no_fan(reader.recording_set.rig) == {"fan": False}


def test_a_board_that_is_not_seen_is_told_and_the_others_are_used(simulated, tmp_path):
    folder, truth = simulated
    seen = see_boards(PictureReader(with_blank_pictures(folder, tmp_path / "set", "far")), calibration(truth), silent)
    assert [plane.name for plane in seen.calibration.planes] == ["near"]
    assert [(note.code, note.values["board"]) for note in seen.notes] == [("scan.board_not_found", "far")]


def test_neither_fan_nor_board_is_refused_with_why_no_board_is_seen(simulated, tmp_path):
    folder, truth = simulated
    reader = PictureReader(with_blank_pictures(folder, tmp_path / "set", "far", "near"))
    with pytest.raises(InputError, match=r"(?i)the board far is not used"):
        see_boards(reader, calibration(truth), silent)


def test_a_set_with_a_fan_and_without_boards_stays_as_it_is(simulated):
    folder, truth = simulated
    known, without_boards = calibration(truth), replace(open_set(folder), known_planes=(), rig=default_rig())
    assert without_boards.rig.has_fan
    assert see_boards(PictureReader(without_boards), known, silent).calibration is known
