"""The audit trail in the window, and signing in: asked for by name and PIN."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtWidgets import QApplication, QPushButton

from core.door import WITHOUT
from core.files.project.lock import take_lock
from core.wings.audit.people import Rules, person, write_rules
from core.wings.audit.trail import read_trail
from tests.wings.strangers import look_again
from tests.workbench.clipped import clipped
from tests.workbench.pages.project.test_actions import project, projects, renamed
from tests.workbench.test_fit import LANGUAGES, SCREEN, window_in
from workbench.bench import Bench
from workbench.main_window import MainWindow
from workbench.pages.project.actions import ProjectActions
from workbench.views import ask
from workbench.wings.audit import pin
from workbench.wings.audit.people import PeopleGuard
from workbench.wings.audit.window import AuditWindow

__all__ = ["projects"]


def test_the_audit_trail_is_shown_remarked_on_and_exported(
    projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = project(tmp_path / "block")
    projects.open_project(folder)
    renamed(projects, "Other")
    projects.save()
    window = AuditWindow(projects.bench, folder)
    assert [button.text() for button in window.findChildren(QPushButton) if button.isDefault()] == ["Close"]
    assert 'info.name: "Block" → "Other"' in window.entries.toPlainText()
    window.add_remark("as the customer wished")
    assert window.entries.toPlainText().index("as the customer wished") < window.entries.toPlainText().index("Other")
    assert read_trail(folder).head in window.state.text()
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: tmp_path / "trail.csv")
    window.export.click()
    assert "as the customer wished" in (tmp_path / "trail.csv").read_text()
    audit = folder / "audit.jsonl"
    audit.write_text(audit.read_text().replace("Other", "Another"))
    assert "was changed" in AuditWindow(projects.bench, folder).state.text()


def test_all_files_are_checked_from_the_audit_trail_and_what_differs_is_named(
    projects: ProjectActions, tmp_path: Path, qtbot: Any, finished_project_folder: Path
) -> None:
    folder = Path(shutil.copytree(finished_project_folder, tmp_path / "block"))
    projects.open_project(folder)
    window = AuditWindow(projects.bench, folder)
    assert window.found.isHidden()
    window.verify.click()
    assert not window.verify.isEnabled() and "being compared" in window.found.text()
    qtbot.waitUntil(window.verify.isEnabled, timeout=30_000)
    assert "All files are what they were" in window.found.text()
    (folder / "results" / "gauge.json").write_text("{}")
    next((folder / "recordings" / "scan").glob("*.png")).unlink()
    window.verify.click()
    qtbot.waitUntil(window.verify.isEnabled, timeout=30_000)
    said = window.found.text()
    assert "results/gauge.json is not what it was" in said and "is missing" in said and "All files" not in said


def test_somebody_signs_in_changes_limits_signs_and_signs_out(
    projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = project(tmp_path / "block")
    guard = PeopleGuard(projects.bench)
    projects.model.guard = guard
    projects.open_project(folder)
    guard.sign_in_or_out(projects.save)
    assert "everybody may do everything" in projects.bench.notices.all[-1].text
    assert not AuditWindow(projects.bench, folder).sign.isEnabled()
    write_rules(folder, Rules((person("Anna", "administrator", "anna-1"),)))
    projects.close_project()
    projects.open_project(folder)
    given = [("Anna", "wrong"), ("Anna", "anna-1"), ("Anna", "anna-1")]
    monkeypatch.setattr(pin, "ask_name_and_pin", lambda parent, title, names: given.pop(0))
    monkeypatch.setattr(ask, "ask_line", lambda *_: "released")
    guard.sign_in_or_out(projects.save)
    assert "do not belong together" in projects.bench.notices.all[-1].text
    guard.sign_in_or_out(projects.save)
    assert projects.bench.notices.all[-1].text == "Anna has signed in."
    window = AuditWindow(projects.bench, folder)
    window.sign.click()
    assert "Anna (administrator)" in window.entries.toPlainText()
    assert [(one.what, one.by, one.why) for one in read_trail(folder).entries][-1] == ("signed", "Anna", "released")
    guard.sign_in_or_out(projects.save)
    assert guard.signed_in is None


@pytest.mark.parametrize("name", LANGUAGES)
def test_the_window_has_room_on_the_smallest_screen_and_cuts_no_word(
    bench: Bench, qapp: QApplication, qtbot: Any, measured_project: Path, name: str
) -> None:
    with window_in(name, bench, qapp, qtbot) as window:
        bench.model.open(measured_project)
        dialog = AuditWindow(bench, measured_project, window)
        needed = dialog.minimumSizeHint()
        assert needed.width() <= SCREEN.width() and needed.height() <= SCREEN.height()
        dialog.resize(dialog.sizeHint().boundedTo(SCREEN))
        dialog.show()
        qapp.processEvents()
        assert clipped(dialog) == {}
        dialog.close()


@pytest.fixture
def wing_gone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Path]:
    """A project that was made with the wing, which is not there any more."""
    folder = project(tmp_path / "block")
    monkeypatch.setenv(WITHOUT, "audit")
    look_again()
    yield folder
    monkeypatch.undo()
    look_again()


def test_without_the_wing_a_project_with_a_trail_opens_read_only_and_says_why(
    wing_gone: Path, window: MainWindow
) -> None:
    before = {path: path.read_bytes() for path in wing_gone.rglob("*") if path.is_file()}
    window.projects.open_project(wing_gone)
    model, (notice,) = window.model, window.bench.notices.all
    assert model.folder == wing_gone and model.is_read_only and "(read only)" in window.windowTitle()
    assert notice.text == (
        f"{wing_gone}: nothing of it can be changed, as its changes stand in audit.jsonl, which is written by the wing "
        "audit, which is not there; take it out of TRISECT_WITHOUT_WINGS."
    )
    assert window.bench.cannot_write == window.presenters["report"].bench.unwitnessed == notice.text
    renamed(window.projects, "Other")
    assert not window.projects.save()
    assert {path: path.read_bytes() for path in wing_gone.rglob("*") if path.is_file()} == before


def test_without_the_wing_a_project_that_is_locked_is_not_offered_to_be_taken_over(
    wing_gone: Path, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ask, "ask", lambda *_: pytest.fail("nothing is to be asked"))
    take_lock(wing_gone).release()
    window.projects.open_project(wing_gone)
    window.model.open(wing_gone)
    assert window.model.is_read_only and not (wing_gone / ".lock.json").exists()


@pytest.mark.parametrize("fault", ["folder gone", "guard fails"])
def test_without_the_guard_a_project_with_people_opens_read_only_and_says_why(
    bench: Bench, qapp: QApplication, qtbot: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    folder = project(tmp_path / "block")
    write_rules(folder, Rules((person("Anna", "administrator", "anna-1"),)))
    if fault == "folder gone":
        monkeypatch.setattr("workbench.wing.OURS", "workbench.no_wings")
    else:
        monkeypatch.setattr("workbench.wings.audit.people.guard_of", None)
    look_again()
    with window_in("en", bench, qapp, qtbot) as window:
        window.projects.open_project(project(tmp_path / "open"))
        renamed(window.projects, "Block 2")
        assert window.projects.save()  # nobody is named: everybody may do everything
        before = (folder / "project.json").read_bytes()
        window.projects.open_project(folder)
        assert window.model.is_read_only and "(read only)" in window.windowTitle()
        told = (
            f"{folder}: nothing of it can be changed in the window, as people.json says who may change what, and the "
            "window's wing audit, which asks who has signed in, is not there or has failed; install Trisect with all "
            "its folders."
        )
        assert window.bench.cannot_write == window.bench.notices.all[-1].text == told
        renamed(window.projects, "Other")
        assert not window.projects.save() and (folder / "project.json").read_bytes() == before
    monkeypatch.undo()
    look_again()
