"""Files appear whole or not at all: written beside their place, then renamed into it."""

from __future__ import annotations

import contextlib
import errno
import glob
import os
import secrets
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from core import held_files
from core.errors import InputError
from core.held_files import HeldOpen, is_open_elsewhere, remove_tree, rename
from core.messages import Message, plain

ANOTHER_OUT = Message("advice.another_out", "choose another folder with --out")
"""What to do on the command line where nothing can be written; a window has its own advice by this code."""
_FREE_SPACE = Message("advice.free_space", "free some space or choose another folder, then run again")
_ANOTHER_FOLDER = Message("advice.choose_another_folder", "choose another folder")
_NO_PERMISSION = Message("file.no_permission", "there is no permission to write here")
_FILE_IN_THE_WAY = Message("file.file_for_folder", "a file stands where a folder is needed")

_HELD_OPEN = (
    Message("file.held_open", "another program holds it open"),
    Message("advice.close_elsewhere", "close it in the other program, then try again"),
)
_TOO_LONG = (
    Message("file.path_too_long", "its name or its path is longer than this system takes"),
    Message("advice.shorter_path", "choose a folder with a shorter path"),
)
_LONGEST_ON_WINDOWS = 248
"""Characters of a path from which Windows, unless long paths are switched on, calls a folder or a file not found."""
_NOT_FOUND, _NAME_TOO_LONG = 3, 206
"""Windows: ERROR_PATH_NOT_FOUND and ERROR_FILENAME_EXCED_RANGE."""

_REASONS = {
    errno.ENOSPC: (Message("file.disk_full", "the disk is full"), _FREE_SPACE),
    errno.EDQUOT: (Message("file.quota_full", "your disk quota is used up"), _FREE_SPACE),
    errno.EFBIG: (
        Message("file.too_large", "the file system does not take a file of this size"),
        _ANOTHER_FOLDER,
    ),
    errno.EACCES: (_NO_PERMISSION, ANOTHER_OUT),
    errno.EPERM: (_NO_PERMISSION, ANOTHER_OUT),
    errno.EROFS: (Message("file.read_only", "the disk is read-only"), ANOTHER_OUT),
    errno.ENOTDIR: (_FILE_IN_THE_WAY, ANOTHER_OUT),
    errno.EEXIST: (_FILE_IN_THE_WAY, ANOTHER_OUT),
    errno.EISDIR: (
        Message("file.folder_for_file", "a folder stands where a file is to be written"),
        Message("advice.move_away", "move it away or choose another folder"),
    ),
}


def write_bytes(path: Path, *data: bytes | memoryview, sync: bool = True) -> None:
    """Write the pieces of `data` to `path`, so that the file is there whole or not at all; InputError if that fails.

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
    """Let `put` write a new file beside `path`, and rename it to `path` when it is whole; InputError if that fails."""
    if not path.name:
        raise cannot_write(path, IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR)))
    beside = beside_of(path)
    try:
        put(beside)
        rename(beside, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            beside.unlink()
        if isinstance(error, OSError):
            raise cannot_write(path, error) from error
        raise


def write_text(path: Path, text: str, *, sync: bool = True) -> None:
    """Write `text` as UTF-8 with plain newlines to `path`, whole or not at all; InputError if that fails."""
    write_bytes(path, text.encode("utf-8"), sync=sync)


def remove(path: Path) -> None:
    """Remove a file, if it is there; InputError if it cannot be removed."""
    try:
        held_files.remove(path)
    except OSError as error:
        raise cannot_write(path, error) from error


_LONGEST_NAME = 32
"""Characters of a name for what is not whole yet; more only if the whole one's has more: so it is seldom too long."""


def beside_of(path: Path) -> Path:
    """Make a hidden name beside `path`, not yet in use, for the file or folder that will replace it.

    Leftovers of a killed program are recognised by it.
    """
    return path.with_name(f".{_stem(path.name)}.{secrets.token_hex(4)}.part")


def _stem(name: str) -> str:
    """What such a name keeps of `name`."""
    added = len("..12345678.part")
    return name[: max(len(name), _LONGEST_NAME) - added]


@contextmanager
def folder_beside(to: Path) -> Iterator[Path]:
    """Make a folder beside `to` for the `with` block to fill and rename; at its end what is left there is removed.

    Raises
    ------
    InputError
        For every OSError: nothing can be written there.
    """
    beside = beside_of(to)
    try:
        beside.mkdir(parents=True)
        yield beside
    except OSError as error:
        raise cannot_write(to, error) from error
    finally:
        remove_tree(beside, leave=True)


def make_folder(path: Path) -> Path:
    """Make the folder `path` and its parents if missing; InputError if that fails, or it cannot be written to.

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


def make_inner_folder(folder: Path, name: str) -> Path:
    """Make the folder `name` in `folder` if missing; InputError if `folder` is gone or not writable."""
    if not folder.is_dir():
        raise vanished(folder)
    return make_folder(folder / name)


def vanished(folder: Path) -> InputError:
    """Make the error that the folder of a project is gone: moved, or on a disk that was taken out."""
    return InputError(
        Message("project.vanished", "the project's folder is gone; none is made in its place"),
        where=folder,
        todo=Message("advice.bring_folder_back", "connect its disk or move it back, then try again"),
    )


def cannot_write(path: Path, error: OSError) -> InputError:
    """Make the error that the file or folder `path` could not be written, with the system's reason."""
    if isinstance(error, HeldOpen):
        path = Path(error.filename2 or error.filename or path)  # of several files the one that is held
    known = (
        _HELD_OPEN
        if is_open_elsewhere(error)
        else _TOO_LONG
        if _is_too_long(path, error)
        else _REASONS.get(error.errno or 0)
    )
    what, todo = known or (plain(error.strerror or str(error)), ANOTHER_OUT)
    return InputError(
        Message("file.cannot_be_written", "cannot be written, because {what}", what=what), where=path, todo=todo
    )


def _is_too_long(path: Path, error: OSError) -> bool:
    number = getattr(error, "winerror", None)
    told = max(len(str(name)) for name in (path, error.filename or "", error.filename2 or ""))
    hidden = number == _NOT_FOUND and told >= _LONGEST_ON_WINDOWS
    return error.errno == errno.ENAMETOOLONG or number == _NAME_TOO_LONG or hidden


QUIET_S = 15 * 60.0
"""A hidden folder unchanged for so long is taken for a leftover of a program that was killed."""


def remove_leftovers(folder: Path, quiet_s: float = QUIET_S) -> None:
    """Remove what killed programs have left beside `folder`: hidden folders that were to be renamed to it.

    Parameters
    ----------
    folder
        What was to appear in one step.
    quiet_s
        Leave alone what has changed within so many seconds: another program may be at it.
    """
    try:
        found = [path for path in folder.parent.glob(f".{glob.escape(_stem(folder.name))}.*") if path.is_dir()]
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
