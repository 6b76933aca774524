"""Files appear whole or not at all: written beside their place, then renamed into it."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import tempfile
from collections.abc import Callable
from pathlib import Path

from core.errors import InputError

ANOTHER_OUT = "choose another folder with --out"
"""What to do on the command line where nothing can be written; a window says something else."""

_REASONS = {
    errno.ENOSPC: ("the disk is full", "free some space or choose another folder, then run again"),
    errno.EDQUOT: ("your disk quota is used up", "free some space or choose another folder, then run again"),
    errno.EFBIG: ("the file system does not take a file of this size", "choose another folder"),
    errno.EACCES: ("there is no permission to write here", ANOTHER_OUT),
    errno.EPERM: ("there is no permission to write here", ANOTHER_OUT),
    errno.EROFS: ("the disk is read-only", ANOTHER_OUT),
    errno.ENOTDIR: ("a file stands where a folder is needed", ANOTHER_OUT),
    errno.EEXIST: ("a file stands where a folder is needed", ANOTHER_OUT),
    errno.EISDIR: ("a folder stands where a file is to be written", "move it away or choose another folder"),
}


def write_bytes(path: Path, *data: bytes | memoryview, sync: bool = True) -> None:
    """Write `data` to `path` so that the file is there whole or not at all.

    Parameters
    ----------
    path
        Where to write; an older file is replaced in one step, so readers see the old or the new one.
    data
        The whole content, in one piece or several.
    sync
        Wait until the disk holds it. Pass False for many files that could be made again.

    Raises
    ------
    InputError
        If the disk is full, or the folder cannot be written to. Nothing half written stays behind.
    """

    def put(beside: Path) -> None:
        with beside.open("xb") as file:
            file.writelines(data)
            file.flush()
            if sync:
                os.fsync(file.fileno())

    write_beside(path, put)


def write_beside(path: Path, put: Callable[[Path], None]) -> None:
    """Have `put` write a new file beside `path`, and rename it to `path` when it is whole; raises as `write_bytes`."""
    beside = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        put(beside)
        beside.replace(path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            beside.unlink()
        if isinstance(error, OSError):
            raise cannot_write(path, error) from error
        raise


def write_text(path: Path, text: str, *, sync: bool = True) -> None:
    """Write `text` as UTF-8 with plain newlines; else as :func:`write_bytes`."""
    write_bytes(path, text.encode("utf-8"), sync=sync)


def make_folder(path: Path) -> Path:
    """Make the folder `path` with its parents, if it is not there, and see that it can be written to.

    Raises
    ------
    InputError
        If it cannot be made or written to: better said before an hour of measuring than after it.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            pass
    except OSError as error:
        raise cannot_write(path, error) from error
    return path


def cannot_write(path: Path, error: OSError) -> InputError:
    """The sentence for a file or folder that could not be written."""
    what, todo = _REASONS.get(error.errno or 0, (error.strerror or str(error), ANOTHER_OUT))
    return InputError(f"cannot be written, because {what}", where=path, todo=todo)
