import pytest

from core.errors import InputError
from core.files.recording.marks import MARKS, mark_frame, marked_frames


def test_a_recording_that_nobody_marked_has_no_marks(tmp_path):
    assert marked_frames(tmp_path) == frozenset()


def test_marked_frames_are_read_back_and_a_torn_line_is_none(tmp_path):
    mark_frame(tmp_path, "frame00003.png")
    mark_frame(tmp_path, "frame00017.png")
    with (tmp_path / MARKS).open("a") as file:
        file.write("frame000")
    assert marked_frames(tmp_path) == {"frame00003.png", "frame00017.png"}


def test_a_mark_that_cannot_be_written_is_one_sentence(tmp_path):
    (tmp_path / MARKS).mkdir()
    with pytest.raises(InputError, match=MARKS):
        mark_frame(tmp_path, "frame00003.png")
