"""Planes that were calibrated in the sitting of the scan, by the logs of both recordings, are a check of the day."""

import json
import shutil
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from unittest.mock import patch

import numpy as np
import pytest

from core.calibrate.change import Evidence
from core.calibrate.drift import Drift
from core.calibrate.sitting import Acquisition, hours_of_sitting
from core.files.recording import recording_log
from core.files.recording.recording_log import LOG, LoggedFrame, RecordingLog
from core.files.recording.recording_set import open_set
from core.files.recording.rig import Validity, read_rig, rig_to_toml
from core.files.results.run_file import read_run
from core.findings.finding import Effect
from core.findings.table import FINDINGS
from core.pipeline.steps.check_step import assumed_stability, since_calibration
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.workspace import Workspace
from tests.pipeline.steps.test_check_step import scan_of, unchanged, work_in
from tests.pipeline.steps.test_stated_change import WARMING, stating
from tests.simulated import CUT, copy_of, trisect

__all__ = ["unchanged"]  # a fixture of the checks, used here too

NINE = datetime(2026, 3, 1, 9, tzinfo=UTC)
TEN = NINE + timedelta(hours=1)


def log(folder, at, camera="one"):
    """A log that says of all pictures of a folder that the camera took them at that time."""
    written = RecordingLog(folder)
    for number, path in enumerate(sorted(folder.glob("*.p*"))):
        written.add(LoggedFrame(path.name, number, 0.0, 0, at if camera else None, camera))
    written.close()


@pytest.fixture
def work(unchanged, tmp_path):
    """A rig of which nothing is stated; its planes were taken at nine."""
    shutil.copytree(unchanged / "set", tmp_path / "set")
    shutil.rmtree(tmp_path / "set" / "check")
    made = work_in(unchanged, tmp_path, with_check=False)
    planes = made.path("planes")
    taken = {"camera": "one", "first": NINE.isoformat(), "last": NINE.isoformat()}
    planes.write_text(json.dumps({**json.loads(planes.read_text()), "taken": taken}))
    return Workspace.open(open_set(tmp_path / "set"), made.path("planes").parent)


def change_of(work, of_measured=None):
    frames = work.recording_set.frames
    scanned = work.recording_set.log("scan").acquisition(frames)
    return since_calibration(work.recording_set, work.calibration(), (), scanned, of_measured)


def sources(change):
    return {one.source for one in change.deviations if "change" in one.source}


def codes(work, change):
    return [note.code for note in assumed_stability(work.recording_set, change, work.calibration().fan)]


def scan_folder(work):
    return work.recording_set.frames[0].parent


def test_nothing_is_reckoned_with_that_may_have_changed_before_and_that_is_said(work):
    log(scan_folder(work), TEN)
    change = change_of(work)
    assert sources(change) == set()
    assert change.checked
    assert change.sitting_hours == pytest.approx(1.0)
    assert codes(work, change) == ["scan.calibrated_in_this_sitting"]


@pytest.mark.parametrize(
    ("at", "camera"),
    [(NINE + timedelta(hours=5), "one"), (TEN, "another"), (TEN, ""), (NINE - timedelta(days=7), "one")],
    ids=["five hours later", "another camera", "a replay", "planes of a week later"],
)
def test_frames_of_another_sitting_leave_open_what_may_have_changed(work, at, camera):
    log(scan_folder(work), at, camera)
    change = change_of(work)
    assert sources(change) == {"assumed change"}
    assert not change.checked
    assert codes(work, change) == ["scan.stability_assumed"]


def test_frames_without_a_log_are_of_no_sitting_whatever_their_files_dates_are(work):
    assert sources(change_of(work)) == {"assumed change"}


def test_a_damaged_log_widens_what_is_assumed_and_says_so(work):
    log(scan_folder(work), TEN)
    with (scan_folder(work) / LOG).open("a") as damaged:
        damaged.write("f.png,one,0,0\n")
    change = change_of(work)
    assert sources(change) == {"assumed change"} and not change.checked
    (note,) = work.recording_set.log("scan").notes
    assert FINDINGS[note.code].effect == Effect.WIDENS_U and "U may be larger" in str(note)


def test_frames_that_show_a_change_are_of_no_sitting_whatever_their_log_says(work):
    def moved(deviations):
        changed = np.array([one.source == "change" for one in deviations], dtype=np.float64)
        return Evidence(np.diag(100.0 * changed), np.diag(100.0 * changed), 300.0 * changed)

    log(scan_folder(work), TEN)
    change = change_of(work, moved)
    assert change.surely
    assert change.sitting_hours is None
    assert sources(change) == {"assumed change"}


def test_the_rig_may_say_how_long_a_sitting_is(work):
    log(scan_folder(work), TEN)
    strict = stating(work, validity=Validity(fresh_hours=0.5))
    assert sources(change_of(strict)) == {"assumed change"}
    path = scan_folder(work).parent / "rig.toml"
    path.write_text(rig_to_toml(strict.recording_set.rig))
    assert read_rig(path).validity.fresh_hours == 0.5


def test_what_a_rig_is_stated_to_change_by_warmth_counts_within_a_sitting_too(work):
    log(scan_folder(work), TEN)
    warming = stating(work, drift=WARMING)
    assert sources(change_of(warming)) == {"change"}
    assert "scan.kelvins_since_check_assumed" in codes(warming, change_of(warming))
    assert sources(change_of(stating(work, drift=Drift()))) == set()


def test_planes_remember_when_their_pictures_were_taken_and_by_which_camera(work):
    log(work.recording_set.planes[0].on.parent, NINE)
    planes_step(work)
    assert work.calibration().fan.taken == Acquisition("one", NINE, NINE)


def test_a_damaged_log_is_read_once_told_once_and_keeps_nothing_from_being_measured(tiny_set, tiny_measured, tmp_path):
    recorded = copy_of(tiny_set, tmp_path / "set")
    (recorded / "scan" / LOG).write_text("name,index,time_s,dropped\nf.png,one,0,0\n")
    (recorded / "planes" / LOG).write_text("name,index,time_s,dropped\nf.png,one,0,0\n")
    out = copy_of(tiny_measured, tmp_path / "out")
    with patch.object(recording_log, "read_log", wraps=recording_log.read_log) as read:
        for step, options in (("planes", ()), ("scan", CUT)):
            said = trisect(step, recorded, "--out", out, *options)
            assert said.code == 0, said.err
    assert [call.args[0].name for call in read.call_args_list] == ["planes", "scan"]
    for step, notes in read_run(out / "run.json").notes.items():
        told = [note.code for note in notes].count("set.log_not_read")
        assert told == (step in ("planes", "scan")), step


def test_hours_are_from_the_first_picture_to_the_last_in_whatever_order():
    planes = Acquisition("one", NINE, NINE + timedelta(minutes=30))
    scan = Acquisition("one", TEN, TEN + timedelta(minutes=15))
    assert hours_of_sitting(planes, scan) == hours_of_sitting(scan, planes) == pytest.approx(1.25)
    assert hours_of_sitting(planes, None) is None
    assert hours_of_sitting(planes, replace(scan, camera="two")) is None
    assert hours_of_sitting(planes, scan, fresh_hours=1.0) is None


@pytest.mark.accuracy
def test_a_thickness_of_the_sitting_is_as_sure_as_after_a_check(unchanged, work):
    alone = scan_of(unchanged, work) and gauge_step(work)
    log(scan_folder(work), TEN)
    sitting = scan_of(unchanged, work) and gauge_step(work)
    assert sitting.U_mm < 0.7 * alone.U_mm
    assert abs(sitting.thickness_mm - 50.0) < sitting.U_mm
