"""Where a step's pictures come from."""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from core.acquire.source import Step
from core.files.project.folder import free_folder, source_folder, stored_source
from workbench.project_model import ProjectModel

_RECORDINGS = "recordings"
_RECORDED = re.compile(rf"(^|/){_RECORDINGS}/[a-z]+-\d{{8}}-\d{{6}}([ -]\d+)?$")
"""The names that `recording_folder` gives."""


def folder_of(model: ProjectModel, step: Step) -> Path | None:
    """Return the folder of a step's pictures; None if none is chosen."""
    stored = getattr(model.project.sources, step)
    return source_folder(model.folder, stored) if stored and model.folder is not None else None


def put_source(model: ProjectModel, step: Step, folder: Path, label: str, *, keep_left_out: bool = False) -> None:
    """Make `folder` the source of a step's pictures, as the edit `label`; undoable.

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


def recording_folder(project: Path, step: Step) -> Path:
    """Make the path of a new folder for a live recording, named by step and time."""
    return free_folder(project / _RECORDINGS, f"{step}-{datetime.now():%Y%m%d-%H%M%S}")


def scan_begins_live(model: ProjectModel) -> bool:
    """Whether the scan page starts with the live source, as the project has neither a scan nor other pictures.

    With neither a fan nor boards none can be recorded. The next part of a series has no scan, but the pictures of its
    calibrations: it is recorded as these were.
    """
    project = model.project
    sources = project.sources
    last = sources.planes or sources.camera
    by = project.rig.has_fan or bool(project.rig.known_planes)
    return by and not sources.scan and (not last or _RECORDED.search(last) is not None)
