"""What goes between the window and its worker processes: frames of a kind, a job's number and a pickled value.

Arrays beyond 1 MB go beside the pipe: the worker writes each into a file of its own in memory, the window maps it and
removes its name at once, so that it is gone with the array. Both ends import this module; it knows nothing of Qt.
"""

from __future__ import annotations

import io
import mmap
import os
import pickle
import shutil
import struct
import tempfile
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from enum import IntEnum
from io import FileIO
from pathlib import Path
from typing import Any

from core.files.running import is_running

LARGE_BYTES = 1 << 20
"""Smaller arrays are copied through the pipe, which takes less than a millisecond."""

_last_sent: deque[FileIO] = deque(maxlen=4)
"""Files of the newest arrays, kept open a little longer than a live picture is shown: the system then frees their
memory when this process closes them, instead of in the GUI thread, where that takes 3 ms for 10 MB."""

HEAD = struct.Struct("<BqQ")
"""Kind, number of the job, bytes that follow."""

PIPE_CHUNK = 1 << 20
"""A pipe is read in pieces of at most so many bytes."""

INTERRUPT = b"i"
"""What the window writes to the console's process to stop a calculation."""


class Kind(IntEnum):
    """Kind of a frame; the first five go to the worker, the others come from it."""

    SETUP = 0
    RUN = 1
    CANCEL = 2
    SHOWN = 3
    COMMAND = 4
    PROGRESS = 5
    EVENT = 6
    VIEW = 7
    DONE = 8
    CANCELLED = 9
    FAILED = 10
    AHEAD = 11


def frame(kind: Kind, number: int, value: Any = None, folder: Path | None = None) -> bytes:
    """Encode a message as bytes: its kind, the job's number and a pickled value; large arrays go to files in `folder`.

    Raises
    ------
    Exception
        Whatever pickle raises for a value that cannot be sent; no file is left then.
    """
    files: list[str] = []

    def goes_along(buffer: pickle.PickleBuffer) -> bool:
        with buffer.raw() as raw:
            path = _kept(raw, folder) if folder is not None and raw.nbytes >= LARGE_BYTES else None
        if path is not None:
            files.append(path)
        return path is None

    try:
        stream = pickle.dumps(value, protocol=5, buffer_callback=goes_along)
    except BaseException:
        for path in files:
            Path(path).unlink(missing_ok=True)
        raise
    names = pickle.dumps(files)
    return b"".join((HEAD.pack(kind, number, len(names) + len(stream)), names, stream))


def value_of(body: bytes) -> Any:
    """Decode the value of a message; large arrays in it are writable, and their memory is freed with them."""
    stream = io.BytesIO(body)
    large = [_mapped(path) for path in pickle.load(stream)]
    return pickle.load(stream, buffers=large)


def forget(body: bytes) -> None:
    """Delete the files of large arrays that a message refers to, as its value is not wanted any more."""
    for path in pickle.loads(body):
        Path(path).unlink(missing_ok=True)


def read_frame(read: Callable[[int], bytes]) -> tuple[Kind, int, bytes]:
    """Read the next message from a pipe by `read`, a function like os.read: kind, job number, and body.

    Raises
    ------
    EOFError
        If the other end is gone.
    """
    kind, number, size = HEAD.unpack(_exactly(read, HEAD.size))
    return Kind(kind), number, _exactly(read, size)


def memory_folder() -> tempfile.TemporaryDirectory[str]:
    """Make a temporary folder for large arrays, in memory if the system has a folder there."""
    shared = Path("/dev/shm")
    place = shared if shared.is_dir() and os.access(shared, os.W_OK) else None
    _sweep(place or Path(tempfile.gettempdir()))
    return tempfile.TemporaryDirectory(prefix=f"trisect-{os.getpid()}-", dir=place, ignore_cleanup_errors=True)


def _sweep(place: Path) -> None:
    """Remove such folders of programs that were killed: what is in them takes memory."""
    for path in place.glob("trisect-*-*"):
        pid = path.name.split("-")[1]
        if pid.isdigit() and not is_running(int(pid)):
            shutil.rmtree(path, ignore_errors=True)


def _exactly(read: Callable[[int], bytes], size: int) -> bytes:
    parts, left = [], size
    while left:
        part = read(min(left, PIPE_CHUNK))
        if not part:
            raise EOFError
        parts.append(part)
        left -= len(part)
    return b"".join(parts)


def _kept(raw: memoryview, folder: Path) -> str | None:
    """The file the bytes were written to; None where there is no room for it: they then go through the pipe."""
    try:
        handle, path = tempfile.mkstemp(dir=folder)
    except OSError:
        return None
    try:
        file = os.fdopen(handle, "wb", buffering=0)
        _last_sent.append(file)
        done = 0
        while done < raw.nbytes:
            done += file.write(raw[done:])
    except OSError:
        with suppress(OSError):
            Path(path).unlink()
        return None
    return path


def _mapped(path: str) -> mmap.mmap:
    """The file's bytes, as memory of this process that may be changed; its name is gone."""
    temporary = getattr(os, "O_TEMPORARY", 0)  # Windows: removed with the last handle, as it cannot be before
    handle = os.open(path, os.O_RDWR | getattr(os, "O_BINARY", 0) | temporary)
    try:
        mapped = mmap.mmap(handle, 0, access=mmap.ACCESS_COPY)
    finally:
        os.close(handle)
        if not temporary:
            Path(path).unlink()
    return mapped
