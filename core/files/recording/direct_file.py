"""Large files straight to the disk, past the system's memory of files: a tenth of the processor time of a plain write.

What is recorded is not read again soon. Through the page cache a frame of 10 MB is copied, kept, and written later, at
the cost of whatever else is kept there; with Linux's O_DIRECT the disk takes it from one buffer, which must lie, and
end, on whole blocks. Where the system or the file system cannot do that, files are written plainly.
"""

from __future__ import annotations

import errno
import mmap
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.files.atomic import write_beside, write_bytes

BLOCK = 4096
"""Bytes: what is written past the system's cache must begin and end at a multiple of the disk's block, 512 or 4096."""
WORTH_BYTES = 2**20
"""Smaller files are written plainly: the disk would be waited for longer than a copy takes."""

_DIRECT: int = getattr(os, "O_DIRECT", 0)


class DirectWriter:
    """Writer of files one after another, each whole or not at all; for one thread."""

    def __init__(self) -> None:
        self._can = bool(_DIRECT)
        self._buffer: NDArray[np.uint8] = np.zeros(0, np.uint8)

    def write(self, path: Path, *data: bytes | memoryview) -> None:
        """Write the pieces of `data` to `path` one after another; if that fails, InputError and no file left."""
        size = sum(memoryview(part).nbytes for part in data)
        if not self._can or size < WORTH_BYTES:
            write_bytes(path, *data, sync=False)
            return
        whole = self._gathered(data, size)
        try:
            write_beside(path, lambda beside: _put(beside, whole, size))
        except _CannotError:
            self._can = False
            write_bytes(path, *data, sync=False)

    def _gathered(self, data: tuple[bytes | memoryview, ...], size: int) -> NDArray[np.uint8]:
        """The parts end to end in the buffer, up to the end of the last block."""
        padded = -(-size // BLOCK) * BLOCK
        if len(self._buffer) < padded:
            self._buffer = np.frombuffer(mmap.mmap(-1, padded), np.uint8)  # begins with a page
        at = 0
        for part in data:
            levels = np.frombuffer(part, np.uint8)
            self._buffer[at : at + len(levels)] = levels
            at += len(levels)
        return self._buffer[:padded]


class _CannotError(Exception):
    """The file system does not take direct writes."""


def _put(beside: Path, whole: NDArray[np.uint8], size: int) -> None:
    try:
        file = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _DIRECT, 0o666)
        try:
            at = 0
            while at < len(whole):
                at += os.write(file, whole[at:].data)
            os.ftruncate(file, size)
        finally:
            os.close(file)
    except OSError as error:
        if error.errno in (errno.EINVAL, errno.EOPNOTSUPP):
            raise _CannotError from error
        raise
