"""The camera page, clicked."""

import re
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication

from core.image.targets.target_view import OtherBoard
from core.messages import plain
from core.pipeline.live.commands import LookFor, Stop
from core.pipeline.live.events import CameraDetail, LiveEnded, LiveStarted, LiveTaken, LiveView
from core.report.facts.of_camera import parameter_fact
from core.translations import language
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages.conftest import find
from tests.workbench.pages.places import moved, places
from workbench.language import choose
from workbench.pages.calibration.stage import Stage
from workbench.pages.camera import words
from workbench.pages.camera.page import CameraPage
from workbench.pages.camera.presenter import CameraPresenter
from workbench.pages.words import fact_row
from workbench.views import ask
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def page(camera_bench, qtbot):
    made = CameraPage(CameraPresenter(camera_bench))
    made.presenter.opened()
    made._opened()
    qtbot.addWidget(made)
    made.resize(1100, 700)
    made.show()
    return made


@pytest.fixture
def solved(page, views_folder, qtbot):
    page.source.folder_chosen.emit(views_folder)
    qtbot.waitUntil(lambda: page.presenter.work.judgement is not None, timeout=30_000)
    qtbot.waitUntil(lambda: not page.presenter.bench.quick.busy)
    return page


@pytest.fixture
def lane(camera_bench):
    return cast(HandLane, camera_bench.live)


def live_view(
    uv=None, sentence="Hold still.", missing=("Record at least 10 views; there are 2.",), wanted=None, counted=None
):
    cells = np.eye(12, 16, dtype=bool)
    detail = CameraDetail(7, uv, plain(sentence), cells, tuple(map(plain, missing)), 2, True, wanted, counted)
    return LiveView(np.zeros((48, 64), np.uint8), 10, 7, 12.0, 2, 0, detail)


def start_live(page, lane, qtbot):
    qtbot.mouseClick(page.live_panel.start, LEFT)
    lane.current.reported.emit(LiveStarted("Camera 1", (640, 480)))


def test_an_empty_page_offers_to_start_where_a_live_source_is_chosen(page, lane, qtbot):
    start = page.picture.image.empty_state.button
    qtbot.waitUntil(lambda: start.text() == "Start live" and start.isEnabled())
    qtbot.mouseClick(start, LEFT)
    assert lane.current is not None and page.presenter.stage is Stage.LIVE


def test_an_empty_page_says_what_to_do_next_and_offers_it(page, qtbot, monkeypatch, views_folder):
    page.source.set_mode("folder")
    qtbot.waitUntil(lambda: page.picture.image.empty_state.button.text() == "Choose folder …")
    assert "Take pictures of the target" in page.picture.image.empty_state.message
    assert page.card.title.text() == "No pictures yet"
    assert page.live_panel.start.property("primary")
    monkeypatch.setattr(ask, "choose_folder", lambda *_: views_folder)
    qtbot.mouseClick(page.picture.image.empty_state.button, LEFT)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED)


def test_there_is_one_primary_button_and_it_is_the_next_thing_to_do(solved, qtbot):
    buttons = solved.card.buttons
    assert buttons["accept"].property("primary") and not buttons["run"].property("primary")
    assert not solved.live_panel.start.property("primary")
    qtbot.mouseClick(buttons["accept"], LEFT)
    qtbot.waitUntil(lambda: solved.presenter.stage is Stage.ACCEPTED)
    assert solved.card.title.text() == "Accepted"
    assert not any(button.property("primary") for button in buttons.values())


def test_greyed_buttons_say_why(page):
    for button in page.card.buttons.values():
        assert not button.isEnabled() and button.toolTip()


def test_the_result_takes_the_room_of_what_it_was_made_from(solved):
    assert not solved.pictures_fold.isExpanded() and not solved.target_fold.isExpanded()
    assert not solved.result_fold.isHidden()


def test_results_push_no_section(page, views_folder, qtbot):
    page.source.folder_chosen.emit(views_folder)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SEARCHING)
    searching = places(page, qtbot)
    qtbot.waitUntil(lambda: page.presenter.work.judgement is not None, timeout=30_000)
    solved = places(page, qtbot)
    assert not moved(searching, solved)
    qtbot.mouseClick(page.card.buttons["accept"], LEFT)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.ACCEPTED)
    assert not moved(solved, places(page, qtbot))
    page.views.toggled_together.emit(("camera/view03.png",), False)
    assert not moved(solved, places(page, qtbot)), "it is solved anew"
    qtbot.waitUntil(lambda: not page.presenter.work.solving)
    assert not moved(solved, places(page, qtbot))


def test_views_are_listed_and_unchecking_one_leaves_it_out(solved, qtbot):
    solved.views.toggled_together.emit(("camera/view03.png",), False)
    assert solved.presenter.project.options.excluded == {"camera/view03.png"}
    qtbot.waitUntil(lambda: not solved.presenter.work.solving)
    assert solved.presenter.model.undo_stack.undoText() == "leave out view03.png"


def test_a_click_on_a_bar_shows_the_view_with_corners_and_residuals(solved, qtbot):
    solved.bars.bar_clicked.emit("camera/view05.png")
    qtbot.waitUntil(lambda: "residuals" in solved.picture.image.layer_names())
    solved.refreshing.at_once()
    assert solved.views.current() == "camera/view05.png"
    assert solved.picture.line.text().startswith("view05.png: RMS 0.0")


def test_a_view_without_target_says_why(solved, qtbot):
    solved.presenter.choose("camera/view08.png")
    qtbot.waitUntil(lambda: "no checkerboard" in solved.picture.line.text())
    qtbot.waitUntil(lambda: "corners" not in solved.picture.image.layer_names())


def test_the_threshold_line_leaves_views_out(solved, qtbot):
    solved.bars.threshold_changed.emit(0.06)
    assert solved.presenter.project.options.excluded == {"camera/view03.png"}


@pytest.mark.parametrize("name", ["coverage", "residuals", "expected", "history"])
def test_every_tab_shows_something_before_and_after(page, views_folder, qtbot, name):
    tab = getattr(page, name)
    page.tabs.setCurrentWidget(tab)
    page.presenter.use_folder(views_folder)
    qtbot.waitUntil(lambda: page.presenter.work.judgement is not None, timeout=30_000)
    tab.refresh()
    said = tab.missing if name == "coverage" else tab.words
    assert said.text()


def test_what_is_missing_is_told_in_words(solved):
    solved.tabs.setCurrentWidget(solved.coverage)
    assert "Record at least 10 views; there are 8." in solved.coverage.missing.text()


def test_parameters_are_shown_with_their_standard_deviation_and_unit(solved):
    focal = solved.result.rows.text_of("α (fx)")
    assert re.fullmatch(r"[\d.]+ px \(u\xa0=\xa0[\d.]+ px\)", focal)


def test_the_target_form_edits_the_project(page, qtbot):
    page.target.form.edited.emit("columns", 11)
    qtbot.waitUntil(lambda: page.presenter.project.rig.camera_target.columns == 11)


def test_how_the_target_was_made_is_asked_until_it_is_said_and_keeps_nobody_from_going_on(page, qtbot):
    form = page.target.form
    assert "How was it made?" in form.help_of("made")
    assert form.editor("made").findText("By its certificate") >= 0
    blocked = page.presenter.blocker
    form.edited.emit("made", "print shop")
    qtbot.waitUntil(lambda: "How was it made?" not in page.target.form.help_of("made"))
    assert page.presenter.blocker == blocked
    page.target.form.edited.emit("kind", "charuco")
    qtbot.waitUntil(lambda: "How was it made?" in page.target.form.help_of("made"))


def test_another_kind_of_target_shows_its_own_fields(page, qtbot):
    page.target.form.edited.emit("kind", "charuco")
    qtbot.waitUntil(lambda: "marker_mm" in page.target.form.values())


def test_the_target_is_printed_where_the_dialog_says(page, qtbot, monkeypatch, tmp_path):
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: tmp_path / "board")
    qtbot.mouseClick(page.target.print, LEFT)
    qtbot.waitUntil((tmp_path / "board.pdf").exists, timeout=20000)


def test_the_live_picture_shows_where_the_target_is_wanted_next(page, lane, qtbot):
    page.source.set_mode("live")
    start_live(page, lane, qtbot)
    outline = np.array([[100.0, 120.0], [200.0, 130.0], [190.0, 210.0], [105.0, 200.0], [100.0, 120.0]])
    lane.current.view.emit(live_view(wanted=outline))
    assert "wanted" in page.picture.image.layer_names()
    assert "The outline in the picture" in page.picture.hints.text
    lane.current.view.emit(live_view())
    assert "wanted" not in page.picture.image.layer_names()


def test_a_live_picture_is_shown_with_its_corners_and_answered_once(page, lane, qtbot):
    page.source.set_mode("live")
    start_live(page, lane, qtbot)
    corners = np.array([[100.0, 120.0], [200.0, 130.0]])
    lane.current.view.emit(live_view(corners))
    assert lane.sent == ["shown"]
    assert {"corners", "covered"} <= set(page.picture.image.layer_names())
    assert "Hold still." in page.picture.hints.text
    lane.current.view.emit(live_view(None, "The target is not seen."))
    assert "corners" not in page.picture.image.layer_names()
    assert lane.sent == ["shown", "shown"]


def test_a_live_picture_is_answered_while_another_page_is_shown(page, lane, qtbot):
    start_live(page, lane, qtbot)
    page.hide()
    lane.current.view.emit(live_view())
    assert lane.sent == ["shown"]


def test_views_taken_are_listed_and_can_be_put_aside(page, lane, qtbot):
    start_live(page, lane, qtbot)
    lane.current.reported.emit(LiveTaken("view00", np.zeros((30, 40), np.uint8)))
    lane.current.reported.emit(LiveTaken("view01", np.zeros((30, 40), np.uint8)))
    assert [name for name, _ in page.presenter.live_views] == ["camera/view00", "camera/view01"]
    page.views.toggled_together.emit(("camera/view00",), False)
    assert [name for name, _ in page.presenter.live_views] == ["camera/view01"]
    assert lane.sent[-1].name == "view00"


def test_stopping_calibrates_from_what_was_taken(page, lane, qtbot, views_folder):
    start_live(page, lane, qtbot)
    folder = lane.waiting[0][2][0].folder
    folder.mkdir(parents=True)
    for path in views_folder.iterdir():
        (folder / path.name).write_bytes(path.read_bytes())
    qtbot.mouseClick(page.live_panel.start, LEFT)
    lane.finish(LiveEnded(folder, 9, 0))
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED)
    qtbot.waitUntil(lambda: "corners" in page.picture.image.layer_names())


def test_it_is_said_when_nothing_is_missing_any_more(page, lane, qtbot):
    start_live(page, lane, qtbot)
    wanted = "Nothing is missing: press Stop, and it is calibrated."
    lane.current.view.emit(live_view())
    assert wanted not in page.picture.hints._steady._wanted
    lane.current.view.emit(live_view(missing=()))
    assert page.picture.hints._steady._wanted == (wanted,)


def test_the_user_may_look_at_another_tab_while_views_are_taken(page, lane, qtbot):
    start_live(page, lane, qtbot)
    page.tabs.setCurrentWidget(page.history)
    lane.current.reported.emit(LiveTaken("view00", np.zeros((30, 40), np.uint8)))
    assert page.tabs.currentWidget() is page.history


def test_the_keys_do_what_the_buttons_do(solved, qtbot):
    solved.presenter.do_accept()
    qtbot.waitUntil(lambda: solved.presenter.stage is Stage.ACCEPTED)
    before = solved.presenter.bench.measuring.ran.count(jobs.FIND_VIEWS)
    solved.presenter.do_run()
    qtbot.waitUntil(lambda: solved.presenter.bench.measuring.ran.count(jobs.FIND_VIEWS) == before + 1)
    solved.presenter.do_live()
    assert solved.presenter.live.running


def test_a_folder_dropped_on_the_picture_is_taken(page, qtbot, views_folder):
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(views_folder))])
    action, keys = Qt.DropAction.CopyAction, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(5, 5), action, data, LEFT, keys)
    QApplication.sendEvent(page.picture.image.canvas, enter)
    assert enter.isAccepted()
    QApplication.sendEvent(page, QDropEvent(QPointF(5, 5), action, data, LEFT, keys))
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED)
    assert page.presenter.folder == views_folder


def test_everything_can_be_reached_by_the_tab_key(solved, qtbot):
    reached, widget = set(), solved.card.buttons["run"]
    while widget not in reached:
        reached.add(widget)
        widget = widget.nextInFocusChain()
    for needed in (solved.card.buttons["accept"], solved.tabs.tabBar(), solved.picture.factor):
        assert needed in reached and needed.focusPolicy() & Qt.FocusPolicy.TabFocus


def test_while_it_is_solved_it_cannot_be_calibrated(solved, monkeypatch):
    assert solved.card.buttons["run"].isEnabled()
    monkeypatch.setattr(solved.presenter.work, "solving", True)
    solved.card.refresh()
    assert not solved.card.buttons["run"].isEnabled()
    assert "being solved" in solved.card.buttons["run"].toolTip()


def test_each_grade_of_a_calibration_is_told_with_its_limits(solved):
    rows = {row[0]: row[1:] for row in map(fact_row, words.facts(solved.presenter.work.calibration, None))}
    text, tip, level = rows["Views"]
    used = int(text.split(" of ")[0])
    assert level == ("good" if used >= 10 else "warn") and tip.endswith("Good from 10 on, poor below 5")
    assert rows["Tilts"][1].endswith("Good from 30° on, poor below 15°")


def test_a_parameter_is_written_with_the_decimal_sign_of_the_language(qapp: QApplication) -> None:
    choose(language("de"), qapp)
    try:
        assert fact_row(parameter_fact("alpha", -2495.187, 0.132))[1] == "−2495,19 px (u\xa0=\xa00,13 px)"
    finally:
        choose(language("en"), qapp)


def shown_other_board(folder, project):
    if project.rig.camera_target.columns != 17:
        raise OtherBoard("in the first 3 pictures the board shows 17 × 12", where="camera", counted=(17, 12))
    return find(folder, project)


def test_a_wrong_count_is_taken_over_from_the_pictures_of_a_folder(page, camera_bench, views_folder, qtbot):
    cast(HandLane, camera_bench.measuring).answers[jobs.FIND_VIEWS] = shown_other_board
    p, offered = page.presenter, page.picture.image.offered
    p.target.set_target("columns", 18)
    page.source.folder_chosen.emit(views_folder)
    qtbot.waitUntil(lambda: not offered.isHidden())
    assert offered.label.text().replace("\xa0", " ") == "17 × 12 is seen, 18 × 12 is entered."
    assert p.stage is Stage.FAILED
    assert not any(button.property("primary") for button in page.card.buttons.values())
    qtbot.mouseClick(offered.button, LEFT)
    qtbot.waitUntil(lambda: p.stage is Stage.SOLVED, timeout=30_000)
    assert offered.isHidden()
    p.model.undo_stack.undo()
    assert p.project.rig.camera_target.columns == 18
    qtbot.waitUntil(lambda: not offered.isHidden())


def test_the_offer_of_the_right_count_is_in_sight_whatever_was_looked_at(solved, camera_bench, qtbot):
    page, p, offered = solved, solved.presenter, solved.picture.image.offered
    cast(HandLane, camera_bench.measuring).answers[jobs.FIND_VIEWS] = shown_other_board
    p.target.set_target("columns", 18)
    page.tabs.setCurrentIndex(2)
    page.refreshing.at_once()
    assert page.tabs.currentIndex() == 2, "nothing is offered before the pictures are searched"
    qtbot.mouseClick(page.card.buttons["run"], LEFT)
    qtbot.waitUntil(offered.isVisible)
    page.tabs.setCurrentIndex(2)
    page.refreshing.at_once()
    assert page.tabs.currentIndex() == 2, "who wants to look elsewhere may"


def test_a_wrong_count_is_taken_over_while_live_and_looked_for_at_once(page, lane, qtbot):
    p, offered = page.presenter, page.picture.image.offered
    p.target.set_target("columns", 18)
    start_live(page, lane, qtbot)
    before = places(page, qtbot)
    lane.current.view.emit(live_view(counted=(17, 12), sentence="The board shows 17 × 12 inner corners, not 18 × 12."))
    qtbot.waitUntil(lambda: not offered.isHidden())
    assert not moved(before, places(page, qtbot))
    lane.current.view.emit(live_view())
    page.refreshing.at_once()
    assert not offered.isHidden(), "a blurred picture between does not take it away"
    qtbot.mouseClick(offered.button, LEFT)
    assert lane.sent[-1] == LookFor(replace(p.project.rig.camera_target, columns=17, rows=12))
    assert p.live.running
    qtbot.waitUntil(lambda: offered.isHidden())
    p.model.undo_stack.undo()
    assert lane.sent[-1].target.columns == 18


def test_live_stops_by_itself_once_nothing_is_missing_and_says_so(page, lane, qtbot):
    start_live(page, lane, qtbot)
    lane.current.view.emit(live_view())
    assert not page.presenter.live.stopping
    lane.current.view.emit(live_view(missing=(), sentence="Turn the board: this tilt is already there."))
    assert page.presenter.live.stopping and Stop() in lane.sent
    assert page.presenter.bench.notices.all[-1].text.startswith("Nothing is missing: the live source was stopped")


def test_views_can_be_added_by_hand_where_nothing_is_missing_and_nobody_nags(page, lane, qtbot):
    start_live(page, lane, qtbot)
    page.presenter.live.set_auto(False)
    lane.current.view.emit(live_view())
    lane.current.view.emit(live_view(missing=(), sentence="Turn the board: this tilt is already there."))
    qtbot.waitUntil(lambda: "Nothing is missing" in page.picture.hints.text)
    assert "Turn the board" not in page.picture.hints.text
    assert not page.presenter.live.stopping


def test_files_of_a_kind_that_is_not_read_are_among_the_messages_once(page, views_folder, tmp_path, qtbot):
    folder = tmp_path / "pictures"
    folder.mkdir()
    for path in views_folder.iterdir():
        (folder / path.name).write_bytes(path.read_bytes())
    (folder / "view99.webp").write_bytes(b"")
    page.source.folder_chosen.emit(folder)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED, timeout=30_000)
    told = [notice.text for notice in page.presenter.bench.notices.all if "view99.webp" in notice.text]
    assert len(told) == 1
    page.presenter.do_run()
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED and not page.presenter.bench.quick.busy)
    assert sum("view99.webp" in notice.text for notice in page.presenter.bench.notices.all) == 1
