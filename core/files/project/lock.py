"""One program at a time changes a project: a file in its folder says who has it open, where, and since when.

While the program runs, the system holds the file for it (`flock`), and lets go even if the program is killed: so what a
crash leaves behind is told from what is in use. On Windows the number of the process tells it. Another computer's hold
cannot be told so: whoever opens the project decides.
"""

from __future__ import annotations

import contextlib
import getpass
import os
import platform
import secrets
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated

from pydantic import ConfigDict, Field

from core.errors import InputError
from core.files.atomic import cannot_write, vanished
from core.files.complaints import checked_json
from core.files.folder_lock import sweep_leftovers, sweep_within, wait_for
from core.files.json_text import to_json
from core.files.reading import read_json
from core.files.running import is_running
from core.files.tables import TIME_WORDS, Time
from core.held_files import remove, rename
from core.messages import Message

LOCK = ".lock.json"

Stamp = tuple[int, int, int, int]
"""Which file it is, its size, and when it was written."""


@dataclass(frozen=True, slots=True)
class LockOwner:
    """User that has a project open: name, computer, since when, by which process; `key` is another one each time."""

    owner: str
    host: str
    since: Annotated[Time, Field(description=TIME_WORDS)]
    key: str
    pid: int = 0
    __pydantic_config__ = ConfigDict(extra="forbid", strict=True)


class ProjectInUse(InputError):
    """Error that the project is open in another program."""

    def __init__(self, holder: LockOwner, folder: Path) -> None:
        self.holder = holder
        super().__init__(
            Message(
                "project.in_use",
                "is open elsewhere, by {owner} on {host} since {since}",
                owner=holder.owner,
                host=holder.host,
                since=holder.since.astimezone(),
            ),
            where=folder,
            todo=Message("advice.read_only_or_take_over", "open it read only, or take it over"),
        )

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.holder, Path(str(self.where)))


class ProjectLock:
    """Lock of a project that only this program may change, until `release` or until another takes it over."""

    def __init__(self, folder: Path, holder: LockOwner, handle: int) -> None:
        self.folder, self.holder, self._handle = folder, holder, handle
        self._seen: Stamp | None = None

    def check(self) -> None:
        """Raise InputError if this program has lost the project's lock: to another program, or with the folder."""
        stamp = _stamp(self.folder / LOCK)
        if stamp is not None and stamp == self._seen:
            return  # a window asks many times a second: the file that was read is not read again
        holder = read_holder(self.folder)
        if holder is None:
            raise vanished(self.folder)
        if holder.key != self.holder.key:
            raise InputError(
                Message(
                    "project.taken_over",
                    "was taken over by {owner} on {host} at {since}; what is changed here is not saved",
                    owner=holder.owner,
                    host=holder.host,
                    since=holder.since.astimezone(),
                ),
                where=self.folder,
                todo=Message("advice.go_on_in_copy", "go on in a copy (File, Save a copy)"),
            )
        self._seen = stamp

    def release(self) -> None:
        """Release the project's lock, so that others can open it."""
        holder = read_holder(self.folder)
        if holder is not None and holder.key == self.holder.key:
            with contextlib.suppress(OSError):
                remove(self.folder / LOCK)
        if self._handle >= 0:
            os.close(self._handle)
            self._handle = -1


def user_name() -> str:
    """Return the name under which the user is logged in to the computer; "?" if it is not known."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a number without a name, as in some containers
        return "?"


def read_holder(folder: Path) -> LockOwner | None:
    """Read which program the project's lock file names, running or not; None without a readable lock file."""
    try:
        return checked_json(LockOwner, read_json(folder / LOCK), folder / LOCK)
    except InputError:
        return None


def _stamp(path: Path) -> Stamp | None:
    """Of the file as it is now; None if there is none. It is opened: a disk of the network tells old news else."""
    try:
        handle = os.open(path, os.O_RDONLY)
    except OSError:
        return None
    try:
        of = os.fstat(handle)
    finally:
        os.close(handle)
    return of.st_dev, of.st_ino, of.st_size, of.st_mtime_ns


def lock_owner(folder: Path) -> LockOwner | None:
    """Read which program has the project open; None if none has, as far as can be known."""
    holder = read_holder(folder)
    if holder is None or (holder.host == platform.node() and _is_left_behind(folder / LOCK, holder)):
        return None
    return holder


def take_lock(folder: Path, *, take_over: bool = False) -> ProjectLock:
    """Lock a project for this program; ProjectInUse if it is open elsewhere, unless it is to `take_over`.

    Raises
    ------
    ProjectInUse
        If somebody has it open, and `take_over` is not asked for.
    InputError
        If nothing can be written there.
    """
    with _one_at_a_time(folder):
        return _take(folder, take_over=take_over)


def _take(folder: Path, *, take_over: bool) -> ProjectLock:
    path = folder / LOCK
    holder = LockOwner(user_name(), platform.node(), datetime.now().astimezone(), secrets.token_hex(8), os.getpid())
    beside = path.with_name(f"{LOCK}.{holder.key}.new")
    try:
        handle = _write_held(beside, holder)
    except OSError as error:
        raise cannot_write(path, error) from error
    try:
        before = lock_owner(folder)
        if before is not None and not take_over:
            raise ProjectInUse(before, folder)
        if take_over or path.exists():
            rename(beside, path)
        else:
            _put_if_none(beside, path)
        now = read_holder(folder)
        if now is not None and now.key != holder.key:
            raise ProjectInUse(now, folder)  # somebody was as fast
    except BaseException as error:
        if handle >= 0:
            os.close(handle)
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
        if isinstance(error, FileExistsError) and (now := read_holder(folder)) is not None:
            raise ProjectInUse(now, folder) from error  # somebody was faster
        if isinstance(error, OSError):
            raise cannot_write(path, error) from error
        raise
    sweep_leftovers(folder)
    sweep_within(folder)
    return ProjectLock(folder, holder, handle)


@contextmanager
def _one_at_a_time(folder: Path) -> Iterator[None]:
    """Programs of this computer look and take one after another: none takes the lock between the two."""
    if sys.platform == "win32" or not folder.is_dir():
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        wait_for(handle)
        yield
    finally:
        os.close(handle)


def _write_held(path: Path, holder: LockOwner) -> int:
    """Write the file and hold it; the open file."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
    text = to_json({**asdict(holder), "since": holder.since.isoformat()})
    try:
        os.write(handle, text.encode())
        if sys.platform == "win32":
            os.close(handle)  # a file that is open there cannot be replaced
            return -1
        import fcntl

        with contextlib.suppress(OSError):  # a disk of the network that cannot lock
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BaseException:
        os.close(handle)
        raise
    return handle


def _put_if_none(beside: Path, path: Path) -> None:
    """Rename, unless there is one by now; on a disk without hard links it may come a moment too late to tell."""
    try:
        os.link(beside, path)
    except FileExistsError:
        raise
    except OSError:
        rename(beside, path)
    else:
        remove(beside)


def _is_left_behind(path: Path, holder: LockOwner) -> bool:
    """Whether no program on this computer holds the file any longer."""
    if sys.platform == "win32":
        return not is_running(holder.pid, holder.since)
    import fcntl

    try:
        handle = os.open(path, os.O_RDONLY)
    except OSError:
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return False  # held, or on a disk that cannot lock
    finally:
        os.close(handle)
    return True
