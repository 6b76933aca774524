"""Calibrations and checks that lapse: what was recorded then proves nothing."""

import os
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from types import SimpleNamespace

import pytest

from core.files.recording.recording_set import RecordingSet
from core.files.recording.rig import Validity, default_rig
from core.files.recording.set_listing import PlanePair
from core.files.results.rig_history import PastCheck, history_file, keep_check
from core.files.results.run_file import RunRecord
from core.pipeline.steps.validity import doubt_of_the_day
from tests.check_cases import check

NOON = datetime(2026, 5, 4, 12, tzinfo=UTC)
ID, NO_LIMIT = "cam-fan", Validity()


def recorded(tmp_path, validity=NO_LIMIT, calibrated_days=10.0, made_at=None):
    """A recording of NOON, with calibrations so many days older."""

    def picture(name, days):
        path = tmp_path / name
        path.touch()
        os.utime(path, ((NOON - timedelta(days=days)).timestamp(),) * 2)
        return path

    found = RecordingSet(
        "set", replace(default_rig(), validity=validity), {}, (picture("view.png", calibrated_days),),
        (PlanePair("pose", picture("pose.png", calibrated_days), None),), None, (picture("frame.png", 0),),
    )  # fmt: skip
    record = RunRecord("set", "part", NOON, made_at=made_at or {})
    return SimpleNamespace(found=found, record=lambda: record)


def checked(days, p=0.4):
    """A check so many days before NOON."""
    keep_check(ID, replace(PastCheck.of(check(p)), taken_at=NOON - timedelta(days=days), pictures_id=f"{days}"))


def doubt(work, readjusted=None):
    told = doubt_of_the_day(work, SimpleNamespace(id=ID, fan=SimpleNamespace(readjusted=readjusted)))
    return "" if told is None else told.code


def test_what_is_not_stated_has_no_limit(tmp_path):
    assert doubt(recorded(tmp_path, calibrated_days=3000)) == ""


@pytest.mark.parametrize(("age", "code"), [(29.0, ""), (31.0, "validity.calibration_lapsed")])
def test_a_calibration_lapses(tmp_path, age, code):
    assert doubt(recorded(tmp_path, Validity(calibration_days=30), age)) == code


def test_a_calibration_is_as_old_as_the_older_of_its_pictures_and_its_run(tmp_path):
    old = {"camera": NOON - timedelta(days=40)}
    assert doubt(recorded(tmp_path, Validity(calibration_days=30), 1.0, old)) == "validity.calibration_lapsed"
    new = {"camera": NOON, "planes": NOON}
    assert doubt(recorded(tmp_path, Validity(calibration_days=30), 40.0, new)) == "validity.calibration_lapsed"


def test_a_readjustment_is_as_good_as_a_check_of_its_day_and_lapses_as_one(tmp_path):
    def readjusted(days):
        return SimpleNamespace(taken_at=NOON - timedelta(days=days), pictures_id="check", p_after=0.4)

    work = recorded(tmp_path, Validity(check_days=1))
    assert doubt(work, readjusted(0.5)) == ""
    assert doubt(work, readjusted(3)) == "validity.check_lapsed"


def test_a_rig_that_was_never_checked_or_not_lately_proves_nothing(tmp_path):
    work = recorded(tmp_path, Validity(check_days=1))
    assert doubt(work) == "validity.never_checked"
    checked(3)
    assert doubt(work) == "validity.check_lapsed"
    checked(0.5)
    assert doubt(work) == ""


def test_the_nearest_check_failed(tmp_path):
    work = recorded(tmp_path)
    checked(2, p=1e-6)
    assert doubt(work) == "validity.check_failed", "without any limit, too"
    checked(1)
    assert doubt(work) == "", "it was set right before the recording"
    checked(-0.5, p=1e-6)
    assert doubt(work) == "validity.check_failed", "hours after the recording is nearer than the day before"


def test_a_history_that_cannot_be_read_is_no_passed_check(tmp_path):
    checked(0.5)
    history_file(ID).write_text("{")
    assert doubt(recorded(tmp_path)) == "validity.history_unreadable"
