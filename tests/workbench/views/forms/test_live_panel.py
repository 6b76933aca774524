"""Controls of a live source, clicked."""

from pathlib import Path
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QLabel

from core.acquire.source import Capabilities, Region, SourceInfo, SourceSettings
from core.files.project.data import new_project
from core.messages import Message, plain
from core.pipeline.live.commands import Auto, Capture, Mark, Pause, Resume, Stop, TakeReference
from core.pipeline.live.events import (
    LiveAdvice,
    LiveAnswered,
    LiveAsk,
    LiveEnded,
    LiveNotice,
    LiveStarted,
    LiveTaken,
    LiveUnplugged,
    LiveView,
)
from core.scan.preview.preflight import Check
from tests.workbench.hand_lane import HandLane
from workbench.bench import Bench
from workbench.notices import Notices
from workbench.pages.live import presenter
from workbench.pages.live.presenter import LivePresenter
from workbench.project_model import ProjectModel
from workbench.settings import AppSettings
from workbench.views import ask
from workbench.views.forms.live_panel import LivePanel, LiveStrip
from workbench.views.forms.source_chooser import SourceChooser
from workbench.views.lists.checks_card import ChecksCard
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def live(qapp, tmp_path):
    lanes = [HandLane(name) for name in ("measuring", "quick", "live")]
    lanes[2].held = {jobs.RUN_LIVE}
    bench = Bench(ProjectModel(), Notices(), AppSettings(tmp_path / "s.ini"), *lanes)
    bench.model.create(tmp_path / "p", new_project("p"))
    return LivePresenter(bench, "camera")


@pytest.fixture
def lane(live):
    return cast(HandLane, live.bench.live)


@pytest.fixture
def panel(live, qtbot):
    made = LivePanel(live)
    qtbot.addWidget(made)
    made.show()
    return made


def open_source(lane):
    can = Capabilities(exposure_ms=(0.1, 60.0), gain_db=(0.0, 24.0), rate_hz=(1.0, 60.0))
    lane.current.reported.emit(LiveStarted("Camera 1", (640, 480), can))


def test_start_becomes_stop(panel, live, lane, qtbot):
    assert panel.start.text() == "Start live"
    qtbot.mouseClick(panel.start, LEFT)
    assert live.running and not live.stopping and panel.start.text() == "Stop"
    qtbot.mouseClick(panel.start, LEFT)
    assert live.stopping and not panel.start.isEnabled()


def test_showing_the_panel_gets_the_process_ready(panel, lane, qtbot):
    qtbot.waitUntil(lambda: lane.prepared)


def test_what_needs_pictures_says_so_until_they_come(panel, lane, qtbot):
    assert not panel.take.isEnabled() and panel.take.toolTip() == "Start the live source first."
    qtbot.mouseClick(panel.start, LEFT)
    assert not panel.take.isEnabled()
    open_source(lane)
    assert panel.take.isEnabled() and "Ctrl+Space" in panel.take.toolTip()


def test_take_pause_and_auto_are_sent(panel, lane, qtbot):
    qtbot.mouseClick(panel.start, LEFT)
    open_source(lane)
    qtbot.mouseClick(panel.take, LEFT)
    qtbot.mouseClick(panel.pause, LEFT)
    assert panel.pause.text() == "Resume"
    qtbot.mouseClick(panel.pause, LEFT)
    panel.auto.click()
    assert [type(one) for one in lane.sent] == [Capture, Pause, Resume, Auto]


def test_the_two_keys_of_a_presenter_take_and_pause_while_it_is_live(panel, lane, qtbot):
    panel.activateWindow()
    qtbot.waitUntil(panel.isActiveWindow)
    qtbot.mouseClick(panel.start, LEFT)
    qtbot.keyClick(panel, Qt.Key.Key_PageDown)
    assert lane.sent == []
    open_source(lane)
    qtbot.keyClick(panel, Qt.Key.Key_PageDown)
    qtbot.keyClick(panel, Qt.Key.Key_PageUp)
    lane.current.reported.emit(LiveAsk(Message("t.leave", "Leave it."), "Continue", Resume()))
    qtbot.keyClick(panel, Qt.Key.Key_PageDown)
    assert [type(one) for one in lane.sent] == [Capture, Pause, Resume]


def test_the_key_of_a_foot_switch_answers_resumes_and_stops_a_scan(live, lane, qtbot):
    panel = LivePanel(LivePresenter(live.bench, "scan"))
    qtbot.addWidget(panel)
    panel.show()
    panel.activateWindow()
    qtbot.waitUntil(panel.isActiveWindow)
    qtbot.mouseClick(panel.start, LEFT)
    open_source(lane)
    lane.current.reported.emit(LiveAsk(Message("t.leave", "Leave it."), "Start", Resume()))
    qtbot.keyClick(panel, Qt.Key.Key_PageDown)
    lane.current.reported.emit(LiveAnswered())
    qtbot.keyClick(panel, Qt.Key.Key_PageUp)
    qtbot.keyClick(panel, Qt.Key.Key_PageDown)
    assert [type(one) for one in lane.sent] == [Resume, Pause, Resume], "paused, it goes on"
    qtbot.keyClick(panel, Qt.Key.Key_PageDown)
    assert isinstance(lane.sent[-1], Stop)


def test_a_presenter_s_third_key_marks_the_frame_of_a_scan(live, lane, qtbot):
    panel = LivePanel(LivePresenter(live.bench, "scan"))
    qtbot.addWidget(panel)
    panel.show()
    panel.activateWindow()
    qtbot.waitUntil(panel.isActiveWindow)
    qtbot.keyClick(panel, Qt.Key.Key_B)
    assert not panel.mark.isEnabled() and panel.mark.isVisible() and not panel.take.isVisible()
    qtbot.mouseClick(panel.start, LEFT)
    open_source(lane)
    qtbot.keyClick(panel, Qt.Key.Key_B)
    qtbot.keyClick(panel, Qt.Key.Key_Period)
    qtbot.mouseClick(panel.mark, LEFT)
    assert [type(one) for one in lane.sent] == [Mark] * 3
    panel.live.pause(True)
    qtbot.keyClick(panel, Qt.Key.Key_B)
    assert type(lane.sent[-1]) is Pause, "nothing is recorded that could be marked"


def test_taken_and_refused_are_heard_unless_the_sound_is_off(panel, live, lane, qtbot, monkeypatch):
    heard = []
    monkeypatch.setattr(QApplication, "beep", lambda: heard.append(1))
    monkeypatch.setattr(presenter, "TWICE_MS", 1)
    qtbot.mouseClick(panel.start, LEFT)
    open_source(lane)
    taken = LiveTaken("view00", np.zeros((2, 2), np.uint8))
    lane.current.reported.emit(taken)
    assert len(heard) == 1
    why = Message("live.nothing_taken", "Nothing was taken. {why}", why="So.")
    lane.current.reported.emit(LiveNotice(why))
    assert len(heard) == 1
    lane.current.reported.emit(LiveNotice(why, refused=True))
    qtbot.waitUntil(lambda: len(heard) == 3)
    panel.sound.click()
    lane.current.reported.emit(taken)
    assert len(heard) == 3
    assert not LivePresenter(live.bench, "planes").sound


def test_a_scan_takes_no_single_pictures(live, qtbot):
    panel = LivePanel(LivePresenter(live.bench, "scan"))
    qtbot.addWidget(panel)
    panel.show()
    assert panel.take.isHidden() and panel.auto.isHidden()


def shown(panel):
    """Names of the settings that can be seen."""
    return [name for name, field in panel.form._fields().items() if not field.isHidden()]


def test_only_settings_the_kind_has_are_shown(panel, live):
    live.settings.set_kind("replay")
    assert shown(panel) == ["rate_hz"]
    panel.form.kind.setCurrentIndex(panel.form.kind.findData("opencv"))
    panel.form.kind.activated.emit(panel.form.kind.currentIndex())
    assert live.settings.kind == "opencv"
    assert shown(panel) == ["exposure_ms", "gain_db", "rate_hz"]
    assert panel.form.exposure.text() == "as it is"
    live.settings.set_kind("genicam")
    assert shown(panel) == ["exposure_ms", "gain_db", "rate_hz", "region"], "choices are known once it is open"


def test_once_the_source_is_open_only_what_it_has_is_shown_within_its_limits(panel, live, lane):
    live.settings.set_kind("genicam")
    live.start()
    can = Capabilities(exposure_ms=(0.5, 40.0), pixel_formats=("Mono8", "Mono12"), sensor=(3840, 2748))
    lane.current.reported.emit(LiveStarted("Camera 1", (3840, 2748), can))
    assert shown(panel) == ["exposure_ms", "pixel_format", "region"]
    panel.form.exposure.setValue(90.0)
    assert live.settings.values.exposure_ms == 40.0
    panel.form.pixel_format.setCurrentIndex(2)
    panel.form.pixel_format.activated.emit(2)
    assert lane.sent[-1].settings == SourceSettings(exposure_ms=40.0, pixel_format="Mono12")
    assert "3840" in panel.form.region.placeholderText()


def test_a_region_is_four_numbers_and_an_empty_one_leaves_it_to_the_camera(panel, live, qtbot):
    live.settings.set_kind("genicam")
    region = panel.form.region
    region.setText("10 20 640")
    region.editingFinished.emit()
    assert panel.form.complaint.text().startswith("A region is four whole numbers")
    assert live.settings.values.region is None
    region.setText("10, 20, 640 x 480")
    region.editingFinished.emit()
    assert panel.form.complaint.isHidden() and region.text() == "10 20 640 480"
    assert live.settings.values.region == Region(10, 20, 640, 480)
    region.setText("0 0 0 0")
    region.editingFinished.emit()
    assert "not within a sensor" in panel.form.complaint.text()
    region.setText("")
    region.editingFinished.emit()
    assert live.settings.values.region is None and panel.form.complaint.isHidden()


def test_a_driver_that_is_missing_is_told_in_one_sentence(panel, live, qtbot):
    quick = cast(HandLane, live.bench.quick)
    quick.answers[jobs.LIST_SOURCES] = lambda kind: ()
    quick.answers[jobs.MISSING_DRIVER] = lambda kind: Message("source.test", "{kind} needs its driver", kind=kind)
    assert panel.form.missing.isHidden()
    live.settings.set_kind("aravis")
    live.settings.look_for_devices()
    qtbot.waitUntil(lambda: not panel.form.missing.isHidden())
    assert panel.form.missing.text() == "Aravis needs its driver."
    live.settings.set_kind("simulated")
    assert panel.form.missing.isHidden()


def test_how_the_frames_are_written_is_chosen_for_a_scan_only(panel, live, qtbot):
    assert panel.form.files.isHidden()
    scan = LivePresenter(live.bench, "scan")
    other = LivePanel(scan)
    qtbot.addWidget(other)
    other.show()
    assert not other.form.files.isHidden()
    other.form.files.setCurrentIndex(1)
    other.form.files.activated.emit(1)
    assert LivePresenter(live.bench, "scan").settings.ending == ".pgm"


def test_the_strip_advises_on_the_exposure_and_sets_it(live, lane, qtbot):
    strip = LiveStrip(live)
    qtbot.addWidget(strip)
    live.start()
    open_source(lane)
    lane.current.reported.emit(LiveAdvice(plain("The stripe is faint: open the aperture."), None))
    assert not strip.isHidden() and strip.take_advice.isHidden()
    lane.current.reported.emit(LiveAdvice(plain("Set 8 ms."), SourceSettings(exposure_ms=8.0)))
    assert strip.advice.text() == "Set 8 ms."
    strip.show()
    qtbot.mouseClick(strip.take_advice, LEFT)
    assert lane.sent[-1].settings.exposure_ms == 8.0
    assert strip.isHidden()
    lane.current.reported.emit(LiveAdvice(plain("Set 8 ms."), SourceSettings(exposure_ms=8.0)))
    lane.current.reported.emit(LiveAdvice())
    assert strip.isHidden()


@pytest.mark.parametrize("theme_name", ["light", "dark"])
def test_checks_have_a_tick_a_cross_or_a_question_mark_and_a_sentence_each(qtbot, theme, theme_name):
    card = ChecksCard()
    qtbot.addWidget(card)
    assert card.isHidden()
    checks = (
        Check("reference", "ok", plain("The reference holds.")),
        Check("lines", "failed", plain("Only 2 of 3 lines are seen.")),
        Check("focus", "unknown", plain("Take the reference first.")),
    )
    card.show_checks(checks)
    theme(theme_name)
    assert not card.isHidden() and card.sentences == tuple(str(check.message) for check in checks)
    signs = [sign for sign, _, _ in card._rows]
    assert [sign.accessibleName() for sign in signs] == ["in order", "not in order", "not known"]
    assert len({sign.shown for sign in signs}) == 3
    card.show_checks(checks[:1])
    assert card.sentences == ("The reference holds.",) and card._rows[1][2].isHidden()
    card.show_checks(())
    assert card.isHidden()


def test_a_setting_is_remembered_and_can_be_left_to_the_camera_again(panel, live):
    live.settings.set_kind("opencv")
    panel.form.exposure.setValue(20.0)
    assert live.settings.values.exposure_ms == 20.0
    assert panel.form.exposure.text() == "20.00 ms"
    panel.form.exposure.setValue(panel.form.exposure.minimum())
    assert live.settings.values.exposure_ms is None


def test_the_source_cannot_be_changed_while_it_runs(panel, qtbot):
    qtbot.mouseClick(panel.start, LEFT)
    assert not panel.form.kind.isEnabled() and not panel.form.device.isEnabled()


def test_devices_found_can_be_chosen_or_typed(panel, live, qtbot):
    from core.acquire.source import SourceChoice

    found = (
        SourceInfo(SourceChoice("opencv", "0"), "Camera 0"),
        SourceInfo(SourceChoice("opencv", "2"), "Camera 2", "x"),
    )
    cast(HandLane, live.bench.quick).answers[jobs.LIST_SOURCES] = lambda kind: found
    live.settings.set_kind("opencv")
    qtbot.mouseClick(panel.form.device.button, LEFT)
    qtbot.waitUntil(lambda: panel.form.device.box.count() == 2)
    assert panel.form.device.box.itemText(1) == "Camera 2"
    panel.form.device.box.setCurrentIndex(1)
    panel.form.device.box.activated.emit(1)
    assert live.settings.choice.id == "2"
    panel.form.device.box.setEditText("rtsp://camera")
    panel.form.device.box.lineEdit().editingFinished.emit()
    assert live.settings.choice.id == "rtsp://camera"


def test_a_replays_folder_is_browsed_for(panel, live, qtbot, monkeypatch, tmp_path):
    live.settings.set_kind("replay")
    monkeypatch.setattr(ask, "choose_folder", lambda *_: tmp_path)
    qtbot.mouseClick(panel.form.device.button, LEFT)
    assert live.settings.choice.id == str(tmp_path)


@pytest.mark.parametrize("answer, stopped", [(0, True), (1, False)])
def test_another_pages_recording_is_asked_about(panel, live, lane, qtbot, monkeypatch, answer, stopped):
    other = LivePresenter(live.bench, "scan")
    other.start()
    asked = []
    monkeypatch.setattr(ask, "ask", lambda *_, harmless=False: (asked.append(harmless), answer)[1])
    qtbot.mouseClick(panel.start, LEFT)
    assert asked == [False], "Return leaves the other recording alone"
    assert live.running is stopped


def test_a_second_space_does_not_stop_what_the_first_has_started(panel, live, qtbot):
    panel.activateWindow()
    panel.start.setFocus()
    qtbot.waitUntil(panel.start.hasFocus)
    for _ in range(2):
        qtbot.keyClick(panel.window().focusWidget(), Qt.Key.Key_Space)
    assert live.running and not live.stopping and panel.start.text() == "Stop"


def test_counts_follow_the_pictures(panel, lane, qtbot):
    qtbot.mouseClick(panel.start, LEFT)
    open_source(lane)
    lane.current.view.emit(LiveView(np.zeros((4, 4), np.uint8), 1, 1, 25.0, 4, 0, None))
    assert panel.counts.text() == "4 views taken · 25 frames/s"


def test_the_strip_asks_and_its_button_answers(live, lane, qtbot):
    strip = LiveStrip(live)
    qtbot.addWidget(strip)
    assert strip.isHidden()
    live.start()
    open_source(lane)
    lane.current.reported.emit(LiveAsk(plain("Switch the three-line laser on."), "Continue", TakeReference()))
    assert not strip.isHidden() and strip.question.text() == "Switch the three-line laser on."
    assert strip.answer.text() == "Continue"
    strip.show()
    qtbot.mouseClick(strip.answer, LEFT)
    assert lane.sent == [TakeReference()]


def test_a_strip_that_was_closed_is_not_opened_by_another_theme(live, lane, qtbot, theme):
    strip = LiveStrip(live)
    qtbot.addWidget(strip)
    live.start()
    open_source(lane)
    lane.current.reported.emit(LiveUnplugged(plain("gone")))
    strip.close()
    for name in ("dark", "light"):
        theme(name)
        assert strip.isHidden()


def test_the_strip_says_that_the_source_is_unplugged(live, lane, qtbot):
    strip = LiveStrip(live)
    qtbot.addWidget(strip)
    live.start()
    open_source(lane)
    lane.current.reported.emit(LiveUnplugged(plain("gone")))
    assert not strip.isHidden() and "is unplugged" in strip.gone.text()


def test_the_strip_says_while_it_runs_that_frames_are_lost_and_which_rate_will_do(live, qtbot):
    scan = LivePresenter(live.bench, "scan")
    strip = LiveStrip(scan)
    qtbot.addWidget(strip)
    lane = cast(HandLane, live.bench.live)
    scan.start()
    open_source(lane)
    picture = np.zeros((4, 4), np.uint8)
    lane.current.view.emit(LiveView(picture, 1, 9, 9.4, 99, 1, None))
    assert strip.isHidden(), "one frame now and then does no harm"
    lane.current.view.emit(LiveView(picture, 1, 12, 9.4, 90, 10, None))
    assert not strip.isHidden() and strip._gone.isHidden()
    assert strip.lost.text() == (
        "10 of 100 pictures were lost on the way; 9.4 a second are taken: choose a rate of 9/s or lower."
    )
    lane.finish(LiveEnded(Path("nowhere"), 0, 0))
    assert strip.isHidden()


def test_everything_without_text_has_a_name(panel):
    for widget in (panel.form.kind, panel.form.device.box, panel.form.exposure, panel.form.gain, panel.form.rate):
        assert widget.accessibleName()


# ---- a folder or a live source


@pytest.fixture
def chooser(qtbot):
    made = SourceChooser(QLabel("live"), what="Folder")
    qtbot.addWidget(made)
    made.show()
    return made


def drop(widget, path):
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path))])
    action, button, keys = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(5, 5), action, data, button, keys)
    QApplication.sendEvent(widget, enter)
    if enter.isAccepted():
        QApplication.sendEvent(widget, QDropEvent(QPointF(5, 5), action, data, button, keys))
    return enter.isAccepted()


def test_a_folder_is_browsed_for(chooser, qtbot, monkeypatch, tmp_path):
    monkeypatch.setattr(ask, "choose_folder", lambda *_: tmp_path)
    with qtbot.waitSignal(chooser.folder_chosen) as chosen:
        qtbot.mouseClick(chooser.browse, LEFT)
    assert chosen.args == [tmp_path]


def test_a_folder_can_be_dropped_also_while_the_live_source_is_shown(chooser, qtbot, tmp_path):
    qtbot.mouseClick(chooser.live, LEFT)
    assert chooser.mode == "live"
    with qtbot.waitSignal(chooser.folder_chosen) as chosen:
        assert drop(chooser, tmp_path)
    assert chosen.args == [tmp_path] and chooser.mode == "folder"


def test_a_dropped_picture_means_its_folder(chooser, qtbot, tmp_path):
    picture = tmp_path / "view.png"
    picture.touch()
    with qtbot.waitSignal(chooser.folder_chosen) as chosen:
        drop(chooser, picture)
    assert chosen.args == [tmp_path]


def test_projects_and_sets_are_left_to_the_window(chooser, tmp_path):
    (tmp_path / "rig.toml").touch()
    assert not drop(chooser, tmp_path)


def test_the_folder_in_use_is_shown(chooser, tmp_path):
    assert "No folder" in chooser.path.text()
    chooser.set_folder(tmp_path, "24 pictures")
    assert chooser.path.toolTip() == str(tmp_path) and chooser.detail.text() == "24 pictures"
