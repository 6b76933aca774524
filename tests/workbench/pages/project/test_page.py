"""The project page: its fields under the keys, how far the work is, where it is kept."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QDesktopServices

from core.files.project.data import ProjectInfo, new_project
from core.files.project.folder import read_project
from core.files.project.keys import finished
from workbench.bench import Bench
from workbench.pages.project.page import ProjectPage
from workbench.pages.project.presenter import ProjectPresenter

TEXTS = ("name", "part", "serial", "operator", "laboratory", "customer")


@pytest.fixture
def page(hand_bench: Bench, tmp_path: Path, qtbot: Any) -> Iterator[ProjectPage]:
    made = ProjectPage(ProjectPresenter(hand_bench))
    hand_bench.model.create(tmp_path / "project", new_project("Block"))
    qtbot.addWidget(made)
    made.resize(1098, 700)
    with qtbot.waitExposed(made):
        made.show()
    made.activateWindow()
    qtbot.waitUntil(made.isActiveWindow)
    yield made
    made.hide()


def editor(page: ProjectPage, key: str) -> Any:
    page.refreshing.at_once()
    return next(form for form in (page.what, page.who) if key in form.values()).editor(key)


def type_in(qtbot: Any, page: ProjectPage, key: str, text: str) -> None:
    field = editor(page, key)
    field.setFocus()
    qtbot.keyClick(field, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    qtbot.keyClicks(field, text)
    qtbot.keyClick(field, Qt.Key.Key_Tab)


def test_every_field_of_the_report_has_an_editor(page: ProjectPage) -> None:
    shown = {*page.what.values(), *page.who.values()}
    assert shown == {field.name for field in fields(ProjectInfo)}
    for key in shown:
        assert editor(page, key).accessibleName()
        assert editor(page, key).toolTip()


@pytest.mark.parametrize("key", [*TEXTS, "notes"])
def test_a_text_is_typed_kept_and_undone(page: ProjectPage, qtbot: Any, key: str) -> None:
    model = page.presenter.model
    before = getattr(model.project.info, key)
    type_in(qtbot, page, key, "Typed words")
    assert getattr(model.project.info, key) == "Typed words"
    assert model.undo_stack.undoText().startswith("change ")
    model.undo_stack.undo()
    assert getattr(model.project.info, key) == before
    assert editor(page, key).content() == before
    model.undo_stack.redo()
    model.save()
    assert model.folder is not None
    assert getattr(read_project(model.folder).project.info, key) == "Typed words"


@pytest.mark.parametrize(("key", "typed", "kept"), [("air_celsius", "21,5", 21.5), ("part_celsius", "-4", -4.0)])
def test_a_temperature_is_typed_and_can_be_none_again(
    page: ProjectPage, qtbot: Any, key: str, typed: str, kept: float
) -> None:
    info = page.presenter.model.project.info
    assert getattr(info, key) is None
    assert editor(page, key).text() == "not measured"
    type_in(qtbot, page, key, typed)
    assert getattr(page.presenter.model.project.info, key) == kept
    assert editor(page, key).text().endswith(" °C")
    page.presenter.model.undo_stack.undo()
    assert editor(page, key).text() == "not measured"


def test_stepping_up_from_no_temperature_begins_at_that_of_a_room(page: ProjectPage, qtbot: Any) -> None:
    field = editor(page, "air_celsius")
    field.setFocus()
    qtbot.keyClick(field, Qt.Key.Key_Up)
    assert field.content() == 20.0
    qtbot.keyClick(field, Qt.Key.Key_Down)
    qtbot.waitUntil(lambda: page.presenter.model.project.info.air_celsius == 19.5)


def test_blanks_around_a_text_do_not_count(page: ProjectPage, qtbot: Any) -> None:
    type_in(qtbot, page, "part", "  Gauge block ")
    assert page.presenter.model.project.info.part == "Gauge block"


def test_without_a_name_next_makes_no_sense(page: ProjectPage, qtbot: Any) -> None:
    blockers = [page.presenter.blocker()]
    editor(page, "name").setFocus()
    qtbot.keyClick(editor(page, "name"), Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    qtbot.keyClick(editor(page, "name"), Qt.Key.Key_Delete)
    qtbot.keyClick(editor(page, "name"), Qt.Key.Key_Tab)
    blockers.append(page.presenter.blocker())
    assert blockers == ["", "Give the project a name first."]


def test_the_tab_key_goes_through_all_fields_in_order(page: ProjectPage, qtbot: Any) -> None:
    order = ["name", "part", "serial", "air_celsius", "part_celsius", "operator", "laboratory", "customer", "notes"]
    editor(page, "name").setFocus()
    for key, following in pairwise(order):
        qtbot.keyClick(editor(page, key), Qt.Key.Key_Tab)
        assert editor(page, following).hasFocus(), following


def test_how_far_the_work_is_and_what_comes_next(page: ProjectPage) -> None:
    model = page.presenter.model
    assert page.rows.text_of("Camera") == "ready"
    assert page.rows.text_of("Scan") == "to do"
    assert page.next_words.text() == "Next: Camera. Ready to be done."
    for step in ("camera", "planes", "scan", "gauge", "report"):
        model.record(step, finished(step, model.project, model.results))
    page.refreshing.at_once()
    assert page.rows.text_of("Report") == "done"
    assert page.next_words.text() == "All steps are done."
    page.presenter.set_field("operator", "Somebody")
    page.refreshing.at_once()
    assert page.rows.text_of("Report") == "out of date"
    assert page.next_words.text() == "Next: Report. Out of date: changed since: project fields."


def test_the_projects_folder_is_shown_and_opened(
    page: ProjectPage, qtbot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []

    def opens(url: QUrl) -> bool:
        opened.append(url.toLocalFile())
        return False

    monkeypatch.setattr(QDesktopServices, "openUrl", opens)
    assert page.place.text().replace("\u200b", "") == str(tmp_path / "project")
    qtbot.mouseClick(page.folder, Qt.MouseButton.LeftButton)
    assert [Path(path) for path in opened] == [tmp_path / "project"]
    assert "Nothing here opens folders" in page.presenter.bench.notices.all[-1].text
