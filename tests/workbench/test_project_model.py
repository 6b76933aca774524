from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.errors import InputError
from core.files.project.data import Project, new_project
from core.files.project.folder import backups, read_project, recoverable
from core.files.project.keys import finished
from core.files.project.lock import LOCK, ProjectInUse
from core.translations import language
from workbench.language import choose
from workbench.project_model import Access, ProjectModel
from workbench.step_state import State, step_states


@pytest.fixture
def model(qapp: Any, tmp_path: Path) -> Iterator[ProjectModel]:
    model = ProjectModel()
    model.create(tmp_path / "block", new_project("Block"))
    yield model
    model.close()


def renamed(project: Project, name: str) -> Project:
    return replace(project, info=replace(project.info, name=name))


def test_an_edit_can_be_undone_and_done_again(model: ProjectModel) -> None:
    seen: list[tuple[str, str]] = []
    model.changed.connect(lambda before, after: seen.append((before.info.name, after.info.name)))
    model.edit("rename", renamed(model.project, "Other"))
    model.undo_stack.undo()
    assert model.project.info.name == "Block"
    model.undo_stack.redo()
    assert model.project.info.name == "Other"
    assert seen == [("Block", "Other"), ("Other", "Block"), ("Block", "Other")]
    assert model.undo_stack.undoText() == "rename"


def test_what_is_said_of_a_step_is_in_the_language_spoken_now(model: ProjectModel, qapp: Any) -> None:
    english = model.states["scan"].sentence
    choose(language("de"), qapp)
    try:
        german = model.states["scan"].sentence
    finally:
        choose(language("en"), qapp)
    assert english.startswith("First:") and german.startswith("Zuerst")
    assert model.states["scan"].sentence == english


def test_an_edit_that_changes_nothing_leaves_no_undo(model: ProjectModel) -> None:
    model.edit("rename", renamed(model.project, "Block"))
    assert not model.undo_stack.canUndo()
    assert not model.is_modified


def test_edits_of_one_thing_in_a_row_are_undone_together(model: ProjectModel) -> None:
    for name in ("A", "AB", "ABC"):
        model.edit("rename", renamed(model.project, name), "name")
    model.undo_stack.undo()
    assert model.project.info.name == "Block"


def test_results_are_facts_and_survive_an_undo(model: ProjectModel) -> None:
    model.edit("rename", renamed(model.project, "Other"))
    model.record("camera", finished("camera", model.project, model.results))
    model.undo_stack.undo()
    assert "camera" in model.results


def test_saving_keeps_project_and_results(model: ProjectModel) -> None:
    model.edit("rename", renamed(model.project, "Other"))
    before = model.is_modified
    model.save()
    assert (before, model.is_modified) == (True, False)
    model.record("camera", finished("camera", model.project, model.results))
    assert not model.is_modified  # what was measured is saved at once
    assert model.folder is not None
    stored = read_project(model.folder)
    assert stored.project == model.project
    assert set(stored.results) == {"camera"}


def test_an_edit_is_on_disk_soon_without_saving(model: ProjectModel, qtbot: Any) -> None:
    model.edit("rename", renamed(model.project, "Other"))
    folder = model.folder
    assert folder is not None
    qtbot.waitUntil(lambda: recoverable(folder) is not None, timeout=3000)
    again = ProjectModel()
    again.open(folder, recover=True, access=Access.TAKE_OVER)
    assert again.project.info.name == "Other"
    assert again.is_modified
    again.save()
    assert recoverable(folder) is None


def test_opening_without_recovery_forgets_the_autosave(model: ProjectModel) -> None:
    model.edit("rename", renamed(model.project, "Other"))
    model.autosave()
    folder = model.folder
    assert folder is not None
    again = ProjectModel()
    again.open(folder, access=Access.TAKE_OVER)
    assert again.project.info.name == "Block"
    assert recoverable(folder) is None


def test_an_edit_that_was_undone_is_not_offered_after_a_crash(model: ProjectModel) -> None:
    assert model.folder is not None
    model.edit("rename", renamed(model.project, "Other"))
    model.autosave()
    assert recoverable(model.folder) is not None
    model.undo_stack.undo()
    model.autosave()
    assert recoverable(model.folder) is None
    assert not (model.folder / ".autosave.json").exists()


def test_a_project_is_never_created_over_another(model: ProjectModel) -> None:
    assert model.folder is not None
    with pytest.raises(InputError, match="there is a project already"):
        ProjectModel().create(model.folder, new_project("x"))


def test_a_project_that_is_open_elsewhere_can_be_looked_at_and_nothing_of_it_is_changed(model: ProjectModel) -> None:
    folder, other = model.folder, ProjectModel()
    assert folder is not None
    model.edit("rename", renamed(model.project, "Mine"))
    model.autosave()
    with pytest.raises(ProjectInUse, match="is open elsewhere"):
        other.open(folder)
    assert not other.is_open
    other.open(folder, access=Access.READ_ONLY)
    other.edit("rename", renamed(other.project, "Theirs"))
    told: list[InputError] = []
    other.failed.connect(told.append)
    other.autosave()
    other.autosave()
    assert [error.code for error in told] == ["project.opened_read_only"]
    with pytest.raises(InputError, match="is open read only"):
        other.save()
    other.close()
    left = recoverable(folder)
    assert left is not None
    assert left.project.info.name == "Mine"
    model.save()
    assert read_project(folder).project.info.name == "Mine"


def test_who_loses_a_project_to_somebody_else_overwrites_nothing_and_is_told(model: ProjectModel) -> None:
    folder, other = model.folder, ProjectModel()
    assert folder is not None
    other.open(folder, access=Access.TAKE_OVER)
    other.edit("rename", renamed(other.project, "Theirs"))
    other.save()
    model.edit("rename", renamed(model.project, "Mine"))
    with pytest.raises(InputError, match="was taken over by"):
        model.save()
    model.autosave()
    assert model.is_read_only
    assert model.project.info.name == "Mine"  # to be taken along into a copy
    model.close()
    other.save()
    assert read_project(folder).project.info.name == "Theirs"
    other.close()
    assert not (folder / LOCK).exists()


def test_a_project_whose_folder_is_gone_is_not_made_anew_and_can_be_saved_once_it_is_back(
    model: ProjectModel, tmp_path: Path
) -> None:
    folder = model.folder
    assert folder is not None
    model.edit("rename", renamed(model.project, "Other"))
    folder.rename(tmp_path / "away")
    told: list[InputError] = []
    model.failed.connect(told.append)
    model.autosave()
    assert [error.code for error in told] == ["project.vanished"]
    with pytest.raises(InputError, match="none is made in its place"):
        model.save()
    assert not folder.exists()
    (tmp_path / "away").rename(folder)
    model.save()
    assert read_project(folder).project.info.name == "Other"


def test_edits_are_saved_by_themselves_and_the_version_before_is_kept_once(model: ProjectModel) -> None:
    folder = model.folder
    assert folder is not None
    for name in ("A", "B", "C"):
        model.edit("rename", renamed(model.project, name))
        model.save_by_itself()
        assert not model.is_modified
        assert read_project(folder).project.info.name == name
    assert [read_project(path).project.info.name for path in backups(folder)] == ["Block"]


def test_the_result_of_an_accepted_calibration_comes_back_with_it(model: ProjectModel) -> None:
    """Leaving a view out, accepting what comes of it, and undoing both leaves everything as it was."""
    first = accepting(model.project, "aaa")
    model.edit("accept", first)
    model.record("camera", finished("camera", first, {}))
    at_first = model.results["camera"]
    model.edit("leave out", replace(first, options=replace(first.options, excluded=frozenset({"camera/view03.png"}))))
    model.edit("accept", accepting(model.project, "bbb"))
    model.record("camera", finished("camera", model.project, {}))
    at_last = model.results["camera"]
    assert at_last.rests_on != at_first.rests_on
    model.undo_stack.undo()
    assert model.results["camera"] is at_first
    model.undo_stack.redo()
    assert model.results["camera"] is at_last
    model.undo_stack.undo()
    model.undo_stack.undo()
    assert step_states(model.project, model.results)["camera"].state is State.DONE


def accepting(project: Project, id_: str) -> Project:
    return replace(project, accepted=replace(project.accepted, camera=id_))
