"""A project on disk: a folder with project.json, recordings, calibrations and results."""

from __future__ import annotations

from core.files.project_data import (
    Accepted,
    Done,
    Paper,
    Project,
    ProjectFile,
    ProjectInfo,
    Repeat,
    ReportChoices,
    Sources,
    new_project,
)
from core.files.project_folder import (
    backups,
    is_project,
    project_from_set,
    read_autosave,
    read_project,
    recoverable,
    remove_autosave,
    source_folder,
    sources_of_set,
    stored_source,
    write_autosave,
    write_project,
)

__all__ = [
    "Accepted",
    "Done",
    "Paper",
    "Project",
    "ProjectFile",
    "ProjectInfo",
    "Repeat",
    "ReportChoices",
    "Sources",
    "backups",
    "is_project",
    "new_project",
    "project_from_set",
    "read_autosave",
    "read_project",
    "recoverable",
    "remove_autosave",
    "source_folder",
    "sources_of_set",
    "stored_source",
    "write_autosave",
    "write_project",
]
