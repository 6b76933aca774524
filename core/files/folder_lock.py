"""One program at a time in a folder of results; what a killed one left half written is swept."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from core.errors import InputError
from core.messages import Message

NEW_FOLDER = ".new"
"""The folder among results in which new ones are made."""
HELD = ".held"
"""Among results, on Windows."""
LEFTOVER = re.compile(r"^\..+\.[0-9a-f]{8}\.part$")
"""As `core.files.atomic` names what is not whole yet."""


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Lock `folder` against other programs during the `with` block, waiting until it is free.

    The lock is of the folder itself and leaves no file; on Windows, which locks files only, of the hidden file HELD.

    Raises
    ------
    InputError
        If another program holds it.
    """
    windows = sys.platform == "win32"
    handle = os.open(folder / HELD, os.O_RDWR | os.O_CREAT) if windows else os.open(folder, os.O_RDONLY)
    try:
        if not _hold(handle):
            raise InputError(
                Message("file.folder_in_use", "another run writes its results here"),
                where=folder,
                todo=Message("advice.wait_or_another_out", "wait for its end, or choose another --out"),
            )
        sweep_leftovers(folder)
        yield
    finally:
        os.close(handle)


def _hold(handle: int) -> bool:
    """Hold an open file or folder until it is closed; False if another program does."""
    if sys.platform == "win32":
        import msvcrt

        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        pass  # a disk of the network that cannot lock
    return True


def wait_for(handle: int) -> None:
    """Wait until this program alone has locked an open file or folder, which closing it releases.

    A disk of the network that cannot lock, and Windows, go without.
    """
    if sys.platform == "win32":
        return
    import fcntl

    with contextlib.suppress(OSError):
        fcntl.flock(handle, fcntl.LOCK_EX)


def sweep_leftovers(folder: Path) -> None:
    """Remove from `folder` the half-written files of killed programs; the caller has locked it."""
    for path in folder.iterdir():
        if LEFTOVER.match(path.name):
            with contextlib.suppress(OSError):
                path.unlink()
        elif path.name == NEW_FOLDER:
            shutil.rmtree(path, ignore_errors=True)


def sweep_within(folder: Path) -> None:
    """Remove half-written files of killed programs from the folders within `folder`, each locked meanwhile."""
    for path in folder.iterdir():
        if path.is_dir() and not path.is_symlink():
            with contextlib.suppress(InputError, OSError), alone_in(path):
                pass
