"""Controls of a live source, clicked."""

from pathlib import Path
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QLabel

from core.acquire.source import SourceInfo
from core.files.project import new_project
from core.live.events import (
    Auto,
    Capture,
    LiveAsk,
    LiveEnded,
    LiveStarted,
    LiveUnplugged,
    LiveView,
    Pause,
    Resume,
    TakeReference,
)
from tests.workbench.hand_lane import HandLane
from workbench import jobs
from workbench.bench import Bench
from workbench.notices import Notices
from workbench.pages.live_presenter import LivePresenter
from workbench.project_model import ProjectModel
from workbench.settings import AppSettings
from workbench.views import ask
from workbench.views.live_panel import LivePanel, LiveStrip
from workbench.views.source_chooser import SourceChooser

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
    lane.current.told.emit(LiveStarted("Camera 1", (640, 480)))


def test_start_becomes_stop(panel, live, lane, qtbot):
    assert panel.start.text() == "Start live"
    qtbot.mouseClick(panel.start, LEFT)
    assert live.running and panel.start.text() == "Stop"
    qtbot.mouseClick(panel.start, LEFT)
    assert live.stopping and not panel.start.isEnabled()


def test_showing_the_panel_gets_the_process_ready(panel, lane, qtbot):
    qtbot.waitUntil(lambda: lane.warmed)


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


def test_a_scan_takes_no_single_pictures(live, qtbot):
    panel = LivePanel(LivePresenter(live.bench, "scan"))
    qtbot.addWidget(panel)
    panel.show()
    assert panel.take.isHidden() and panel.auto.isHidden()


def test_only_settings_the_kind_has_are_shown(panel, live):
    assert panel.exposure.isHidden() and not panel.rate.isHidden()
    panel.kind.setCurrentIndex(panel.kind.findData("opencv"))
    panel.kind.activated.emit(panel.kind.currentIndex())
    assert live.settings.kind == "opencv"
    assert not panel.exposure.isHidden() and not panel.gain.isHidden()
    assert panel.exposure.text() == "as it is"


def test_a_setting_is_remembered_and_can_be_left_to_the_camera_again(panel, live):
    live.settings.set_kind("opencv")
    panel.exposure.setValue(20.0)
    assert live.settings.values.exposure_ms == 20.0
    assert panel.exposure.text() == "20.00 ms"
    panel.exposure.setValue(panel.exposure.minimum())
    assert live.settings.values.exposure_ms is None


def test_the_source_cannot_be_changed_while_it_runs(panel, qtbot):
    qtbot.mouseClick(panel.start, LEFT)
    assert not panel.kind.isEnabled() and not panel.device.isEnabled()


def test_devices_found_can_be_chosen_or_typed(panel, live, qtbot):
    from core.acquire.source import SourceChoice

    found = (
        SourceInfo(SourceChoice("opencv", "0"), "Camera 0"),
        SourceInfo(SourceChoice("opencv", "2"), "Camera 2", "x"),
    )
    cast(HandLane, live.bench.quick).answers[jobs.LIST_SOURCES] = lambda kind: found
    live.settings.set_kind("opencv")
    qtbot.mouseClick(panel.device.button, LEFT)
    qtbot.waitUntil(lambda: panel.device.box.count() == 2)
    assert panel.device.box.itemText(1) == "Camera 2"
    panel.device.box.setCurrentIndex(1)
    panel.device.box.activated.emit(1)
    assert live.settings.choice.id == "2"
    panel.device.box.setEditText("rtsp://camera")
    panel.device.box.lineEdit().editingFinished.emit()
    assert live.settings.choice.id == "rtsp://camera"


def test_a_replays_folder_is_browsed_for(panel, live, qtbot, monkeypatch, tmp_path):
    live.settings.set_kind("replay")
    monkeypatch.setattr(ask, "choose_folder", lambda *_: tmp_path)
    qtbot.mouseClick(panel.device.button, LEFT)
    assert live.settings.choice.id == str(tmp_path)


@pytest.mark.parametrize("answer, stopped", [(0, True), (1, False)])
def test_another_pages_recording_is_asked_about(panel, live, lane, qtbot, monkeypatch, answer, stopped):
    other = LivePresenter(live.bench, "scan")
    other.start()
    asked = []
    monkeypatch.setattr(ask, "ask", lambda *given: (asked.append(given), answer)[1])
    qtbot.mouseClick(panel.start, LEFT)
    assert len(asked) == 1
    assert live.running is stopped


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
    lane.current.told.emit(LiveAsk("Switch the three-line laser on.", "Continue", TakeReference()))
    assert not strip.isHidden() and strip.question.text() == "Switch the three-line laser on."
    assert strip.answer.text() == "Continue"
    strip.show()
    qtbot.mouseClick(strip.answer, LEFT)
    assert lane.sent == [TakeReference()]


def test_the_strip_says_that_the_source_is_unplugged(live, lane, qtbot):
    strip = LiveStrip(live)
    qtbot.addWidget(strip)
    live.start()
    open_source(lane)
    lane.current.told.emit(LiveUnplugged("gone"))
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
    for widget in (panel.kind, panel.device.box, panel.exposure, panel.gain, panel.rate):
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
