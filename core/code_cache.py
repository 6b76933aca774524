"""Where compiled loops are saved: in the user's cache, or where that cannot be written in one temporary folder.

The temporary folder is of the process that found that out and of all it starts: they find it in the surroundings. That
process removes it at its end. Light to import.
"""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from functools import cache
from pathlib import Path

import platformdirs

from core.messages import Message

HANDED_DOWN = "TRISECT_TEMPORARY_CACHE"
"""The variable that names the temporary folder to the processes that are started."""


def code_cache() -> Path:
    """Return the folder of saved compiled code: the usual one, or a temporary one if that cannot be written."""
    usual = usual_cache()
    try:
        usual.mkdir(parents=True, exist_ok=True)
    except OSError:
        return temporary_cache()
    return usual if os.access(usual, os.W_OK | os.X_OK) else temporary_cache()


def usual_cache() -> Path:
    """Return the usual folder for compiled code saved between runs: in NUMBA_CACHE_DIR, else in the user's cache."""
    base = os.environ.get("NUMBA_CACHE_DIR") or platformdirs.user_cache_dir("trisect", appauthor=False)
    return Path(base) / "compiled"


def temporary_cache() -> Path:
    """Make a temporary folder for compiled code, or return that which a parent process has made."""
    handed = Path(os.environ.get(HANDED_DOWN, ""))
    return handed if handed.name and handed.is_dir() else _made()[0]


@cache
def _made() -> tuple[Path, int]:
    """The folder, and the process that made it."""
    folder = Path(tempfile.mkdtemp(prefix="trisect-compiled-"))
    os.environ[HANDED_DOWN] = str(folder)
    atexit.register(remove_temporary_cache)
    return folder, os.getpid()


def remove_temporary_cache() -> None:
    """Remove the temporary folder for compiled code, if this process has made one."""
    if _made.cache_info().currsize:
        folder, maker = _made()
        if os.getpid() == maker:  # not a fork of it
            shutil.rmtree(folder, ignore_errors=True)


def note_on_cache() -> Message | None:
    """Note that compiled code is lost at the program's end, as its folder cannot be written; None where it is kept."""
    if HANDED_DOWN not in os.environ:
        return None
    return Message(
        "run.cache_not_kept",
        "{folder} cannot be written, so the measuring loops are compiled anew, for minutes, each time the program "
        "starts. Name a folder that can be written in the variable NUMBA_CACHE_DIR.",
        folder=usual_cache(),
    )
