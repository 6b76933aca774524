"""What every page says and does: what is missing, themes, no OpenGL."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication

from core.files.project.data import new_project
from tests.workbench.technician import Technician
from workbench.step_state import ORDER
from workbench.theme import is_dark, is_polishing

MISSING = {
    "project": "Give the project a name first.",
    "camera": "Record or choose pictures of the camera's target first.",
    "planes": "Accept a camera calibration first.",
    "scan": "Accept a camera calibration first.",
    "inspect": "Scan the part first.",
    "report": "Scan the part first; then there is something to report.",
}
"""What an empty project without a name lacks on each page."""


def test_an_empty_project_says_on_each_page_what_is_missing(technician: Technician, tmp_path: Path) -> None:
    t = technician
    t.model.create(tmp_path / "empty", new_project(""))
    for page in ORDER:
        t.window.go_to(page)
        t.idle()
        assert t.presenter().blocker() == MISSING[page]
        if page == ORDER[-1]:
            assert not t.window.next.isVisible()
            continue
        assert not t.window.next.isEnabled(), page
        assert t.window.next.toolTip() == MISSING[page]
        assert t.window.missing.text() == MISSING[page]
        t.shortcut(Qt.Key.Key_Right, Qt.KeyboardModifier.AltModifier)
        assert t.window.current == page


def test_the_sentence_goes_when_what_is_missing_comes_and_comes_back_with_undo(
    technician: Technician, tmp_path: Path
) -> None:
    t = technician
    t.model.create(tmp_path / "empty", new_project(""))
    t.activate()
    t.type_in(t.field("Name"), "Block")
    assert t.window.next.isEnabled()
    assert t.window.windowTitle().startswith("Block")
    t.shortcut(Qt.Key.Key_Z)
    assert t.window.next.toolTip() == MISSING["project"]


def test_a_finished_project_lacks_nothing_and_the_theme_is_switched_on_any_page(
    technician: Technician, measured_project: Path
) -> None:
    t = technician
    t.bench.settings.theme = "light"
    t.activate()
    t.shortcut(Qt.Key.Key_T)
    assert is_dark()
    t.window.projects.open_project(measured_project)
    for page in ORDER:
        t.window.go_to(page)
        t.idle()
        assert t.presenter().blocker() == "", page
        if page != ORDER[-1]:
            assert t.window.next.isEnabled()
            assert t.window.missing.text() == ""
        before = is_dark()
        for dark in (not before, before):
            t.shortcut(Qt.Key.Key_T)
            t.idle()
            assert is_dark() == dark
            shown = t.window.grab().toImage()
            ground = t.window.palette().window().color()
            assert shown.pixelColor(t.window.width() - 3, t.window.height() // 2).lightness() == pytest.approx(
                ground.lightness(), abs=40
            ), f"{page} is not dressed"
    app = QApplication.instance()
    assert isinstance(app, QApplication)
    t.until(lambda: not is_polishing(app), "what is out of sight to have the new colours")
    assert t.errors() == []


def test_where_there_is_no_3d_one_notice_tells_of_it(
    technician: Technician, measured_project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from workbench.views.scene.ready import readiness

    monkeypatch.setenv("TRISECT_NO_OPENGL", "none")
    monkeypatch.setattr(readiness(), "notified", frozenset())
    t = technician
    t.window.projects.open_project(measured_project)
    for page in ("scan", "inspect"):
        t.window.go_to(page)
        t.idle()
        scenes = [scene for scene in t.scenes() if scene.isVisible()]
        assert scenes and {scene.state().kind for scene in scenes} == {"none"}
    said = [notice.text for notice in t.bench.notices.all if "3D" in notice.text]
    assert len(said) == 1
    QApplication.processEvents()


def test_a_name_typed_and_not_left_yet_is_saved(technician: Technician, tmp_path: Path) -> None:
    t = technician
    project = new_project("Block")
    t.model.create(tmp_path / "typed", replace(project, info=replace(project.info, part="Old")))
    t.activate()
    editor = t.field("Part")
    editor.setFocus()
    t.keys(editor, Qt.Key.Key_End)
    t.write("er")
    t.shortcut(Qt.Key.Key_S)
    assert t.model.project.info.part == "Older"
    assert not t.model.is_modified


def test_leaving_with_everything_undone_leaves_nothing_to_recover(technician: Technician, tmp_path: Path) -> None:
    t = technician
    folder = tmp_path / "undone"
    t.model.create(folder, new_project("Block"))
    t.activate()
    t.type_in(t.field("Part"), "Other")
    t.model.autosave()
    t.shortcut(Qt.Key.Key_Z)
    assert not t.model.is_modified
    assert t.window.leave()
    assert not (folder / ".autosave.json").exists()
