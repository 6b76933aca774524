"""What a project can be opened from when its project.json cannot be read, and whether it can be saved where it lies."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from core.errors import InputError
from core.files.project_data import ProjectFile
from core.files.project_folder import AUTOSAVE, backups
from core.files.project_json import read_project_text


@dataclass(frozen=True, slots=True)
class Version:
    """An earlier state of a project that can be read; `autosaved` tells it from one of the last saved ones."""

    path: Path
    file: ProjectFile
    autosaved: bool


def rescues(folder: Path) -> tuple[Version, ...]:
    """The states that are there beside project.json: the autosaved one, and the newest good one in backups.

    The newer one comes first; what cannot be read either is left out.
    """
    saved = (path for path in backups(folder))
    found = [_readable(folder / AUTOSAVE, autosaved=True), next(filter(None, map(_readable, saved)), None)]
    there = [version for version in found if version is not None]
    return tuple(sorted(there, key=_age, reverse=True))


def can_be_saved(folder: Path) -> bool:
    """Whether the project in `folder` can be written to, as far as can be told without writing."""
    return os.access(folder, os.W_OK | os.X_OK)


def _readable(path: Path, *, autosaved: bool = False) -> Version | None:
    try:
        return Version(path, read_project_text(path), autosaved)
    except InputError:
        return None


def _age(version: Version) -> float:
    return version.file.saved.timestamp() if version.file.saved is not None else 0.0
