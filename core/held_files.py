"""Renaming and removing files that another program may hold open for a moment.

Windows refuses both while a scanner, a reader of PDF or a spreadsheet has the file open; no other system does. A
scanner lets go within a second, so it is tried again; what is still held then is told as `HeldOpen`.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from collections.abc import Callable
from contextvars import ContextVar
from pathlib import Path

PATIENCE_S: ContextVar[float] = ContextVar("patience_s", default=2.0)
"""How long in s it is tried again: longer than a scanner takes. A thread that draws a window has less of it."""
_TRY_EVERY_S = 0.05
"""Time in s between two tries: short beside what a reader notices."""
_HELD = (32, 33)
"""Windows: ERROR_SHARING_VIOLATION and ERROR_LOCK_VIOLATION."""
_ACCESS_DENIED = 5
"""Windows: told as well when what is to be replaced is held, or something in a folder that is to be renamed."""


class HeldOpen(PermissionError):
    """Error that another program keeps a file open."""


def rename(path: Path, to: Path) -> None:
    """Rename a file or folder to `to`; a file replaces an older one.

    Raises
    ------
    HeldOpen
        If another program holds one of the two.
    OSError
        If it cannot be done for another reason.
    """
    _patiently(lambda: path.rename(to) if path.is_dir() else path.replace(to))


def remove(path: Path) -> None:
    """Remove a file, if it is there; HeldOpen if another program holds it, OSError if it fails otherwise."""
    _patiently(lambda: path.unlink(missing_ok=True))


def remove_tree(folder: Path, *, leave: bool = False) -> None:
    """Remove a folder with all in it, if it is there; HeldOpen or OSError if that fails, but nothing with `leave`.

    With `leave` nothing is raised, and what cannot be removed stays.
    """
    with contextlib.suppress(*((OSError,) if leave else ())):
        if folder.exists():
            _patiently(lambda: shutil.rmtree(folder))
    if leave:
        shutil.rmtree(folder, ignore_errors=True)  # the rest of it


def is_open_elsewhere(error: OSError) -> bool:
    """Whether `error` surely is that another program has the file open."""
    return isinstance(error, HeldOpen) or getattr(error, "winerror", None) in _HELD


def _patiently(act: Callable[[], object]) -> None:
    """Do it, again and again while another program may be the reason that it fails."""
    end = time.monotonic() + PATIENCE_S.get()
    while True:
        try:
            act()
            return
        except OSError as error:
            if getattr(error, "winerror", None) not in (*_HELD, _ACCESS_DENIED) or _for_good(error):
                raise  # as always on other systems, which know no such number
            if time.monotonic() >= end:
                raise HeldOpen(error.errno, error.strerror, error.filename, None, error.filename2) from error
        time.sleep(_TRY_EVERY_S)


def _for_good(error: OSError) -> bool:
    """Whether access is denied for a reason that does not pass: a file that is read only, a folder for a file."""
    place = Path(error.filename2 or error.filename or "")
    return place.exists() and (not os.access(place, os.W_OK) or (bool(error.filename2) and place.is_dir()))
