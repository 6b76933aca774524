"""An error that is passed on is told in the reader's language, not in the English of the code that raised it."""

import pickle
from contextlib import contextmanager

import numpy as np
import pytest
from pydantic import BaseModel

from core.checks.repeats import repeat_statistics
from core.cli.preparing import target_of_words
from core.errors import InputError, WrongValue
from core.files.complaints import checked
from core.files.exchange.imported import imported_camera
from core.files.pictures import write_picture
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_log import LOG
from core.files.recording.recording_set import open_set
from core.image.stripes.stripe import StripeSettings
from core.messages import Command, Message
from core.model import Camera
from core.pipeline.steps.camera_step import see_views
from core.pipeline.steps.planes_step import measure_poses
from core.translations import PSEUDO, language, strange

RIG = """
[camera_target]
kind = "charuco"
squares = [9, 6]
square_mm = 10.0
marker_mm = 7.0
dictionary = "DICT_4X4_50"
[plane_target]
kind = "black_square"
side_mm = 60.0
[laser_fan]
lines = 1
"""


class File(BaseModel):
    stripe: StripeSettings


def pseudo(message):
    return language(PSEUDO)(message)


@contextmanager
def refused(english):
    """What is within raises an InputError that has this in English and, translated, in another language."""
    with pytest.raises(InputError) as error:
        yield
    assert english in str(error.value)
    assert strange(english) in error.value.text_in(language(PSEUDO))


@pytest.fixture
def recorded(tmp_path):
    for name in ("camera/a", "planes/p", "scan/f"):
        (tmp_path / name).parent.mkdir()
        path = tmp_path / f"{name}.png"
        write_picture(path, np.arange(1200, dtype=np.uint8).reshape(30, 40))
        path.write_bytes(path.read_bytes()[:-20])
    (tmp_path / "rig.toml").write_text(RIG)
    return tmp_path


def test_a_damaged_picture_of_the_camera_target(recorded):
    (view,) = see_views(PictureReader(open_set(recorded))).views
    assert str(view.reason) == "the picture ends early"
    assert strange("ends early") in pseudo(view.reason)


def test_a_damaged_picture_of_the_plane_target(recorded):
    recording_set = open_set(recorded)
    (pose,) = measure_poses(PictureReader(recording_set), Camera((40, 30), [[50, 0, 20], [0, 50, 15], [0, 0, 1]]))
    assert str(pose.reason) == f"{recorded / 'planes' / 'p.png'}: the picture ends early"
    assert strange("ends early") in pseudo(pose.reason)


def test_a_damaged_log_of_a_recording(recorded):
    (recorded / "scan" / LOG).write_text("name,index,time_s,dropped\nf.png,one,0,0\n")
    (note,) = open_set(recorded).log("scan").notes
    assert "line is damaged" in str(note)
    assert "ļííñéé ííš dáámááĝééd" in pseudo(note)


def test_a_target_that_cannot_be():
    with pytest.raises(InputError) as error:
        target_of_words("checkerboard", 2, 2, 10.0, None, "", asymmetric=False)
    assert strange("inner corners") in error.value.text_in(language(PSEUDO))


def test_a_camera_of_another_program_that_cannot_be(tmp_path):
    with refused("the focal lengths on the diagonal of matrix must be positive"):
        imported_camera(tmp_path, (40, 30), [[-50, 0, 20], [0, 50, 15], [0, 0, 1]], [0.0] * 5)


def test_a_value_that_a_data_type_within_a_file_refuses(tmp_path):
    with pytest.raises(InputError) as error:
        checked(File, {"stripe": {"width_px": -1, "contrast": 60}}, tmp_path)
    assert "stripe: width_px is −1.0, not a positive number" in str(error.value)
    assert "Value error" not in error.value.text_in(language(PSEUDO))


def test_a_refused_value_is_an_ordinary_error_of_pythons_too():
    with pytest.raises(ValueError, match="repeats need") as error:
        repeat_statistics([])
    again = pickle.loads(pickle.dumps(error.value))
    assert isinstance(again, WrongValue)
    assert again.what == Message("study.no_repeats", "repeats need one finite thickness or more")


def test_a_sentence_has_the_signs_of_the_readers_language():
    error = InputError(Message("file.missing", "the file is missing"), where="rig.toml", todo="x")
    assert error.text_in() == "rig.toml: the file is missing; x."
    assert error.text_in(language("zh_CN")) == "rig.toml：缺少该文件；x。"
    how = Message("advice.measure_scan_first", "measure the scan first{command}", command=Command("trisect scan SET"))
    assert language("zh_CN")(how) == "先测量该扫描：trisect scan SET"
