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
    "new_project",
]
