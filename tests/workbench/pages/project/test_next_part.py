"""The next part of a series: asked for by its number, opened at its scan, by the person who was at it before."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialogButtonBox, QWidget

from core.files.project.data import Project, ProjectFile, new_project
from core.files.project.folder import create_project, read_project
from core.inspect.plan.feature_spec import FaceAt, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from workbench.bench import Bench
from workbench.pages.project.actions import ProjectActions
from workbench.views import ask
from workbench.views.ask import _NextPart


@pytest.fixture
def window(qtbot: Any) -> Iterator[QWidget]:
    made = QWidget()
    qtbot.addWidget(made)
    yield made


@pytest.fixture
def projects(hand_bench: Bench, window: QWidget, tmp_path: Path) -> ProjectActions:
    hand_bench.settings.projects_folder = tmp_path
    return ProjectActions(hand_bench, window)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[tuple[str, str]]:
    """What was proposed: part and operator; the answer is number 2 and Bo."""
    proposed: list[tuple[str, str]] = []

    def answer(_: Any, part: str, operator: str, folder: Path) -> tuple[str, str, Path]:
        proposed.append((part, operator))
        return "2", "Bo", folder / f"{part} 2"

    monkeypatch.setattr(ask, "ask_next_part", answer)
    return proposed


def first_part(folder: Path, **more: Any) -> Project:
    made = new_project("Block 1")
    made = replace(made, info=replace(made.info, part="Block", serial="1", operator="Ada"), **more)
    create_project(folder, ProjectFile(made))
    return made


def test_it_is_opened_at_its_scan_and_what_was_typed_last_is_saved_before(
    projects: ProjectActions, asked: list[tuple[str, str]], qtbot: Any, tmp_path: Path
) -> None:
    made = first_part(tmp_path / "Block 1")
    projects.open_project(tmp_path / "Block 1")
    projects.model.edit("edit", replace(made, info=replace(made.info, laboratory="Lab")))
    with qtbot.waitSignal(projects.go_to) as shown:
        projects.begin_next_part()
    assert shown.args == ["scan"] and asked == [("Block", "Ada")]
    assert projects.model.folder == tmp_path / "Block 2"
    assert (projects.model.project.info.serial, projects.model.project.info.laboratory) == ("2", "Lab")
    assert read_project(tmp_path / "Block 1").project.info.laboratory == "Lab"
    assert projects.bench.notices.all == []


def test_faces_drawn_in_the_picture_are_told(
    projects: ProjectActions, asked: list[tuple[str, str]], qtbot: Any, tmp_path: Path
) -> None:
    drawn = FeatureSpec("top", "plane", regions=(FaceAt(at_px=(10.0, 20.0)),))
    first_part(tmp_path / "Block 1", inspection=InspectionPlan((drawn,)))
    projects.open_project(tmp_path / "Block 1")
    with qtbot.waitSignal(projects.go_to):
        projects.begin_next_part()
    assert ["drawn in the picture" in notice.text for notice in projects.bench.notices.all] == [True]


def test_a_scanner_types_the_number_and_presses_return(qtbot: Any, tmp_path: Path) -> None:
    dialog = _NextPart(None, "Block", "Ada", tmp_path)
    qtbot.addWidget(dialog)
    dialog.show()
    ok = dialog.buttons.button(QDialogButtonBox.StandardButton.Ok)
    assert not ok.isEnabled() and "serial number" in dialog._will.text()
    qtbot.waitUntil(lambda: dialog.focusWidget() is not None)
    assert dialog.focusWidget() is dialog.serial, "what the scanner types arrives there, not at a button"
    qtbot.keyClicks(dialog.serial, "17")
    assert ok.isEnabled() and ok.isDefault()
    qtbot.keyClick(dialog.serial, Qt.Key.Key_Return)
    assert dialog.result() == dialog.DialogCode.Accepted
    assert dialog.answer() == ("17", "Ada", tmp_path / "Block 17")


def test_after_the_scanners_return_the_missing_operator_is_asked_for(qtbot: Any, tmp_path: Path) -> None:
    dialog = _NextPart(None, "Block", "", tmp_path)
    qtbot.addWidget(dialog)
    dialog.show()
    dialog.serial.setFocus()
    qtbot.keyClicks(dialog.serial, "17")
    qtbot.keyClick(dialog.serial, Qt.Key.Key_Return)
    assert dialog.isVisible() and dialog.focusWidget() is dialog.operator
    qtbot.keyClicks(dialog.operator, "Ada")
    qtbot.keyClick(dialog.operator, Qt.Key.Key_Return)
    assert dialog.result() == dialog.DialogCode.Accepted
    assert dialog.answer()[:2] == ("17", "Ada")


@pytest.mark.parametrize(("serial", "operator", "why"), [("17", " ", "who measures"), ("1", "Ada", "measured before")])
def test_what_is_missing_or_there_already_is_said(
    qtbot: Any, tmp_path: Path, serial: str, operator: str, why: str
) -> None:
    (tmp_path / "Block 1").mkdir()
    dialog = _NextPart(None, "Block", operator, tmp_path)
    qtbot.addWidget(dialog)
    dialog.serial.setText(serial)
    assert why in dialog._will.text()
    assert not dialog.buttons.button(QDialogButtonBox.StandardButton.Ok).isEnabled()
