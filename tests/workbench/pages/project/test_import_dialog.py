"""Import pictures in the window: preview first, then the set, then the project that measures it."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QDialogButtonBox, QWidget

from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project
from tests.films import sweep, write_film
from tests.workbench.technician import Technician
from workbench.pages.project.import_dialog import ImportDialog
from workbench.pages.sources import folder_of


@pytest.fixture
def shots(tmp_path: Path) -> Path:
    folder = tmp_path / "shots"
    folder.mkdir()
    for number in (1, 2, 10):
        for kind, light in (("laser", 200), ("board", 40)):
            picture = np.full((48, 64), 40, np.uint8)
            picture[:, 30:34] = light
            cv2.imwrite(str(folder / f"{kind}_{number}.png"), picture)
    return folder


@pytest.fixture
def film(tmp_path: Path) -> Path:
    return write_film(tmp_path / "hand.avi", sweep())


def dialog_of(technician: Technician) -> ImportDialog:
    technician.window.projects.import_pictures()
    return technician.window.findChildren(ImportDialog)[-1]


def dialog_in_project(technician: Technician, folder: Path) -> ImportDialog:
    """The dialog in a new project in a folder."""
    create_project(folder, ProjectFile(new_project("Block")))
    technician.window.projects.open_project(folder)
    return dialog_of(technician)


def cells(dialog: ImportDialog) -> list[tuple[str, ...]]:
    return [row[:3] for row in dialog.table.rows()]


def test_what_was_understood_is_shown_before_the_project_measures_it(
    technician: Technician, shots: Path, tmp_path: Path
) -> None:
    dialog = dialog_in_project(technician, tmp_path / "block")
    assert not dialog.do_import.isEnabled()
    dialog.planes.setText(f"{shots}/laser_*")
    dialog.planes_off.setText(f"{shots}/board_*")
    technician.until(dialog.do_import.isEnabled, "the preview")
    assert cells(dialog) == [
        (f"planes/{place}-laser_{number}.png", f"laser_{number}.png", f"board_{number}.png")
        for place, number in enumerate((1, 2, 10))
    ]
    assert "what the stars in laser_* and board_* stand for" in dialog.words.text()
    assert not (tmp_path / "block" / "imported").exists()
    dialog.do_import.click()
    technician.until(lambda: technician.window.current == "planes", "the page of the poses")
    folder = folder_of(technician.model, "planes")
    assert folder is not None
    assert (folder / "0-laser_1_off.png").samefile(shots / "board_1.png")
    technician.idle()


def test_pictures_of_a_check_become_the_projects_and_are_shown_where_it_is_made(
    technician: Technician, shots: Path, tmp_path: Path
) -> None:
    dialog = dialog_in_project(technician, tmp_path / "block")
    dialog.check.setText(f"{shots}/laser_*")
    dialog.check_off.setText(f"{shots}/board_*")
    technician.until(dialog.do_import.isEnabled, "the preview")
    assert cells(dialog)[0] == ("check/0-laser_1.png", "laser_1.png", "board_1.png")
    dialog.do_import.click()
    technician.until(lambda: technician.window.current == "scan", "the page of the check")
    folder = folder_of(technician.model, "check")
    assert folder is not None and (folder / "0-laser_1_off.png").samefile(shots / "board_1.png")
    assert not technician.model.project.sources.scan
    technician.idle()


def test_what_cannot_be_understood_is_told_in_the_dialog(technician: Technician, shots: Path) -> None:
    dialog = dialog_of(technician)
    dialog.planes.setText(str(shots))
    technician.until(lambda: "laser_*" in dialog.words.text(), "the sentence")
    assert not dialog.do_import.isEnabled()
    dialog.reject()
    technician.idle()


def drop(path: Path, on: QWidget) -> None:
    """Drop a path on a widget, as a file manager does."""
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path))])
    action, button, keys = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    QApplication.sendEvent(on, QDragEnterEvent(QPoint(5, 5), action, data, button, keys))
    QApplication.sendEvent(on, QDropEvent(QPointF(5, 5), action, data, button, keys))


def test_a_film_dropped_on_a_field_is_shown_frame_by_frame_and_becomes_the_scan(
    technician: Technician, film: Path, tmp_path: Path
) -> None:
    dialog = dialog_in_project(technician, tmp_path / "block")
    drop(film, dialog.scan)
    assert dialog.scan.text() == str(film)
    technician.until(dialog.do_import.isEnabled, "the preview")
    assert cells(dialog)[6] == ("scan/hand-06.png", "hand.avi 7", "")
    assert "the frames of the film hand.avi" in dialog.words.text()
    assert "stands out best in the red channel" in dialog.words.text() and "⚠" not in dialog.words.text()
    dialog.table.set_current_row(6)
    technician.until(lambda: dialog.on.has_picture, "the frame")
    dialog.do_import.click()
    technician.until(lambda: technician.window.current == "scan", "the page of the scan")
    folder = folder_of(technician.model, "scan")
    assert folder is not None and len(list(folder.glob("*.png"))) == 12
    technician.idle()


def test_a_film_dropped_on_the_window_is_asked_about(technician: Technician, film: Path) -> None:
    technician.window.projects.open_dropped(film)
    dialog = technician.window.findChildren(ImportDialog)[-1]
    assert dialog.scan.text() == str(film)
    dialog.reject()
    technician.idle()


def test_cancel_ends_an_import_and_leaves_the_dialog(technician: Technician, tmp_path: Path) -> None:
    film = write_film(tmp_path / "long.avi", sweep(150, size=(640, 480)))
    dialog = dialog_in_project(technician, tmp_path / "block")
    dialog.scan.setText(str(film))
    technician.until(lambda: dialog.bar.maximum() == 150 and not dialog.bar.isHidden(), "how far the film is read")
    technician.until(dialog.do_import.isEnabled, "the preview")
    assert dialog.bar.isHidden()
    dialog.do_import.click()
    technician.until(lambda: not dialog.bar.isHidden(), "how far the import is")
    assert not dialog.scan.isEnabled()
    dialog.buttons.button(QDialogButtonBox.StandardButton.Cancel).click()
    technician.until(dialog.do_import.isEnabled, "the dialog again")
    assert not (tmp_path / "block" / "imported" / "scan").exists()
    assert not list((tmp_path / "block").glob("imported/.*"))
    dialog.reject()
    technician.idle()
