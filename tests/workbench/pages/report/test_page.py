"""The report page under the mouse."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QAction, QDesktopServices
from PySide6.QtWidgets import QPushButton, QWidget

from core.files.project.data import Project, new_project
from core.files.project.keys import finished
from tests.workbench.pages.report.test_presenter import PAGES, Drawing, measured
from workbench.bench import Bench
from workbench.pages.report.page import ReportPage
from workbench.pages.report.presenter import ReportPresenter
from workbench.pages.report.words import USUAL_EXPORTS
from workbench.views import ask
from workbench.views.empty_state import EmptyState


@pytest.fixture
def drawing(hand_bench: Bench) -> Drawing:
    return Drawing(hand_bench)


@pytest.fixture
def page(hand_bench: Bench, drawing: Drawing, tmp_path: Path, qtbot: Any) -> Iterator[ReportPage]:
    presenter = ReportPresenter(hand_bench)
    made = ReportPage(presenter)
    qtbot.addWidget(made)
    made.resize(1098, 700)
    hand_bench.model.create(tmp_path / "project", new_project("Block"))
    presenter.entered()
    with qtbot.waitExposed(made):
        made.show()
    yield made
    made.hide()


def click(qtbot: Any, widget: QWidget) -> None:
    where = widget.rect().center()
    where.setX(min(where.x(), 10))
    qtbot.mouseClick(widget, Qt.MouseButton.LeftButton, pos=where)


def export_button(page: ReportPage, kind: str) -> QPushButton:
    button = page.exports[kind]
    assert isinstance(button, QPushButton)
    return button


def test_long_titles_of_sections_have_short_ones_beside_their_boxes(page: ReportPage) -> None:
    assert page.boxes["maps"].text() == "Residuals of both faces"
    assert page.boxes["inputs"].text() == "Inputs"


def test_an_empty_project_says_what_comes_first_everywhere_and_leads_there(page: ReportPage, qtbot: Any) -> None:
    assert page.preview.message == "Scan the part first; then there is something to report."
    wanted: list[str] = []
    page.presenter.go_to.connect(wanted.append)
    empty = page.preview.findChild(EmptyState)
    assert empty is not None
    click(qtbot, empty.button)
    assert wanted == ["scan"]
    assert page.card.title.text() == "Nothing to report yet"
    assert not page.make.isEnabled()
    assert page.make.toolTip() == "Scan the part first; then there is something to report."
    assert {page.exports[kind].toolTip() for kind in USUAL_EXPORTS} == {"Scan the part first."}
    assert page.exports["ros"].toolTip() == "Calibrate the camera first."
    assert page.folder.toolTip() == "There are no results yet."
    assert not any(button.isEnabled() for button in (*page.exports.values(), page.folder))


def test_pages_come_are_dimmed_while_others_are_drawn_and_stay_if_that_is_all(
    page: ReportPage, drawing: Drawing, qtbot: Any
) -> None:
    measured(page.presenter)
    page.refreshing.at_once()
    assert page.preview.message == "Drawing the pages …"
    drawing.done()
    page.refreshing.at_once()
    assert (page.preview.count(), page.preview.note) == (1, "Drawing the pages …"), "the thickness came meanwhile"
    drawing.done(PAGES * 3)
    page.refreshing.at_once()
    assert (page.preview.count(), page.preview.note) == (3, "")
    click(qtbot, page.boxes["maps"])
    page.refreshing.at_once()
    assert (page.preview.count(), page.preview.note) == (3, "Drawing the pages …")
    drawing.done(PAGES * 2)
    page.refreshing.at_once()
    assert (page.preview.count(), page.preview.note) == (2, "")


def test_sections_and_paper_are_chosen_by_the_mouse_and_taken_back(page: ReportPage, qtbot: Any) -> None:
    stack, box = page.presenter.model.undo_stack, page.boxes["maps"]
    page.refreshing.at_once()
    click(qtbot, box)
    page.refreshing.at_once()
    assert page.presenter.project.report.hidden == {"maps"}
    page.paper.setFocus()
    qtbot.keyClick(page.paper, Qt.Key.Key_Down)
    page.refreshing.at_once()
    assert page.presenter.project.report.paper == "Letter"
    stack.undo()
    page.refreshing.at_once()
    assert page.paper.currentText() == "A4"
    stack.undo()
    page.refreshing.at_once()
    assert box.isChecked()
    stack.redo()
    page.refreshing.at_once()
    assert not box.isChecked()


def test_a_section_with_nothing_to_print_says_so(page: ReportPage) -> None:
    assert page.boxes["remarks"].text() == "Remarks of the operator (nothing yet)"
    assert "Project page" in page.boxes["remarks"].toolTip()


def test_the_button_makes_the_report_and_then_makes_it_again(page: ReportPage, drawing: Drawing, qtbot: Any) -> None:
    measured(page.presenter)
    page.refreshing.at_once()
    assert page.make.property("primary")
    click(qtbot, page.make)
    page.refreshing.at_once()
    assert page.card.title.text() == "Making the report …"
    assert not page.make.isEnabled()
    qtbot.waitUntil(lambda: page.card.title.text() == "The report is made")
    page.refreshing.at_once()
    assert page.make.text() == "Make it again"
    assert not page.make.property("primary")
    click(qtbot, page.boxes["maps"])
    page.refreshing.at_once()
    assert page.card.title.text() == "Out of date"
    assert page.card.words.text() == "Out of date: changed since: sections of the report."
    assert page.make.property("primary")
    click(qtbot, page.make)
    qtbot.waitUntil(lambda: page.card.title.text() == "The report is made")


def test_no_template_is_chosen_for_a_project_that_is_read_only(
    page: ReportPage, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert page.template.isEnabled()
    monkeypatch.setattr(type(page.presenter.model), "is_read_only", property(lambda _: True))
    page.refresh()
    assert not page.template.isEnabled() and page.template.toolTip().startswith("The project is read-only")


def test_language_and_template_are_chosen(
    page: ReportPage, qtbot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.language.setFocus()
    assert page.language.currentText() == "as the window"
    page.language.setCurrentText("Deutsch")
    page.language.activated.emit(page.language.currentIndex())
    assert page.presenter.project.report.language == "de"
    assert page.no_template.toolTip() == "No template is chosen."
    path = tmp_path / "project" / "house.toml"
    path.write_text('name = "Laboratory"\nlanguage = "en"\n', encoding="utf-8")
    monkeypatch.setattr(ask, "choose_file_to_open", lambda *_: path)
    click(qtbot, page.template)
    qtbot.waitUntil(lambda: page.template_name.text() == "house.toml")
    assert page.language.currentText() == "English"
    click(qtbot, page.no_template)
    qtbot.waitUntil(lambda: page.template_name.text() == "none")


@pytest.mark.parametrize("kind", USUAL_EXPORTS)
def test_each_kind_is_handed_over_by_its_button(
    page: ReportPage, drawing: Drawing, qtbot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    measured(page.presenter)
    wanted: list[Any] = []

    def choose(*what: Any) -> Path:
        wanted.append(what)
        return tmp_path / "copy"

    monkeypatch.setattr(ask, "choose_file_to_save", choose)
    page.refreshing.at_once()
    click(qtbot, export_button(page, kind))
    qtbot.waitUntil(lambda: bool(drawing.exported))
    (_, _, proposed, kinds) = wanted[0]
    page.refreshing.at_once()
    assert f"*{proposed.suffix}" in kinds
    assert drawing.exported == [(kind, tmp_path / f"copy{proposed.suffix}")]


def test_other_formats_are_in_a_menu(
    page: ReportPage, drawing: Drawing, qtbot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.refreshing.at_once()
    assert page.more.toolTip() == "Scan the part first." and not page.more.isEnabled()
    measured(page.presenter)
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: tmp_path / "copy")
    menu = page.more.menu()
    page.refreshing.at_once()
    assert menu is not None
    kinds = [action for action in menu.actions() if not action.isSeparator() and not action.isCheckable()]
    assert {*kinds, *(page.exports[kind] for kind in USUAL_EXPORTS)} == set(page.exports.values())
    action = page.exports["e57"]
    assert isinstance(action, QAction)
    action.trigger()
    qtbot.waitUntil(lambda: drawing.exported == [("e57", tmp_path / "copy.e57")])


def test_places_are_the_parts_until_the_cameras_are_chosen_in_either_menu(
    page: ReportPage, drawing: Drawing, qtbot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured(page.presenter)
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: tmp_path / "copy")
    of_page, of_window = page.more.menu(), page.export_menu()
    assert of_page is not None
    for menu, chosen in ((of_page, True), (of_window, False)):
        menu.aboutToShow.emit()
        choice = menu.actions()[-1]
        assert choice.isEnabled() and choice.isChecked() is not chosen, "what was chosen in the other is shown"
        choice.trigger()
        page.presenter.export("stl", tmp_path / "copy")
        qtbot.waitUntil(lambda: not drawing.measuring.busy)
    assert drawing.in_camera_frame == [True, False]


def test_nothing_is_written_where_no_file_is_chosen(
    page: ReportPage, drawing: Drawing, qtbot: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    measured(page.presenter)
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: None)
    click(qtbot, export_button(page, "pdf"))
    assert not drawing.measuring.busy


def test_the_results_folder_is_opened_or_told_where_nothing_can_open_it(
    page: ReportPage, qtbot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "project" / "results"
    folder.mkdir()
    measured(page.presenter)
    opened: list[QUrl] = []

    def nobody(url: QUrl) -> bool:
        opened.append(url)
        return False

    monkeypatch.setattr(QDesktopServices, "openUrl", nobody)
    page.refreshing.at_once()
    click(qtbot, page.folder)
    page.refreshing.at_once()
    assert [Path(url.toLocalFile()) for url in opened] == [folder]
    assert str(folder) in page.presenter.bench.notices.all[-1].text


def test_at_the_smallest_window_nothing_is_cut(page: ReportPage, drawing: Drawing) -> None:
    page.resize(1024 - 182, 600)
    measured(page.presenter)
    page.presenter.model.record("report", finished("report", Project(), {}))
    exports = [export_button(page, kind) for kind in USUAL_EXPORTS]
    buttons = (*exports, page.more, page.folder, page.template, page.no_template)
    for widget in (*page.boxes.values(), *buttons, page.make):
        assert widget.width() >= widget.minimumSizeHint().width(), widget.text()
