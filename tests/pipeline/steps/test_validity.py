"""Calibrations and checks that lapse: what was recorded then proves nothing."""

import math
import os
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from types import SimpleNamespace

import numpy as np
import pytest

from core.calibrate.results import FanCalibration
from core.files.recording.recording_set import RecordingSet
from core.files.recording.rig import Validity, default_rig
from core.files.recording.set_listing import PlanePair
from core.files.results.rig_history import PastCheck, history_file, store_check
from core.files.results.run_file import RunRecord
from core.findings.proof import OF_SCAN
from core.model import Fan, LightPlane
from core.pipeline.steps.validity import facts_of_the_day, with_size_by_artefact
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

    recording_set = RecordingSet(
        "set", replace(default_rig(), validity=validity), {}, (picture("view.png", calibrated_days),),
        (PlanePair("pose", picture("pose.png", calibrated_days), None),), None, (picture("frame.png", 0),),
    )  # fmt: skip
    record = RunRecord("set", "part", NOON, made_at=made_at or {})
    return SimpleNamespace(recording_set=recording_set, record=lambda: record)


def checked(days, p=0.4):
    """A check so many days before NOON."""
    store_check(ID, replace(PastCheck.of(check(p)), taken_at=NOON - timedelta(days=days), pictures_id=f"{days}"))


def doubts(work, calibration, *, by_planes=False):
    """Codes of all doubts of a scan in which nothing moved or changed; its known planes have passed `by_planes`."""
    facts = replace(facts_of_the_day(work, calibration, checked=by_planes), **dict.fromkeys(OF_SCAN, False))
    return [doubt.note.code for doubt in facts.doubts]


def doubt(work, readjusted=None, *, by_planes=False):
    fan = SimpleNamespace(
        readjusted=readjusted, scale_assumed=False, scale_sd=0.0, converged=True, points_off_alike=False
    )
    calibration = SimpleNamespace(id=ID, fan=fan, camera=SimpleNamespace(converged=True))
    return ", ".join(doubts(work, calibration, by_planes=by_planes))


@dataclass(frozen=True)
class _Calibration:
    """A calibration by its id, with a fan, and a camera of which it is known whether it had settled."""

    fan: FanCalibration
    id: str = ID
    camera: SimpleNamespace = field(default_factory=lambda: SimpleNamespace(converged=True))


def calibrated(*, assumed):
    plane = LightPlane(np.array([0.0, 0.001, 0.002]))
    fan = FanCalibration(Fan((plane,)), Fan((plane,)), (0.0,), (), (), 0.0, None, None, ())
    known = replace(fan, scale_sd=5e-4, scale_assumed=assumed, converged=True, points_off_alike=False)
    return _Calibration(known)


def artefact_measured(days, error_mm=0.02, step_mm=50.0, verdict="passed", of=""):
    """An artefact so many days before NOON, its error known to ±0.06 mm."""
    past = PastCheck(
        NOON - timedelta(days=days), ID, f"artefact {days}", verdict, 0.5, step_mm, error_mm=error_mm,
        unseen_mm=0.06, stated_mm=0.0, artefact="GB 50", e_n=error_mm / 0.06, characteristic=of,
    )  # fmt: skip
    store_check(ID, past)


def size_doubted(work, calibration):
    return "target.size_unconfirmed" in doubts(work, with_size_by_artefact(work, calibration))


def test_a_size_of_the_plane_target_that_nobody_stated_proves_nothing(tmp_path):
    assert size_doubted(recorded(tmp_path), calibrated(assumed=True))
    assert not size_doubted(recorded(tmp_path), calibrated(assumed=False))


def test_an_artefact_confirms_the_size_as_far_as_it_tells(tmp_path):
    work = recorded(tmp_path, Validity(check_days=3))
    checked(0.5)
    assert size_doubted(work, calibrated(assumed=True)), "pictures of a check rest on the same size"
    artefact_measured(5)
    assert size_doubted(work, calibrated(assumed=True)), "too long ago"
    artefact_measured(2)
    assert not size_doubted(work, calibrated(assumed=True))
    known = with_size_by_artefact(work, calibrated(assumed=True)).fan
    assert known.scale_sd == pytest.approx(np.hypot(0.02, 0.03) / 50) and not known.scale_assumed
    artefact_measured(1, step_mm=5.0)
    assert with_size_by_artefact(work, calibrated(assumed=True)).fan.scale_sd == pytest.approx(10 * known.scale_sd)


def test_an_artefact_that_failed_or_whose_certificate_has_lapsed_confirms_nothing(tmp_path):
    work = recorded(tmp_path)
    artefact_measured(3)
    for days, verdict in ((2, "doubtful"), (1, "failed")):
        artefact_measured(days, verdict=verdict)
        assert with_size_by_artefact(work, calibrated(assumed=True)).fan.scale_assumed


def test_of_several_lengths_of_one_scan_the_one_that_failed_counts(tmp_path):
    work = recorded(tmp_path)
    artefact_measured(1, step_mm=20.0, of="ball diameter")
    artefact_measured(1, step_mm=50.0)
    known = with_size_by_artefact(work, calibrated(assumed=True)).fan
    assert known.scale_sd == pytest.approx(math.hypot(0.02, 0.03) / 50.0), "the longest says most"
    artefact_measured(1, step_mm=20.0, of="stairs height 1", verdict="failed")
    assert with_size_by_artefact(work, calibrated(assumed=True)).fan.scale_assumed


def test_a_readjusted_fan_is_confirmed_by_an_artefact_that_says_as_much_as_it_holds(tmp_path):
    work, before = recorded(tmp_path), calibrated(assumed=True)
    readjusted = replace(before, fan=replace(before.fan, readjusted=SimpleNamespace()))
    artefact_measured(1)
    assert with_size_by_artefact(work, readjusted).fan.scale_assumed, "7e-4 are more than 5e-4"
    artefact_measured(0.5, step_mm=100.0)
    assert not with_size_by_artefact(work, readjusted).fan.scale_assumed


def test_a_target_that_does_not_fit_the_camera_proves_nothing_before_an_artefact_has_passed(tmp_path):
    """A point printed aside in every pose shifts the planes, and U does not know by how much."""
    work, true = recorded(tmp_path, Validity(check_days=3)), calibrated(assumed=False)
    off = replace(true, fan=replace(true.fan, points_off_alike=True))

    def doubted():
        return doubts(work, with_size_by_artefact(work, off)) == ["validity.target_points_off"]

    checked(0.5)
    assert doubts(work, true) == []
    assert doubted(), "pictures of a check show the same target"
    artefact_measured(5)
    assert doubted(), "too long ago"
    artefact_measured(2)
    assert not doubted()
    artefact_measured(1, verdict="doubtful")
    assert doubted(), "the nearest one counts"


def test_what_an_artefact_leaves_possible_of_points_off_alike_is_in_u(tmp_path):
    """An artefact that passes within a large U has seen little: so much larger is U of what is measured after it."""
    work, true = recorded(tmp_path), calibrated(assumed=False)
    off = replace(true, fan=replace(true.fan, points_off_alike=True))
    assert with_size_by_artefact(work, off).fan.scale_sd == 5e-4
    artefact_measured(2, step_mm=5.0)
    assert with_size_by_artefact(work, off).fan.scale_sd == pytest.approx(np.hypot(0.02, 0.03) / 5)
    assert with_size_by_artefact(work, true).fan.scale_sd == 5e-4, "a target that fits is as true as stated"
    artefact_measured(1, error_mm=0.0, step_mm=1000.0)
    assert with_size_by_artefact(work, off).fan.scale_sd == 5e-4, "it is never surer than stated"
    artefact_measured(0.5, step_mm=0.3)
    told = doubts(work, with_size_by_artefact(work, off))
    assert told == ["validity.target_points_off"], "lengths within 12 % prove nothing"


def test_planes_that_had_not_settled_prove_nothing(tmp_path):
    true = calibrated(assumed=False)
    told = doubts(recorded(tmp_path), replace(true, fan=replace(true.fan, converged=False)))
    assert told == ["validity.planes_not_settled"]


def test_a_camera_that_had_not_settled_or_of_which_it_is_not_known_proves_nothing(tmp_path):
    true = calibrated(assumed=False)
    for converged, code in ((False, "validity.camera_not_settled"), (None, "validity.planes_unknown")):
        told = doubts(recorded(tmp_path), replace(true, camera=SimpleNamespace(converged=converged)))
        assert told == [code]


def test_planes_of_which_it_is_not_known_whether_they_had_settled_prove_nothing(tmp_path):
    true = calibrated(assumed=False)
    for unknown in ("converged", "points_off_alike"):
        told = doubts(recorded(tmp_path), replace(true, fan=replace(true.fan, **{unknown: None})))
        assert told == ["validity.planes_unknown"]


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


def test_planes_that_agree_stand_in_for_a_check_by_pictures_that_is_missing_or_has_lapsed(tmp_path):
    work = recorded(tmp_path, Validity(check_days=1))
    assert doubt(work, by_planes=True) == ""
    checked(3)
    assert doubt(work, by_planes=True) == ""


def test_planes_that_agree_lift_no_failed_check_and_none_of_an_artefact(tmp_path):
    """Fan and a board of the same print share its error of size and agree all the same."""
    work = recorded(tmp_path, Validity(check_days=1))
    artefact_measured(2)
    assert doubt(work, by_planes=True) == "validity.check_lapsed"
    artefact_measured(0.5, verdict="failed")
    assert doubt(work, by_planes=True) == "validity.check_failed"
    checked(0.25, p=1e-6)
    assert doubt(work, by_planes=True) == "validity.check_failed"


def test_a_history_that_cannot_be_read_is_no_passed_check(tmp_path):
    checked(0.5)
    history_file(ID).write_text("{")
    assert doubt(recorded(tmp_path)) == "validity.history_unreadable"
