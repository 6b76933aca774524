"""Where a step's pictures come from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from core.acquire.source import Step
from core.files.project.folder import source_folder, stored_source
from workbench.project_model import ProjectModel


def folder_of(model: ProjectModel, step: Step) -> Path | None:
    """The folder of a step's pictures, or None if there is none yet."""
    stored = getattr(model.project.sources, step)
    return source_folder(model.folder, stored) if stored and model.folder is not None else None


def put_source(model: ProjectModel, step: Step, folder: Path, label: str, *, keep_left_out: bool = False) -> None:
    """Make `folder` the source of a step's pictures; undoable.

    What was left out by hand of the last one is let in, unless the pictures are the same and some more.
    """
    if model.folder is None:
        return
    project = model.project
    sources = replace(project.sources, **{step: stored_source(model.folder, folder)})
    if sources == project.sources:
        return
    kept = frozenset(name for name in project.options.excluded if keep_left_out or not name.startswith(f"{step}/"))
    model.edit(label, replace(project, sources=sources, options=replace(project.options, excluded=kept)))
