"""Ways into a project through the real window: dropped on it, given as an argument, handed over by the system."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QWidget

from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project
from tests.workbench.technician import Technician
from workbench.app import _after_start
from workbench.main_window import MainWindow


@pytest.fixture
def project(tmp_path: Path) -> Path:
    create_project(tmp_path / "block", ProjectFile(new_project("Block")))
    return tmp_path / "block"


def drop(window: QWidget, path: Path) -> bool:
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path))])
    action, button, keys = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(5, 5), action, data, button, keys)
    QApplication.sendEvent(window, enter)
    QApplication.sendEvent(window, QDropEvent(QPointF(5, 5), action, data, button, keys))
    return enter.isAccepted()


@pytest.mark.parametrize("of", [lambda folder: folder, lambda folder: folder / "project.json"])
def test_a_project_is_dropped_on_the_welcome_page(
    technician: Technician, project: Path, of: Callable[[Path], Path]
) -> None:
    assert drop(technician.window, of(project))
    assert technician.model.folder == project
    assert technician.window.current == "project"
    technician.idle()


def test_a_project_dropped_on_a_page_that_takes_folders_is_opened_all_the_same(
    technician: Technician, project: Path, tmp_path: Path
) -> None:
    create_project(tmp_path / "first", ProjectFile(new_project("First")))
    technician.window.projects.open_project(tmp_path / "first")
    technician.window.go_to("planes")
    technician.idle()
    drop(technician.window, project)
    assert technician.model.folder == project
    assert technician.window.windowTitle().startswith("Block")
    technician.idle()


def test_the_program_opens_what_it_is_started_with(window: MainWindow, project: Path, qtbot: object) -> None:
    _after_start(window, project / "project.json")
    assert window.model.folder == project


def test_the_program_started_with_something_else_says_so_on_the_welcome_page(
    technician: Technician, tmp_path: Path
) -> None:
    _after_start(technician.window, tmp_path / "nothing")
    assert not technician.model.is_open
    assert technician.window.welcome.banner.isVisible()
    assert "is neither a project" in technician.errors()[0]


def test_a_project_opened_from_the_page_of_the_report_draws_no_pages_that_nobody_looks_at(
    window: MainWindow, project: Path, measured_project: Path
) -> None:
    window.model.open(project)
    window.go_to("report")
    report = window.presenters["report"]
    window.model.open(measured_project)
    assert window.current == "project"
    assert report.ready() and not report.drawing  # type: ignore[attr-defined]
