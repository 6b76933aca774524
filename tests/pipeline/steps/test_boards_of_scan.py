"""Boards of a scan are looked for where its method uses them; else that is told, or refused where there is no fan."""

from shutil import copyfile

import pytest

from core.calibrate.results import NO_FAN
from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.pipeline.steps.scan.features import boards_of_scan
from core.pipeline.steps.workspace import Calibration
from core.progress import silent
from core.scan.method import Method
from core.settings.options import Options
from tests.report.report_samples import camera_calibration
from tests.simulated import copy_of

THREE = Options(method=Method.THREE_CROSSINGS)


@pytest.fixture
def with_board(tiny_set, tmp_path):
    folder = copy_of(tiny_set, tmp_path / "set")
    (folder / "scan" / "planes").mkdir()
    copyfile(folder / "scan" / "reference.png", folder / "scan" / "planes" / "board.png")
    return folder


def looked_for(folder, settings):
    return boards_of_scan(PictureReader(open_set(folder)), Calibration(camera_calibration(), NO_FAN), settings, silent)


def test_by_three_crossings_boards_are_told_not_to_be_used(with_board, tiny_set):
    assert [note.code for note in looked_for(with_board, THREE).notes] == ["scan.boards_not_used"]
    assert looked_for(tiny_set, THREE).notes == ()


def test_by_three_crossings_a_rig_without_a_fan_is_refused(with_board):
    rig = with_board / "rig.toml"
    text = rig.read_text(encoding="utf-8")
    before, after = text.split("[laser_fan]")
    rig.write_text(before + after[after.index("\n[") :], encoding="utf-8")
    with pytest.raises(
        InputError, match=r"locates each sweep by the fan alone, and the rig has none.*choose the method"
    ):
        looked_for(with_board, THREE)
