"""A project on disk: a folder with project.json, recordings, calibrations and results."""

from __future__ import annotations

from core.files.project_data import (
    Accepted,
    Done,
    KeptStudy,
    Project,
    ProjectFile,
    ProjectInfo,
    Repeat,
    ReportChoices,
    Sources,
    new_project,
)
from core.files.project_folder import (
    OPENER,
    backups,
    is_project,
    project_from_set,
    put_opener,
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
from core.files.project_json import NewerProject
from core.files.project_rescue import Version, can_be_saved, rescues

__all__ = [
    "OPENER",
    "Accepted",
    "Done",
    "KeptStudy",
    "NewerProject",
    "Project",
    "ProjectFile",
    "ProjectInfo",
    "Repeat",
    "ReportChoices",
    "Sources",
    "Version",
    "backups",
    "can_be_saved",
    "is_project",
    "new_project",
    "project_from_set",
    "put_opener",
    "read_autosave",
    "read_project",
    "recoverable",
    "remove_autosave",
    "rescues",
    "source_folder",
    "sources_of_set",
    "stored_source",
    "write_autosave",
    "write_project",
]
