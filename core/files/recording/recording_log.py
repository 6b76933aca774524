"""What a live recording has on the disk: one line a frame, written when the frame's file is whole.

`recording.csv` lies beside the frames. A line is appended in one piece, so whenever the program dies the file holds
every frame that was acknowledged; at most its last line is torn, and not counted.
"""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from core.errors import InputError
from core.files.atomic import cannot_write
from core.files.reading import csv_rows, read_text
from core.messages import Message

LOG = "recording.csv"
_COLUMNS = ("name", "index", "time_s", "dropped")


@dataclass(frozen=True, slots=True)
class LoggedFrame:
    """One frame of a recording.

    `name` of its file; `index` and `time_s` as in :class:`core.acquire.source.Frame`; `dropped` counts the frames lost
    so far, by the source or because the disk was too slow.
    """

    name: str
    index: int
    time_s: float
    dropped: int


class RecordingLog:
    """Writes the log of the recording in `folder`, from its first frame on."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / LOG
        self._file: int | None = None

    def add(self, frame: LoggedFrame) -> None:
        """A frame's file is whole; InputError if that cannot be written down, nothing half written stays then."""
        begin = 0
        try:
            if self._file is None:
                self._file = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
            begin = os.fstat(self._file).st_size
            head = "" if begin else ",".join(_COLUMNS) + "\n"
            line = f"{head}{frame.name},{frame.index},{frame.time_s:.6f},{frame.dropped}\n".encode()
            if os.write(self._file, line) < len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError as error:
            with contextlib.suppress(OSError):
                if self._file is not None:
                    os.ftruncate(self._file, begin)
            raise cannot_write(self._path, error) from error

    def close(self) -> None:
        """No more frames."""
        if self._file is not None:
            os.close(self._file)
            self._file = None


def read_log(folder: Path) -> tuple[LoggedFrame, ...]:
    """The frames of the recording in `folder`, in order; () if it has no log.

    Raises
    ------
    InputError
        If the log cannot be read, or a line before its last one is damaged.
    """
    path = folder / LOG
    if not path.is_file():
        return ()
    text = read_text(path)
    whole = text[: text.rfind("\n") + 1]
    rows = csv_rows(whole.splitlines(), path)
    try:
        return tuple(LoggedFrame(name, int(index), float(time), int(lost)) for name, index, time, lost in rows[1:])
    except ValueError as error:
        raise InputError(
            Message("set.log_damaged", "a line is damaged ({reason})", reason=str(error)),
            where=path,
            todo=Message("advice.remove_log", "remove the file: frames need it not"),
        ) from error


def lost_frames(frames: Sequence[LoggedFrame]) -> int:
    """How many frames were lost between the first and the last of a recording; a source opened anew counts anew."""
    return sum(max(0, later.dropped - earlier.dropped) for earlier, later in pairwise(frames))
