"""The entries of the menus, triggered."""

from __future__ import annotations

from pathlib import Path

import pytest
import shiboken6
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QApplication, QMenu

from core.files.project.data import new_project
from core.files.results.export_list import exports
from workbench.main_window import MainWindow
from workbench.views import ask


def test_an_entry_of_the_recent_projects_outlives_its_own_signal(window: MainWindow, tmp_path: Path) -> None:
    for name in ("one", "two"):
        window.model.create(tmp_path / name, new_project(name))
        window.bench.settings.remember(tmp_path / name)
    QApplication.processEvents()
    entries = window.menus._recent.actions()
    assert [entry.text() for entry in entries] == ["two", "one"]
    alive: list[bool] = []
    entries[1].triggered.connect(lambda: alive.append(shiboken6.isValid(entries[1])))
    entries[1].trigger()
    assert alive == [True]
    assert window.model.folder == tmp_path / "one"
    QApplication.processEvents()
    assert [entry.text() for entry in window.menus._recent.actions()] == ["one", "two"]


def test_without_a_project_there_is_nothing_to_save(window: MainWindow, tmp_path: Path) -> None:
    entries: dict[str, QAction] = window.menus.actions
    assert not entries["save"].isEnabled() and not entries["step scan"].isEnabled() and entries["open"].isEnabled()
    window.model.create(tmp_path / "one", new_project("one"))
    QApplication.processEvents()
    assert entries["save"].isEnabled() and entries["step scan"].isEnabled()


def test_results_are_exported_from_the_file_menu(
    window: MainWindow, measured_project: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    entry: QAction = window.menus.actions["export"]
    assert not entry.isEnabled()
    window.model.create(tmp_path / "empty", new_project("empty"))
    QApplication.processEvents()
    menu = entry.menu()
    assert isinstance(menu, QMenu) and entry.isEnabled()
    menu.aboutToShow.emit()
    kinds = {str(one.data()): one for one in menu.actions() if one.data() is not None}
    assert list(kinds) == list(exports())
    assert not kinds["stl"].isEnabled() and kinds["stl"].toolTip() == "Scan the part first."
    window.model.open(measured_project)
    menu.aboutToShow.emit()
    written: list[tuple[str, Path]] = []
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: tmp_path / "part.stl")
    monkeypatch.setattr(window.presenters["report"], "export", lambda kind, path: written.append((kind, path)))
    kinds["stl"].trigger()
    assert written == [("stl", tmp_path / "part.stl")]


def test_a_language_is_chosen_by_its_own_name_and_wanted_at_once(window: MainWindow, qtbot) -> None:
    entries = {name: entry for name, entry in window.menus.actions.items() if name.startswith("language ")}
    assert {name.split()[1]: entry.text() for name, entry in entries.items()}["de"] == "Deutsch"
    assert [name for name, entry in entries.items() if entry.isChecked()] == ["language en"]
    with qtbot.waitSignal(window.language_wanted) as wanted:
        entries["language de"].trigger()
    assert (wanted.args, window.bench.settings.language) == (["de"], "de")
