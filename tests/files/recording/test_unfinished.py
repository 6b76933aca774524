import numpy as np
import pytest

from core.errors import InputError
from core.files.pictures import write_picture
from core.files.recording.unfinished import NOTE, Unfinished, forget_recording, note_recording, unfinished_recording

GREY = np.full((4, 6), 90, np.uint8)


def record(folder, *names):
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        write_picture(folder / name, GREY)


def test_a_recording_that_was_begun_is_found_with_its_pictures(tmp_path):
    folder = tmp_path / "recordings" / "scan-20260101-120000"
    note_recording(tmp_path, "scan", folder)
    assert unfinished_recording(tmp_path) is None  # nothing has been recorded yet
    record(folder, "frame00000.png", "frame00001.png", "frame00002.png")
    assert unfinished_recording(tmp_path) == Unfinished("scan", folder, 3)


def test_a_recording_that_was_taken_into_the_project_is_not(tmp_path):
    folder = tmp_path / "recordings" / "camera-20260101-120000"
    note_recording(tmp_path, "camera", folder)
    record(folder, "view00.png")
    forget_recording(tmp_path)
    forget_recording(tmp_path)
    assert unfinished_recording(tmp_path) is None


@pytest.mark.parametrize("text", ["", "{", "[]", '{"step": "scan"}', '{"step": "coffee", "folder": "x"}', "7"])
def test_a_damaged_note_counts_as_none(tmp_path, text):
    note_recording(tmp_path, "scan", tmp_path / "recordings" / "x")
    record(tmp_path / "recordings" / "x", "frame.png")
    (tmp_path / NOTE).write_text(text)
    assert unfinished_recording(tmp_path) is None


def test_a_note_does_not_lead_out_of_the_project(tmp_path):
    record(tmp_path / "outside", "frame.png")
    (tmp_path / "project" / "recordings").mkdir(parents=True)
    (tmp_path / "project" / NOTE).write_text('{"step": "scan", "folder": "../../outside"}')
    assert unfinished_recording(tmp_path / "project") is None


def test_where_nothing_can_be_written_it_is_said(tmp_path):
    (tmp_path / "recordings").write_text("a file")
    with pytest.raises(InputError):
        note_recording(tmp_path, "scan", tmp_path / "recordings" / "x")
