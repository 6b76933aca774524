"""Frames that were marked while they were recorded: marks.csv beside them, one name a line.

A line is appended in one piece when the key is pressed; one that is torn was never acknowledged, and is not counted.
"""

from __future__ import annotations

from pathlib import Path

from core.files.atomic import cannot_write
from core.files.reading import read_text

MARKS = "marks.csv"
_HEAD = "name\n"


def mark_frame(folder: Path, name: str) -> None:
    """Mark the frame with the file `name` in a recording's folder; InputError if that cannot be written."""
    path = folder / MARKS
    try:
        with path.open("a", encoding="utf-8", newline="\n") as file:
            file.write(f"{name}\n" if file.tell() else f"{_HEAD}{name}\n")
    except OSError as error:
        raise cannot_write(path, error) from error


def marked_frames(folder: Path) -> frozenset[str]:
    """Read the file names of the frames marked in a recording's folder; empty if none is, InputError if unreadable."""
    path = folder / MARKS
    if not path.is_file():
        return frozenset()
    text = read_text(path)
    return frozenset(text[: text.rfind("\n") + 1].removeprefix(_HEAD).split())
