"""Live recordings as the pages steer them."""

from dataclasses import replace
from datetime import UTC, datetime
from typing import cast

import numpy as np
import pytest

from core.acquire.settings import Capabilities
from core.acquire.source import SourceInfo
from core.files.project.data import Done
from core.messages import plain
from core.pipeline.live.commands import Auto, Capture, Configure, Discard, Pause, Resume, Stop, TakeReference
from core.pipeline.live.events import (
    LiveAdvice,
    LiveAnswered,
    LiveAsk,
    LiveBack,
    LiveChecks,
    LiveEnded,
    LiveStarted,
    LiveTaken,
    LiveUnplugged,
    LiveView,
)
from core.scan.preview.preflight import Check
from tests.workbench.hand_lane import HandLane
from workbench.pages.live.presenter import LivePresenter
from workbench.work import jobs
from workbench.work.worker import Failure


@pytest.fixture
def lane(camera_bench):
    return cast(HandLane, camera_bench.live)


@pytest.fixture
def live(camera_bench):
    return LivePresenter(camera_bench, "camera")


@pytest.fixture
def running(live, lane):
    live.start()
    lane.current.reported.emit(LiveStarted("Camera 1", (640, 480)))
    return live


def request_of(lane):
    return lane.waiting[0][2][0]


def view(recorded=3, dropped=0):
    return LiveView(np.zeros((48, 64), np.uint8), 10, 7, 12.0, recorded, dropped, None)


def test_a_recording_gets_a_new_folder_of_its_own_in_the_project(live, lane):
    live.start()
    request = request_of(lane)
    assert request.folder.parent == live.model.folder / "recordings"
    assert request.folder.name.startswith(f"camera-{datetime.now():%Y%m%d-}")
    assert not request.folder.exists()
    assert request.step == "camera" and request.auto
    assert request.source.kind == "simulated"


def test_nothing_starts_without_a_project(live, lane):
    live.model.close()
    live.start()
    assert not live.running


def test_the_state_is_told_in_words(live, lane):
    assert live.state_text() == "The live source is off."
    live.start()
    assert live.state_text() == "Opening the source …" and not live.live
    lane.current.reported.emit(LiveStarted("Camera 1", (640, 480)))
    assert live.state_text() == "Live: Camera 1" and live.live
    live.pause(True)
    assert live.state_text() == "Paused: Camera 1"
    live.stop()
    assert live.state_text() == "Stopping …" and not live.live


def test_commands_go_to_the_source(running, lane):
    running.capture()
    running.set_auto(False)
    running.pause(True)
    running.pause(True)
    running.pause(False)
    running.discard("view02")
    sent = [type(command) for command in lane.sent]
    assert sent == [Capture, Auto, Pause, Resume, Discard]


def test_nothing_is_taken_before_the_source_is_open(live, lane):
    live.start()
    live.capture()
    live.pause(True)
    assert lane.sent == []


def test_a_view_is_passed_on_and_answered_once(running, lane, qtbot):
    with qtbot.waitSignal(running.view):
        lane.current.view.emit(view(recorded=3))
    assert running.counts_text() == "3 views taken · 12 frames/s"
    assert lane.sent == []
    running.shown()
    assert lane.sent == ["shown"]


def test_a_scan_says_how_many_frames_were_lost(camera_bench, lane):
    scan = LivePresenter(camera_bench, "scan")
    scan.start()
    lane.current.view.emit(view(recorded=40, dropped=2))
    assert scan.counts_text() == "40 frames recorded · 12 frames/s · 2 lost"
    assert not scan.auto


def test_a_scan_that_lost_frames_says_at_its_end_which_rate_can_be_followed(camera_bench, lane, tmp_path):
    scan = LivePresenter(camera_bench, "scan")
    scan.start()
    lane.current.view.emit(view(recorded=40, dropped=10))
    lane.finish(LiveEnded(tmp_path / "scan", 45, 15))
    (notice,) = [one for one in camera_bench.notices.all if one.level == "warning"]
    assert notice.text == (
        "15 of 60 pictures were lost on the way; 12.0 a second are taken: choose a rate of 12/s or lower."
    )


def test_views_and_poses_need_not_every_frame(running, lane):
    lane.current.view.emit(view(recorded=3, dropped=50))
    assert running.lost_text() == ""


def test_what_is_asked_is_answered_with_its_own_command(running, lane, qtbot):
    with qtbot.waitSignal(running.asked) as asked:
        lane.current.reported.emit(LiveAsk(plain("Switch the laser on."), "Continue", TakeReference()))
    assert asked.args == ["Switch the laser on.", "Continue"]
    running.answer()
    assert lane.sent == [TakeReference()]
    with qtbot.waitSignal(running.asked) as asked:
        lane.current.reported.emit(LiveAnswered())
    assert asked.args == ["", ""] and running.question == ("", "")


def test_an_unplugged_source_is_told_once_and_so_is_its_return(running, lane, qtbot):
    with qtbot.waitSignal(running.unplugged):
        lane.current.reported.emit(LiveUnplugged(plain("Camera 1 is gone.")))
    assert running.gone and running.state_text() == "Camera 1 is unplugged."
    with qtbot.waitSignal(running.back):
        lane.current.reported.emit(LiveBack())
    assert not running.gone
    texts = [notice.text for notice in running.bench.notices.all]
    assert texts == ["Camera 1 is gone.", "Camera 1 is back; the recording goes on."]


def test_a_finished_recording_becomes_the_source_and_that_is_undone(running, lane, qtbot):
    folder = request_of(lane).folder
    folder.mkdir(parents=True)
    running.stop()
    assert lane.sent == [Stop()]
    with qtbot.waitSignal(running.ended):
        lane.finish(LiveEnded(folder, 12, 0))
    assert running.model.project.sources.camera == f"recordings/{folder.name}"
    assert running.model.undo_stack.undoText() == "record views of the target"
    running.model.undo_stack.undo()
    assert running.model.project.sources.camera == ""


def test_a_new_recording_lets_in_what_was_left_out_of_the_last_one(running, lane):
    project = running.model.project
    options = replace(project.options, excluded=frozenset({"camera/view01.png", "scan/frame0001.png"}))
    running.model.edit("x", replace(project, options=options))
    lane.finish(LiveEnded(request_of(lane).folder, 5, 0))
    assert running.model.project.options.excluded == {"scan/frame0001.png"}


def test_a_recording_without_pictures_changes_nothing(running, lane):
    lane.finish(LiveEnded(request_of(lane).folder, 0, 0))
    assert running.model.project.sources.camera == ""
    assert not running.model.undo_stack.canUndo()


def test_why_a_recording_ended_by_itself_is_told(running, lane):
    lane.finish(LiveEnded(request_of(lane).folder, 4, 0, plain("The disk is full.")))
    assert running.bench.notices.all[-1].text == "The disk is full."
    assert running.model.project.sources.camera


def test_what_was_recorded_is_kept_when_the_process_dies(running, lane, qtbot):
    lane.current.view.emit(view(recorded=6))
    with qtbot.waitSignal(running.ended) as ended:
        lane.fail(Failure("ProcessEnded", "the measuring process ended unexpectedly", ""))
    assert ended.args[0].recorded == 6
    assert running.model.project.sources.camera
    assert "ended unexpectedly" in running.bench.notices.all[-1].text
    assert not running.running


def test_a_source_that_does_not_stop_is_ended(running, lane, qtbot, monkeypatch):
    running._deadline.setInterval(10)
    lane.current.view.emit(view(recorded=2))
    running.stop()
    qtbot.waitUntil(lambda: not running.running)
    assert running.model.project.sources.camera


def test_another_pages_recording_is_stopped_only_after_asking(running, lane, camera_bench, qtbot):
    scan = LivePresenter(camera_bench, "scan")
    with qtbot.waitSignal(scan.other_running) as question:
        scan.start()
    assert "Another page is recording" in question.args[0]
    assert not scan.running and lane.sent == []
    scan.start(stop_other=True)
    assert lane.sent == [Stop()]
    lane.finish(LiveEnded(request_of(lane).folder, 3, 0))
    assert not running.running and scan.running
    assert request_of(lane).step == "scan"


def test_leaving_the_project_ends_the_recording_and_keeps_it_in_the_project(running, lane, qtbot):
    folder = request_of(lane).folder
    running.model.leaving.emit()
    assert running.stopping and lane.sent == [Stop()]
    assert running.model.is_recording
    with qtbot.waitSignal(running.model.recordings_over):
        lane.finish(LiveEnded(folder, 8, 0))
    assert not running.running and not running.model.is_recording
    assert running.model.project.sources.camera == f"recordings/{folder.name}"


def test_a_recording_of_another_project_does_not_change_this_one(running, lane, tmp_path):
    from core.files.project.data import new_project

    running.model.create(tmp_path / "second", new_project("second"))
    assert running.stopping
    lane.finish(LiveEnded(request_of(lane).folder, 8, 0))
    assert running.model.project.sources.camera == ""


def test_settings_are_each_kinds_own_and_outlive_the_program(live, camera_bench):
    live.settings.set_kind("opencv")
    live.settings.set_id("1")
    live.settings.set_value("exposure_ms", 12.5)
    live.settings.set_kind("replay")
    assert live.settings.choice.id == "" and live.settings.values.exposure_ms is None
    again = LivePresenter(camera_bench, "camera")
    again.settings.set_kind("opencv")
    assert again.settings.choice.id == "1"
    assert again.settings.values.exposure_ms == 12.5
    assert LivePresenter(camera_bench, "scan").settings.values.exposure_ms is None


def test_settings_reach_a_running_source(running, lane):
    running.settings.set_kind("opencv")
    lane.sent.clear()
    running.settings.set_value("gain_db", 6.0)
    assert isinstance(lane.sent[0], Configure) and lane.sent[0].settings.gain_db == 6.0


def test_devices_are_listed_in_the_quick_lane(live, camera_bench, qtbot):
    choices = []

    def listed(kind):
        choices.append(kind)
        return (SourceInfo(live.settings.choice, "Camera 1"),)

    cast(HandLane, camera_bench.quick).answers[jobs.LIST_SOURCES] = listed
    live.settings.set_kind("opencv")
    live.settings.look_for_devices()
    assert live.settings.looking
    qtbot.waitUntil(lambda: not live.settings.looking)
    assert choices == ["opencv"] and live.settings.devices[0].name == "Camera 1"


def test_pictures_taken_are_passed_on(running, lane, qtbot):
    with qtbot.waitSignal(running.taken) as taken:
        lane.current.reported.emit(LiveTaken("view00", np.zeros((4, 4), np.uint8)))
    assert taken.args[0].name == "view00"


def test_new_views_are_added_to_those_that_are_there(running, lane, camera_bench, qtbot):
    first = request_of(lane).folder
    first.mkdir(parents=True)
    (first / "view00.png").write_text("first")
    lane.finish(LiveEnded(first, 1, 0))
    assert running.can_add
    project = running.model.project
    options = replace(project.options, excluded=frozenset({"camera/view00.png"}))
    running.model.edit("x", replace(project, options=options))
    running.set_adding(True)
    running.start()
    second = request_of(lane).folder
    second.mkdir(parents=True)
    (second / "view00.png").write_text("second")
    with qtbot.waitSignal(running.ended):
        lane.finish(LiveEnded(second, 1, 0))
    assert running.model.project.sources.camera == f"recordings/{second.name}"
    assert {path.name: path.read_text() for path in second.iterdir()} == {
        "view00.png": "first",
        "view01.png": "second",
    }
    assert running.model.project.options.excluded == {"camera/view00.png"}
    assert not running.adding


def test_a_scan_is_never_added_to_another(camera_bench):
    assert not LivePresenter(camera_bench, "scan").can_add


def test_recordings_of_one_second_have_folders_of_their_own(live, lane):
    live.start()
    first = request_of(lane).folder
    first.mkdir(parents=True)
    lane.finish(LiveEnded(first, 0, 0))
    live.start()
    assert request_of(lane).folder != first


def test_each_step_and_each_source_keeps_its_own_settings(live, camera_bench):
    scan = LivePresenter(camera_bench, "scan")
    for presenter, exposure_ms in ((live, 40.0), (scan, 2.0)):
        presenter.settings.set_kind("genicam")
        presenter.settings.set_id("one")
        presenter.settings.set_value("exposure_ms", exposure_ms)
    live.settings.set_id("two")
    assert live.settings.values.exposure_ms is None
    live.settings.set_id("one")
    assert live.settings.values.exposure_ms == 40.0
    assert LivePresenter(camera_bench, "scan").settings.values.exposure_ms == 2.0


def test_a_request_says_how_old_the_calibrations_are_and_how_frames_are_written(camera_bench, lane):
    scan = LivePresenter(camera_bench, "scan")
    scan.settings.set_ending(".pgm")
    scan.start()
    assert request_of(lane).ending == ".pgm" and request_of(lane).calibrated_s is None
    lane.finish(LiveEnded(request_of(lane).folder, 0, 0))
    older, newer = datetime(2026, 1, 2, tzinfo=UTC), datetime(2026, 3, 4, tzinfo=UTC)
    scan.model.record_all({"camera": Done("c", at=older), "planes": Done("p", at=newer)})
    scan.start()
    assert request_of(lane).calibrated_s == older.timestamp()


def test_checks_and_advice_are_gone_with_the_recording(running, lane):
    lane.current.reported.emit(LiveChecks((Check("reference", "ok", plain("The reference holds.")),)))
    lane.current.reported.emit(LiveAdvice(plain("Too bright.")))
    assert running.checks[0].state == "ok" and str(running.advice.sentence) == "Too bright."
    lane.finish(LiveEnded(request_of(lane).folder, 0, 0))
    assert running.checks == () and running.advice.sentence is None


@pytest.mark.parametrize(("told_us", "word"), [(25.8, "rolling shutter, 25.8 µs"), (0.0, "global shutter")])
def test_the_shutter_that_a_camera_tells_of_is_taken_over_once_and_can_be_undone(live, lane, told_us, word):
    live.start()
    lane.current.reported.emit(LiveStarted("Camera 1", (640, 480), Capabilities(row_time_us=told_us)))
    assert live.model.project.rig.row_time_us == told_us
    assert word in live.bench.notices.all[-1].text
    live.model.undo_stack.undo()
    assert live.model.project.rig.row_time_us is None


def test_a_shutter_that_is_stated_or_not_told_stays(live, lane):
    project = live.model.project
    live.model.edit("state it", replace(project, rig=replace(project.rig, row_time_us=26.0)))
    live.start()
    lane.current.reported.emit(LiveStarted("Camera 1", (640, 480), Capabilities(row_time_us=0.0)))
    lane.current.reported.emit(LiveStarted("Camera 1", (640, 480)))
    assert live.model.project.rig.row_time_us == 26.0
