"""Decisions of the scan page."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from core.errors import InputError
from core.files.pictures import write_picture
from core.files.project.data import Accepted, new_project
from core.files.project.keys import finished
from core.files.recording.marks import mark_frame
from core.pipeline.live.events import LiveEnded, LiveStarted
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import scan_cases as cases
from workbench.pages.scan import words
from workbench.pages.scan.presenter import ScanPresenter
from workbench.pages.scan.stage import Stage
from workbench.step_state import State
from workbench.work import jobs


@pytest.fixture
def measuring(scan_bench):
    return cast(HandLane, scan_bench.measuring)


@pytest.fixture
def quick(scan_bench):
    return cast(HandLane, scan_bench.quick)


@pytest.fixture
def presenter(scan_bench):
    made = ScanPresenter(scan_bench)
    made.opened()
    return made


@pytest.fixture
def recorded(presenter, scan_folder, quick, qtbot):
    presenter.use_folder(scan_folder)
    qtbot.waitUntil(lambda: bool(presenter.work.frames) and not quick.busy)
    return presenter


@pytest.fixture
def measured(recorded, measuring, quick, qtbot):
    recorded.do_run()
    measuring.finish(cases.summary())
    qtbot.waitUntil(lambda: recorded.work.look is not None and not quick.busy)
    return recorded


def accept(presenter, camera="", fan=""):
    presenter.model.edit("x", replace(presenter.project, accepted=Accepted(camera, fan)))


def test_marked_frames_are_found_again_one_after_the_other(presenter, scan_folder, quick, qtbot):
    names = sorted(path.name for path in scan_folder.glob("frame*.png"))
    for name in (names[1], names[-1]):
        mark_frame(scan_folder, name)
    presenter.use_folder(scan_folder)
    qtbot.waitUntil(lambda: bool(presenter.work.frames) and bool(presenter.work.marked) and not quick.busy)
    presenter.scrub.go_to(0)
    looked_at = []
    for _ in range(3):
        presenter.go_to_next_mark()
        looked_at.append(presenter.scrub.current)
    assert looked_at == [f"scan/{names[1]}", f"scan/{names[-1]}", f"scan/{names[1]}"]
    assert words.frame_line(None, None, marked=True) == "marked"


# ---- what is missing


def test_without_a_recording_it_asks_for_one(presenter):
    assert presenter.stage is Stage.NONE
    assert presenter.blocker() == "Record a scan, or choose a recording, first."


def test_calibrations_come_first(recorded):
    accept(recorded)
    assert recorded.blocker() == "Accept a camera calibration first."
    accept(recorded, "camera-1")
    assert recorded.blocker() == recorded.cannot_measure == "Accept the laser planes first."
    recorded.do_run()
    assert not recorded.run.measuring


def test_a_folder_without_frames_is_told(presenter, tmp_path, qtbot):
    (tmp_path / "empty").mkdir()
    presenter.use_folder(tmp_path / "empty")
    qtbot.waitUntil(lambda: presenter.work.frames == ())
    assert presenter.stage is Stage.EMPTY
    assert presenter.blocker() == "Choose a folder that holds the frames of a scan."


def test_a_folder_with_two_references_is_told_in_its_own_words(presenter, scan_folder, qtbot):
    (scan_folder / "reference.tif").write_bytes((scan_folder / "reference.png").read_bytes())
    presenter.use_folder(scan_folder)
    qtbot.waitUntil(lambda: presenter.work.frames == ())
    assert "2 references" in presenter.blocker()


def test_a_recording_waits_to_be_measured(recorded):
    assert recorded.stage is Stage.RECORDED
    assert recorded.blocker() == "Measure the scan first."
    assert recorded.work.names == tuple(cases.name_of(number) for number in range(cases.FRAMES))
    assert recorded.work.reference.name == "reference.png"


def test_choosing_a_recording_is_undone(recorded, qtbot):
    recorded.model.undo_stack.undo()
    assert recorded.stage is Stage.NONE
    assert recorded.work.names == ()
    recorded.model.undo_stack.redo()
    qtbot.waitUntil(lambda: recorded.stage is Stage.RECORDED)


# ---- measuring


def test_measuring_records_the_scan_and_its_thickness(recorded, measuring, qtbot):
    recorded.do_run()
    assert recorded.stage is Stage.MEASURING
    assert recorded.blocker() == "The scan is being measured."
    measuring.finish(cases.summary())
    assert recorded.stage is Stage.MEASURED and recorded.blocker() == ""
    assert {"scan", "gauge"} <= set(recorded.model.results)
    inspected = recorded.model.results["gauge"]
    assert inspected.rests_on["scan"] == recorded.model.results["scan"].key
    qtbot.waitUntil(lambda: recorded.work.look is not None)


def test_a_part_without_parallel_faces_takes_an_old_thickness_away(measured, measuring):
    assert "gauge" in measured.model.results
    measured.do_run()
    measuring.finish(cases.summary(gauge=None))
    assert "gauge" not in measured.model.results
    assert str(measured.run.no_gauge) == "There are no two parallel faces"
    assert measured.stage is Stage.MEASURED


def test_what_changes_while_it_is_measured_makes_the_result_out_of_date(recorded, measuring):
    recorded.do_run()
    recorded.set_used([cases.name_of(2)], False)
    measuring.finish(cases.summary())
    assert recorded.stage is Stage.OUTDATED


def test_cancelling_keeps_the_result_before(measured, measuring):
    done = measured.model.results["scan"]
    measured.do_run()
    measured.cancel()
    assert measured.stage is Stage.MEASURED
    assert measured.model.results["scan"] is done and measured.work.look is not None


def test_a_failed_measurement_says_why_until_something_is_changed(recorded, measuring):
    recorded.do_run()
    measuring.fail(InputError("no sweep can be located", where="scan"))
    assert recorded.stage is Stage.FAILED
    assert "no sweep can be located" in recorded.run.problem
    assert "could not be measured" in recorded.blocker()
    assert any("no sweep" in notice.text for notice in recorded.bench.notices.all)
    recorded.set_setting("sigma_cut_mm", 0.5)
    assert recorded.stage is Stage.RECORDED
    recorded.model.undo_stack.undo()
    assert recorded.stage is Stage.FAILED


def test_another_project_stops_measuring_and_is_not_given_the_result(recorded, measuring, tmp_path):
    recorded.do_run()
    recorded.model.create(tmp_path / "other", new_project("other"))
    assert not measuring.busy and not recorded.run.measuring
    assert recorded.model.results == {} and recorded.stage is Stage.NONE


def test_pictures_are_fetched_one_at_a_time_and_bring_all_points_since_the_last(recorded, measuring, quick, qtbot):
    quick.answers[jobs.DISPLAY_PICTURE] = lambda *_: (np.zeros((24, 32), np.uint8), 2)
    seen = []
    recorded.run.frame_seen.connect(
        lambda detail, picture, scale: seen.append((detail.index, scale, len(detail.points), detail.renewed))
    )
    recorded.do_run()
    for number in range(cases.FRAMES):
        measuring.current.reported.emit(cases.detail(number))
    qtbot.waitUntil(lambda: len(seen) == 1)
    qtbot.wait(30)
    assert seen == [(0, 2, 30 * cases.FRAMES, False)]
    measuring.current.reported.emit(cases.detail(1, renewed=True))
    measuring.current.reported.emit(cases.detail(2))
    recorded.run.shown()
    qtbot.waitUntil(lambda: len(seen) == 2)
    assert seen[1] == (2, 2, 60, True)
    assert recorded.run.seen.keys() == set(recorded.work.names) and recorded.run.seen[cases.name_of(2)] == (30, None)


def test_a_picture_that_cannot_be_read_does_not_stop_the_others(recorded, measuring, quick, qtbot):
    def read(path, *_):
        if path.name == "frame0000.png":
            raise InputError("is damaged", where=path)
        return np.zeros((24, 32), np.uint8), 2

    quick.answers[jobs.DISPLAY_PICTURE] = read
    seen = []
    recorded.run.frame_seen.connect(lambda detail, *_: seen.append(detail.index))
    recorded.do_run()
    measuring.current.reported.emit(cases.detail(0))
    measuring.current.reported.emit(cases.detail(1))
    qtbot.waitUntil(lambda: seen == [1])


# ---- frames and settings


def test_leaving_a_frame_out_is_undone_and_makes_the_result_out_of_date(measured):
    measured.set_used([cases.name_of(1)], False)
    assert measured.model.undo_stack.undoText() == "leave out frame0001.png"
    assert measured.stage is Stage.OUTDATED
    assert "left-out frames" in measured.state.sentence
    assert measured.blocker() == "The scan is out of date; measure it again."
    measured.model.undo_stack.undo()
    assert measured.stage is Stage.MEASURED


def test_several_frames_are_left_out_as_one_edit(measured):
    before = measured.model.undo_stack.count()
    measured.set_used(measured.work.names[:3], False)
    assert measured.model.undo_stack.count() == before + 1
    assert measured.model.undo_stack.undoText() == "leave out 3 frames"
    measured.set_used(measured.work.names[:1], True)
    assert measured.project.options.excluded == set(measured.work.names[1:3])


def test_with_all_frames_left_out_there_is_nothing_to_measure(recorded):
    recorded.set_used(recorded.work.names, False)
    assert recorded.blocker() == "All frames are left out; let some of them count again."


@pytest.mark.parametrize(
    ("field", "value", "read"),
    [
        ("method", "three-crossings", lambda options: options.method),
        ("sigma_cut_mm", 0.2, lambda options: options.sigma_cut_mm),
        ("width_px", 8.5, lambda options: options.stripe.width_px),
        ("contrast", 40.0, lambda options: options.stripe.contrast),
    ],
)
def test_every_setting_is_an_edit_that_is_undone(measured, field, value, read):
    measured.set_setting(field, value)
    assert read(measured.project.options) == value
    assert measured.settings()[field] == value
    assert measured.stage is Stage.OUTDATED
    measured.model.undo_stack.undo()
    assert measured.stage is Stage.MEASURED


def test_a_shutter_of_which_nothing_is_known_is_stated_and_undone(measured):
    before = measured.settings()["row_time_us"]
    measured.set_setting("row_time_us", 26.0)
    assert measured.project.rig.row_time_us == 26.0
    assert measured.stage is Stage.OUTDATED
    measured.set_setting("row_time_us", None)
    assert measured.settings()["row_time_us"] is None
    measured.model.undo_stack.undo()
    measured.model.undo_stack.undo()
    assert measured.settings()["row_time_us"] == before


def test_the_lasers_colour_is_stated_for_the_scan_alone_and_undone(measured):
    assert measured.settings()["channel"] == ""
    measured.set_setting("channel", "red-green")
    assert measured.settings()["channel"] == measured.project.rig.channel_of("scan") == "red-green"
    assert measured.project.rig.channel_of("planes") is None
    assert measured.stage is Stage.OUTDATED
    measured.model.undo_stack.undo()
    assert measured.settings()["channel"] == ""
    assert measured.stage is Stage.MEASURED


def test_a_stripe_that_is_to_be_given_starts_as_it_was_found(measured):
    assert measured.settings()["automatic"] is True
    measured.set_setting("automatic", False)
    assert (measured.project.options.stripe.width_px, measured.project.options.stripe.contrast) == (5.9, 92)
    measured.set_setting("automatic", True)
    assert measured.project.options.stripe is None


def test_a_setting_that_cannot_be_is_refused_with_a_sentence(recorded):
    recorded.set_setting("sigma_cut_mm", 99.0)
    assert recorded.project.options.sigma_cut_mm == 0.05
    assert any("at most 10 mm" in notice.text for notice in recorded.bench.notices.all)


def test_a_scan_rests_on_calibrations_that_may_be_out_of_date(measured):
    model = measured.model
    camera = finished("camera", measured.project, {})
    model.record("camera", replace(camera, rests_on={**camera.rests_on, "left-out views": "others"}))
    assert measured.state.state is State.OUTDATED
    assert measured.blocker() == "Out of date, because this is: calibrate the camera."


# ---- going through the frames


def test_frames_are_looked_at_only_while_the_page_is_seen(measured, quick, qtbot):
    assert jobs.SHOW_FRAME not in quick.ran
    measured.entered()
    qtbot.waitUntil(lambda: measured.scrub.up_to_date)
    assert measured.scrub.index == cases.FRAMES - 2, "the last one that is used meets most of the fan"
    measured.left()
    ran = quick.ran.count(jobs.SHOW_FRAME)
    measured.scrub.step(1)
    qtbot.wait(20)
    assert quick.ran.count(jobs.SHOW_FRAME) == ran


def test_stepping_stops_at_both_ends(measured, quick, qtbot):
    measured.entered()
    measured.scrub.go_to(99)
    assert measured.scrub.index == cases.FRAMES - 1
    measured.scrub.step(1)
    assert measured.scrub.index == cases.FRAMES - 1
    measured.scrub.go_to(-5)
    assert measured.scrub.index == 0
    qtbot.waitUntil(lambda: measured.scrub.up_to_date)


def test_fast_scrubbing_passes_frames_over(measured, quick, qtbot):
    measured.entered()
    qtbot.waitUntil(lambda: measured.scrub.up_to_date)
    ran = quick.ran.count(jobs.SHOW_FRAME)
    for index in range(cases.FRAMES):
        measured.scrub.go_to(index)
    qtbot.waitUntil(lambda: measured.scrub.up_to_date)
    assert quick.ran.count(jobs.SHOW_FRAME) <= ran + 2
    assert measured.scrub.stages.name == cases.name_of(cases.FRAMES - 1)


def test_a_frame_that_cannot_be_shown_says_why(measured, quick, qtbot):
    def refuse(*_):
        raise InputError("the picture is damaged", where="frame0003.png")

    quick.answers[jobs.SHOW_FRAME] = refuse
    measured.entered()
    qtbot.waitUntil(lambda: measured.scrub.problem != "")
    assert "damaged" in measured.scrub.problem and measured.scrub.stages is None
    assert measured.bench.notices.all == []


def test_points_of_a_frame_are_those_measured_from_it(measured, qtbot):
    measured.entered()
    measured.scrub.choose(cases.name_of(2))
    qtbot.waitUntil(lambda: measured.scrub.up_to_date)
    uv, sigma = measured.points_of_frame()
    assert len(uv) == len(sigma) == 1500 // cases.FRAMES


def test_frames_of_another_recording_are_not_judged_by_the_old_result(measured, tmp_path, scan_folder, quick, qtbot):
    other = tmp_path / "other" / "scan"
    other.mkdir(parents=True)
    write_picture(other / "frame0000.png", np.zeros((48, 64), np.uint8))
    measured.use_folder(other)
    qtbot.waitUntil(lambda: measured.work.names == (cases.name_of(0),) and not quick.busy)
    assert measured.record_of(cases.name_of(0)) is None
    assert measured.work.look is not None and measured.stage is Stage.OUTDATED


# ---- live


@pytest.fixture
def lane(scan_bench):
    return cast(HandLane, scan_bench.live)


def record(presenter, lane, scan_folder, qtbot, frames=cases.FRAMES):
    qtbot.waitUntil(lambda: not presenter.bench.quick.busy)
    presenter.do_live()
    lane.current.reported.emit(LiveStarted("Camera 1", cases.SIZE))
    assert presenter.stage is Stage.LIVE
    lane.finish(LiveEnded(scan_folder, frames, 0))


def test_a_recording_blocks_until_it_is_stopped(presenter, lane, qtbot):
    qtbot.waitUntil(lambda: not presenter.bench.quick.busy)
    presenter.do_live()
    assert presenter.blocker() == "Stop the recording first."
    assert presenter.model.is_recording
    lane.current.view.emit(cases.live_view(0, stage="paused"))
    assert presenter.live_stage == "paused"
    presenter.live.stop()
    lane.finish(LiveEnded(presenter.model.folder / "recordings" / "none", 0, 0))
    assert presenter.stage is Stage.NONE and not presenter.model.is_recording


def test_the_calibrations_are_given_to_the_recording(presenter, lane, qtbot):
    qtbot.waitUntil(lambda: presenter.work.camera is not None)
    presenter.do_live()
    request = lane.waiting[0][2][0]
    assert (request.camera, request.fan) == ("camera", "fan")


def test_a_recording_does_not_start_before_the_calibrations_are_read(scan_bench, quick):
    quick.held = {jobs.ACCEPTED_CALIBRATION}
    presenter = ScanPresenter(scan_bench)
    presenter.opened()
    assert presenter.live.cannot_start() == "The calibrations are being read."
    presenter.do_live()
    assert not presenter.live.running


def test_damaged_calibrations_do_not_keep_anybody_from_recording(scan_bench, quick, qtbot):
    def damaged(*_):
        raise InputError("the file is damaged", where="camera-1.json")

    quick.answers[jobs.ACCEPTED_CALIBRATION] = damaged
    presenter = ScanPresenter(scan_bench)
    presenter.opened()
    qtbot.waitUntil(lambda: presenter.work.calibrations_read)
    assert presenter.live.cannot_start() == "" and presenter.work.camera is None


def test_no_recording_starts_while_a_scan_is_measured(recorded):
    recorded.do_run()
    assert "being measured" in recorded.live.cannot_start()
    recorded.do_live()
    assert not recorded.live.running


def test_choosing_another_recording_ends_measuring_this_one(recorded, measuring, tmp_path):
    recorded.do_run()
    (tmp_path / "other").mkdir()
    recorded.use_folder(tmp_path / "other")
    assert not measuring.busy and not recorded.run.measuring


def test_after_a_recording_the_measurement_starts_by_itself(presenter, lane, measuring, scan_folder, qtbot):
    record(presenter, lane, scan_folder, qtbot)
    assert presenter.folder == scan_folder
    assert presenter.stage is Stage.MEASURING and presenter.run.by_itself
    assert measuring.waiting[0][1] == jobs.WATCH_SCAN
    assert measuring.waiting[0][2][1] == presenter.project


def test_without_calibrations_a_recording_is_kept_for_later(presenter, lane, measuring, scan_folder, qtbot):
    accept(presenter)
    record(presenter, lane, scan_folder, qtbot)
    assert not measuring.busy
    assert any("once its calibrations are accepted" in notice.text for notice in presenter.bench.notices.all)
    assert presenter.blocker() == "Accept a camera calibration first."


def test_leaving_the_project_while_scanning_keeps_the_recording_unmeasured(
    presenter, lane, measuring, scan_folder, qtbot
):
    qtbot.waitUntil(lambda: not presenter.bench.quick.busy)
    presenter.do_live()
    lane.current.reported.emit(LiveStarted("Camera 1", cases.SIZE))
    presenter.model.leaving.emit()
    lane.finish(LiveEnded(scan_folder, cases.FRAMES, 0))
    assert presenter.folder == scan_folder and not measuring.busy


def test_a_recording_of_nothing_changes_nothing(presenter, lane, measuring, scan_folder, qtbot):
    record(presenter, lane, scan_folder, qtbot, frames=0)
    assert presenter.stage is Stage.NONE and not measuring.busy
