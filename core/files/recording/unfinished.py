"""A recording that was being made when the program died: noted when it begins, so that it is found afterwards."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

from core.acquire.source import Step
from core.errors import InputError
from core.files.atomic import make_inner_folder, remove, write_text
from core.files.reading import read_json
from core.files.recording.set_listing import pictures_in

NOTE = Path("recordings") / ".unfinished.json"
"""Within the project; there only while something is recorded, or after a crash."""


@dataclass(frozen=True, slots=True)
class Unfinished:
    """Unfinished recording: its step, the folder of its pictures, and how many there are."""

    step: Step
    folder: Path
    pictures: int


def note_recording(project: Path, step: Step, folder: Path) -> None:
    """Write into the project's folder the note that `folder` is being recorded for `step`; InputError if that fails."""
    make_inner_folder(project, NOTE.parent.name)
    write_text(project / NOTE, json.dumps({"step": step, "folder": folder.name}), sync=False)


def forget_recording(project: Path) -> None:
    """Remove the note of a recording in progress from the project's folder; InputError if it cannot be removed."""
    remove(project / NOTE)


def unfinished_recording(project: Path) -> Unfinished | None:
    """Find the recording that the project's note tells was interrupted; None without a note, or without pictures."""
    try:
        noted = read_json(project / NOTE)
        step, name = noted["step"], noted["folder"]
        if step not in get_args(Step) or name != Path(name).name:
            return None
        folder = (project / NOTE).parent / name
        pictures = len(pictures_in(folder))
    except (OSError, ValueError, KeyError, TypeError, InputError):
        return None  # no note, or none that can be read: the pictures are where they are
    return Unfinished(step, folder, pictures) if pictures else None
