"""Pictures of a check in the set of a rig without a fan: there is nothing that they could check."""

from dataclasses import replace

import numpy as np

from core.calibrate.results import NO_FAN, CameraCalibration
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet
from core.files.recording.rig import default_rig
from core.files.recording.set_listing import PlanePair
from core.pipeline.steps.check_step import check_of_the_day, checked_on_the_day, since_calibration
from core.pipeline.steps.workspace import Calibration
from tests.scan.synthetic import CAMERA


def test_without_a_fan_the_check_is_skipped_and_told_in_one_sentence(tmp_path):
    picture = tmp_path / "a.png"
    picture.touch()
    recording_set = replace(
        RecordingSet("set", default_rig(), {}, (), (), None, (picture,)), check=(PlanePair("check/a", picture, None),)
    )
    calibration = Calibration(CameraCalibration(CAMERA, np.zeros((10, 10)), (), 0.1, 0.1, 1.0, 0.5, 0.01), NO_FAN)
    poses = check_of_the_day(PictureReader(recording_set), calibration)
    assert poses == ()
    change = since_calibration(recording_set, calibration, poses, None)
    assert [note.code for note in change.notes] == ["check.without_fan"]
    assert change.p == 1.0 and not change.checked
    assert not checked_on_the_day(recording_set, NO_FAN)
