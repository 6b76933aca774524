"""A project copied to where it can be written."""

from __future__ import annotations

import shutil
from pathlib import Path

from core.errors import InputError
from core.files.atomic import folder_beside
from core.files.project.folder import AUTOSAVE, require_free
from core.files.project.lock import LOCK
from core.files.reading import resolved
from core.held_files import rename
from core.messages import Message
from core.progress import Progress, silent, steps

_LEFT_BEHIND = (AUTOSAVE, LOCK, ".new")
"""What belongs to a program that is at work, or was killed."""


def copy_project(folder: Path, to: Path, progress: Progress = silent) -> Path:
    """Copy the project in `folder` with its recordings and results, and return `to`.

    The copy appears whole or not at all, and can be written to, whatever the original says. Folders of pictures outside
    the project stay where they are.

    Raises
    ------
    InputError
        If `to` is there already or lies within the project, a file cannot be read, or nothing can be written there.
    """
    require_free(to)
    if resolved(to).is_relative_to(resolved(folder)):
        raise InputError(
            Message("project.copy_within_itself", "lies within the project that is to be copied"),
            where=to,
            todo=Message("advice.choose_another_folder", "choose another folder"),
        )
    with folder_beside(to) as beside:
        files = [path for path in sorted(folder.rglob("*")) if path.is_file() and not _left_behind(folder, path)]
        for path in steps(files, progress, "copying", len(files)):
            place = beside / path.relative_to(folder)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, place)  # the content alone: the copy need not be read-only, too
        rename(beside, to)
    return to


def _left_behind(folder: Path, path: Path) -> bool:
    return any(part in _LEFT_BEHIND for part in path.relative_to(folder).parts)
