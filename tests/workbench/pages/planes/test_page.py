"""The laser planes page, clicked."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QWidget

from core.files.project.keys import finished
from core.messages import plain
from core.pipeline.live.commands import Stop
from core.pipeline.live.events import LiveAsk, LiveEnded, LiveStarted, LiveTaken, LiveView, PlanesDetail
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages.places import moved, places
from tests.workbench.pages.planes_cases import NO_PLATE, Planes, folder_with_poses, project_with
from workbench.bench import Bench
from workbench.pages.calibration.stage import Stage
from workbench.pages.planes.page import PlanesPage
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.views import ask
from workbench.work import jobs

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def planes(hand_bench: Bench) -> Planes:
    return Planes(hand_bench)


@pytest.fixture(scope="session")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folder_with_poses(tmp_path_factory.mktemp("poses") / "planes")


@pytest.fixture
def page(hand_bench: Bench, planes: Planes, tmp_path: Path, qtbot: Any) -> Iterator[PlanesPage]:
    made = PlanesPage(PlanesPresenter(hand_bench))
    hand_bench.model.create(tmp_path / "project", project_with())
    made.presenter.model.record("camera", finished("camera", made.presenter.project, {}))
    qtbot.addWidget(made)
    made.resize(1098, 700)
    with qtbot.waitExposed(made):
        made.show()
    settled(qtbot, made)
    yield made
    made.hide()


@pytest.fixture
def solved(page: PlanesPage, pictures: Path, qtbot: Any) -> PlanesPage:
    page.presenter.use_folder(pictures)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED)
    settled(qtbot, page)
    return page


def settled(qtbot: Any, page: PlanesPage) -> None:
    qtbot.waitUntil(lambda: not page.presenter.bench.quick.busy and not page.presenter.bench.measuring.busy)
    page.refreshing.at_once()


def click(qtbot: Any, widget: QWidget) -> None:
    where = widget.rect().center()
    where.setX(min(where.x(), 10))
    qtbot.mouseClick(widget, LEFT, pos=where)
    QApplication.processEvents()  # the page is refreshed in the next turn


def pose_row(page: PlanesPage, name: str) -> Any:
    return next(row for row in page.views.rows() if row.name == name)


def check(qtbot: Any, page: PlanesPage, name: str) -> None:
    """Click the check box of a pose."""
    table = page.views.table
    place = table.visualRect(page.views.model.index(page.views.model.row_of(name), 0))
    qtbot.mouseClick(table.viewport(), LEFT, pos=QPoint(place.left() + 10, place.center().y()))
    QApplication.processEvents()  # the page is refreshed in the next turn


def test_results_push_no_section(page: PlanesPage, pictures: Path, qtbot: Any) -> None:
    page.presenter.use_folder(pictures)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SEARCHING)
    searching = places(page, qtbot)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED)
    settled(qtbot, page)
    solved = places(page, qtbot)
    assert not moved(searching, solved)
    qtbot.mouseClick(page.card.buttons["accept"], LEFT)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.ACCEPTED)
    assert not moved(solved, places(page, qtbot))


# ---- empty, failed, solved


def test_an_empty_page_says_what_to_do_next_and_offers_it(
    page: PlanesPage, pictures: Path, qtbot: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    empty = page.picture.image.empty_state
    page.source.set_mode("folder")
    qtbot.waitUntil(lambda: empty.button.text() == "Choose folder …")
    assert empty.message.startswith("Take pictures of the plate under the laser")
    assert page.card.title.text() == "No pictures yet"
    assert page.live.panel.start.property("primary")
    assert not page.result_fold.isVisible()
    monkeypatch.setattr(ask, "choose_folder", lambda *_: pictures)
    click(qtbot, empty.button)
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED)


def test_without_a_camera_the_page_says_so_and_leads_there(page: PlanesPage, qtbot: Any) -> None:
    page.presenter.model.edit("reject", project_with(camera=""))
    page.refreshing.at_once()
    assert page.card.title.text() == "The camera comes first"
    assert "seen through the camera" in page.picture.image.empty_state.message
    wanted: list[str] = []
    page.presenter.go_to.connect(wanted.append)
    page.refreshing.at_once()
    click(qtbot, page.picture.image.empty_state.button)
    page.refreshing.at_once()
    assert wanted == ["camera"]
    assert page.card.buttons["run"].toolTip() == "Accept a camera calibration first."


def test_a_folder_can_be_dropped_anywhere_on_the_page(page: PlanesPage, pictures: Path, qtbot: Any) -> None:
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(pictures))])
    action, keys = Qt.DropAction.CopyAction, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(5, 5), action, data, LEFT, keys)
    QApplication.sendEvent(page.picture.image.canvas, enter)
    assert enter.isAccepted()
    QApplication.sendEvent(page, QDropEvent(QPointF(5, 5), action, data, LEFT, keys))
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED)


def test_there_is_one_primary_button_and_it_is_the_next_thing_to_do(solved: PlanesPage, qtbot: Any) -> None:
    buttons = solved.card.buttons
    solved.refreshing.at_once()
    assert [key for key, button in buttons.items() if button.property("primary")] == ["accept"]
    assert not solved.live.panel.start.property("primary")
    click(qtbot, buttons["accept"])
    solved.refreshing.at_once()
    qtbot.waitUntil(lambda: solved.presenter.stage is Stage.ACCEPTED)
    solved.refreshing.at_once()
    assert solved.card.title.text() == "Accepted"
    assert not any(button.property("primary") for button in buttons.values())
    click(qtbot, buttons["reject"])
    solved.refreshing.at_once()
    assert solved.card.title.text() == "Rejected"


def test_greyed_buttons_say_why(page: PlanesPage) -> None:
    for button in page.card.buttons.values():
        assert not button.isEnabled()
        assert button.toolTip()


def test_the_result_takes_the_room_of_what_it_was_made_from(solved: PlanesPage) -> None:
    folds = (solved.pictures_fold, solved.target_fold, solved.setup_folds[1])
    solved.refreshing.at_once()
    assert not any(fold.isExpanded() for fold in folds)
    assert solved.result_fold.isVisible()
    solved.presenter.model.undo_stack.undo()
    solved.refreshing.at_once()
    assert all(fold.isExpanded() for fold in folds)
    assert not solved.result_fold.isVisible()


def test_a_problem_stands_where_the_next_step_is_told(page: PlanesPage, pictures: Path, qtbot: Any) -> None:
    page.presenter.target.set_target("kind", "checkerboard")
    page.presenter.use_folder(pictures)
    qtbot.waitUntil(lambda: page.card.title.text() == "No calibration")
    assert "none of the 7 poses can be used" in page.card.words.text()
    assert page.card.buttons["run"].property("primary")


# ---- poses


def test_unchecking_a_pose_leaves_it_out_of_result_and_count(solved: PlanesPage, qtbot: Any) -> None:
    check(qtbot, solved, "pose01")
    settled(qtbot, solved)
    solved.refreshing.at_once()
    assert solved.presenter.model.undo_stack.undoText() == "leave out pose01"
    assert (pose_row(solved, "pose01").used, pose_row(solved, "pose01").reason) == (False, "left out by hand")
    assert solved.result.rows.text_of("Poses") == "5 of 7"
    assert solved.result.left_out.text().splitlines() == ["1 × left out by hand: pose01", f"1 × {NO_PLATE}: pose06"]
    solved.presenter.model.undo_stack.undo()
    solved.refreshing.at_once()
    assert pose_row(solved, "pose01").used
    assert solved.result.rows.text_of("Poses") == "6 of 7"


def test_several_chosen_poses_are_left_out_by_one_key_and_one_undo(solved: PlanesPage, qtbot: Any) -> None:
    table, edits = solved.views.table, solved.presenter.model.undo_stack.count()
    table.selectRow(1)
    table.selectionModel().select(
        solved.views.model.index(2, 0),
        table.selectionModel().SelectionFlag.Select | table.selectionModel().SelectionFlag.Rows,
    )
    qtbot.keyClick(table, Qt.Key.Key_Space)
    assert solved.presenter.project.options.excluded == {"planes/pose01", "planes/pose02"}
    assert solved.presenter.model.undo_stack.count() == edits + 1
    solved.presenter.model.undo_stack.undo()
    solved.refreshing.at_once()
    assert not solved.presenter.project.options.excluded


def test_a_pose_shows_its_plate_stripes_and_line_numbers(solved: PlanesPage, qtbot: Any) -> None:
    solved.views.table.setCurrentIndex(solved.views.model.index(3, 0))
    settled(qtbot, solved)
    assert set(solved.picture.image.layer_names()) >= {"corners", "stripe 0", "stripe 1", "stripe 2"}
    assert solved.picture.line.text().startswith("pose03: stripes RMS 0.0")
    assert solved.picture.line.text().endswith("3 lines seen")


def test_a_pose_without_a_plate_says_why(solved: PlanesPage, qtbot: Any) -> None:
    solved.presenter.choose("pose06")
    settled(qtbot, solved)
    assert f"left out ({NO_PLATE})" in solved.picture.line.text()
    assert not [name for name in solved.picture.image.layer_names() if name.startswith(("corners", "stripe"))]


def test_a_pose_without_a_stripe_shows_what_looks_most_like_one_until_another_is_chosen(
    solved: PlanesPage, planes: Planes, qtbot: Any
) -> None:
    planes.ridges["pose06"] = np.full((12, 16), 200, np.uint8)
    solved.presenter.choose("pose06")
    settled(qtbot, solved)
    assert solved.picture.line.text().endswith("Shown is how strongly each place looks like a stripe.")
    solved.presenter.choose("pose03")
    settled(qtbot, solved)
    assert solved.picture.line.text().endswith("3 lines seen")


def test_a_click_on_a_bar_shows_its_pose(solved: PlanesPage) -> None:
    solved.bars.bar_clicked.emit("pose04")
    solved.refreshing.at_once()
    assert solved.views.current() == "pose04"
    assert solved.picture.line.text().startswith("pose04")


def test_angles_are_shown_held_and_free_with_the_verdict(solved: PlanesPage, qtbot: Any) -> None:
    rows = solved.result.rows
    assert rows.text_of("Line 1, to the next") == "5°"
    assert re.fullmatch(r"(4\.99|5\.00)\d+° \(u\xa0=\xa00\.00\d+°\)", rows.text_of("Line 1, to the next, free"))
    assert rows.text_of("Off one axis").endswith(" mm")
    assert solved.result.verdict.text().startswith("One common axis and angles of 5°: this suits the laser")
    solved.setup_folds[1].expand(animate=False)
    click(qtbot, solved.laser.editor("constrain_fan"))
    settled(qtbot, solved)
    assert "the freely fitted planes are used, as asked" in solved.result.verdict.text()


# ---- 3D and history


def test_the_rig_is_drawn_in_3d_and_the_chosen_pose_stands_out(solved: PlanesPage, qtbot: Any) -> None:
    drawn: list[str] = []
    solved.refreshing.at_once()
    for name in ("set_planes", "set_polylines", "set_labels", "set_camera_frustum"):
        real = getattr(solved.rig.scene, name)

        def spy(*args: Any, real: Any = real, name: str = name) -> None:
            drawn.append(args[0] if isinstance(args[0], str) else name)
            real(*args)

        setattr(solved.rig.scene, name, spy)
    solved.tabs.setCurrentWidget(solved.rig)
    solved.refreshing.at_once()
    assert drawn == ["set_camera_frustum", "planes", "targets", "stripes", "poses", "chosen"]
    solved.rig.refresh()
    solved.refreshing.at_once()
    assert len(drawn) == 6, "nothing is drawn again for nothing"
    solved.presenter.choose("pose02")
    solved.refreshing.at_once()
    assert drawn[6:] == ["chosen"]


def test_planes_are_restored_from_the_history(solved: PlanesPage, qtbot: Any) -> None:
    solved.refreshing.at_once()
    click(qtbot, solved.card.buttons["accept"])
    settled(qtbot, solved)
    first = solved.presenter.candidate
    check(qtbot, solved, "pose01")
    settled(qtbot, solved)
    solved.refreshing.at_once()
    click(qtbot, solved.card.buttons["accept"])
    settled(qtbot, solved)
    solved.tabs.setCurrentWidget(solved.history)
    solved.refreshing.at_once()
    assert len(solved.history.table.rows()) == 2
    assert solved.history.restore.toolTip() == "Choose a calibration in the list first."
    assert solved.history.words.text() == "Choose a calibration in the list first."
    solved.history.table.set_current_row(1)
    solved.refreshing.at_once()
    click(qtbot, solved.history.restore)
    solved.refreshing.at_once()
    assert solved.presenter.project.accepted.planes == first
    assert solved.history.restore.toolTip() == solved.history.words.text() == "These laser planes are in use."
    assert not solved.bars.isVisible()


# ---- laser and plate


def test_the_laser_is_changed_in_its_form_and_undone(page: PlanesPage, qtbot: Any) -> None:
    lines = page.laser.editor("lines")
    lines.setFocus()
    lines.selectAll()  # type: ignore[attr-defined]
    page.refreshing.at_once()
    qtbot.keyClicks(lines, "1")
    page.refreshing.at_once()
    qtbot.keyClick(lines, Qt.Key.Key_Return)
    page.refreshing.at_once()
    assert page.presenter.project.rig.lines == 1
    page.refreshing.at_once()
    assert not page.laser.editor("angle_deg").isEnabled()
    assert page.laser.editor("angle_deg").toolTip() == "One line has no neighbour."
    page.presenter.model.undo_stack.undo()
    page.refreshing.at_once()
    assert page.laser.values()["lines"] == 3
    assert page.laser.editor("angle_deg").isEnabled()
    page.laser.edited.emit("angle_deg", None)
    page.refreshing.at_once()
    assert page.presenter.project.rig.angle == 0.0
    assert page.laser.values()["angle_deg"] is None


def test_the_plate_is_chosen_in_its_form(page: PlanesPage, qtbot: Any) -> None:
    page.target.form.edited.emit("kind", "circle_grid")
    page.refreshing.at_once()
    qtbot.waitUntil(lambda: "asymmetric" in page.target.form.values())
    page.presenter.model.undo_stack.undo()
    page.refreshing.at_once()
    assert page.target.form.values()["kind"] == "black_square"


# ---- live


@pytest.fixture
def lane(page: PlanesPage) -> HandLane:
    return cast(HandLane, page.presenter.bench.live)


def detail(uv: Any = None, stripes: int = 3) -> PlanesDetail:
    lines = tuple(np.array([[10.0, 10.0 + k], [60.0, 12.0 + k]]) for k in range(stripes))
    cells = np.eye(12, 16, dtype=bool)
    missing = ("Record at least 8 poses; there are 2.",)
    return PlanesDetail(
        7, uv, lines, tuple(range(stripes)), plain("Hold still."), cells, tuple(map(plain, missing)), 2, True
    )


def live_view(*args: Any) -> LiveView:
    return LiveView(np.zeros((48, 64), np.uint8), 10, 7, 12.0, 2, 0, detail(*args))


def start_live(page: PlanesPage, lane: HandLane, qtbot: Any) -> None:
    page.source.set_mode("live")
    click(qtbot, page.live.panel.start)
    lane.waiting[0][0].reported.emit(LiveStarted("Camera 1", (640, 480)))
    page.refreshing.at_once()


def test_poses_are_taken_live_with_everything_drawn_and_each_picture_answered_once(
    page: PlanesPage, lane: HandLane, qtbot: Any
) -> None:
    start_live(page, lane, qtbot)
    page.refreshing.at_once()
    assert page.card.title.text() == "Taking poses"
    task = lane.waiting[0][0]
    task.view.emit(live_view(np.array([[100.0, 120.0], [200.0, 130.0]])))
    page.refreshing.at_once()
    assert set(page.picture.image.layer_names()) >= {"covered", "corners", "stripe 0", "stripe 2"}
    task.view.emit(live_view(None, 1))
    page.refreshing.at_once()
    assert not {"corners", "stripe 1", "stripe 2"} & set(page.picture.image.layer_names())
    assert lane.sent.count("shown") == 2
    whole = replace(live_view(), detail=replace(detail(), missing=()))
    task.view.emit(whole)
    page.refreshing.at_once()
    assert page.picture.hints._steady._wanted == ("Nothing is missing: press Stop, and it is calibrated.",)
    task.reported.emit(LiveTaken("pose00", np.zeros((12, 16), np.uint8)))
    page.refreshing.at_once()
    assert [row.name for row in page.views.rows()] == ["pose00"]
    check(qtbot, page, "pose00")
    page.refreshing.at_once()
    assert page.views.rows() == ()
    assert not page.target.isEnabled()


def test_the_laser_is_asked_to_be_switched_and_the_answer_goes_back(
    page: PlanesPage, lane: HandLane, qtbot: Any
) -> None:
    start_live(page, lane, qtbot)
    lane.waiting[0][0].reported.emit(LiveAsk(plain("Switch the three-line laser off."), "Continue", Stop()))
    assert page.strip.isVisible()
    click(qtbot, page.strip.answer)
    assert lane.sent[-1] == Stop()


def test_a_laser_that_cannot_be_switched_is_said_before_the_start(page: PlanesPage, lane: HandLane, qtbot: Any) -> None:
    page.source.set_mode("live")
    page.refreshing.at_once()
    assert page.live.pairs.isChecked()
    click(qtbot, page.live.pairs)
    start_live(page, lane, qtbot)
    page.refreshing.at_once()
    assert lane.waiting[0][2][0].pairs is False
    assert not page.live.pairs.isEnabled()
    assert page.live.pairs.toolTip() == "Stop the live source first."


def test_a_recording_that_ends_is_measured_and_shown(page: PlanesPage, lane: HandLane, qtbot: Any) -> None:
    start_live(page, lane, qtbot)
    task, _, (request,), _ = lane.waiting[0]
    task.view.emit(live_view())
    folder_with_poses(request.folder)
    click(qtbot, page.live.panel.start)
    lane.finish(LiveEnded(request.folder, 7, 0))
    qtbot.waitUntil(lambda: page.presenter.stage is Stage.SOLVED)
    settled(qtbot, page)
    assert page.picture.line.text().startswith("pose00: stripes RMS")
    assert "covered" not in page.picture.image.layer_names()


def test_the_page_is_drawn_no_more_often_than_something_changes(solved: PlanesPage, planes: Planes, qtbot: Any) -> None:
    """What is shown asks for a picture, the picture changes what is shown: that must come to rest."""
    ran = len(planes.quick.ran)
    for _ in range(5):
        solved.refresh()
        solved.presenter.changed.emit()
    qtbot.wait(30)
    assert len(planes.quick.ran) == ran
    assert jobs.SHOW_POSE in planes.quick.ran
