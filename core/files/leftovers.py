"""What a program that was killed has left beside the folder it was making."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

QUIET_S = 15 * 60.0
"""Nobody works any longer on a folder in which nothing has happened for so long."""


def remove_leftovers(folder: Path, quiet_s: float = QUIET_S) -> None:
    """Remove the hidden folders (`.NAME.anything`) beside `folder` in which it was to be made.

    Parameters
    ----------
    folder
        What was to appear in one step.
    quiet_s
        Leave alone what has changed within so many seconds: another program may be at it.
    """
    try:
        found = [path for path in folder.parent.glob(f".{folder.name}.*") if path.is_dir()]
    except OSError:
        return  # nothing there, or nothing to be seen
    for path in found:
        if time.time() - _changed_at(path) >= quiet_s:
            shutil.rmtree(path, ignore_errors=True)


def _changed_at(folder: Path) -> float:
    """When anything was last put into a folder, or into one of its folders two floors down."""
    times = []
    for path in (folder, *folder.glob("*/"), *folder.glob("*/*/")):
        try:
            times.append(path.stat().st_mtime)
        except OSError:
            times.append(time.time())  # it is being changed right now
    return max(times)
