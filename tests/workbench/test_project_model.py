from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.errors import InputError
from core.files.project.data import Project, new_project
from core.files.project.folder import read_project, recoverable
from core.files.project.keys import finished
from workbench.project_model import ProjectModel
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
    model.record("camera", finished("camera", model.project, model.results))
    before = model.is_modified
    model.save()
    assert (before, model.is_modified) == (True, False)
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
    again.open(folder, recover=True)
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
    again.open(folder)
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
