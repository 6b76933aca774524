"""What a live recording has on the disk: one line a frame, written when the frame's file is whole.

`recording.csv` lies beside the frames. A line is appended in one piece, so whenever the program dies the file holds
every frame that was acknowledged; at most its last line is torn, and not counted. Where a camera was recorded, and not
a replay, it says which and when: unlike the dates of files, that stays when a recording is copied.
"""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path

from core.acquire.source import Frame
from core.calibrate.sitting import Acquisition
from core.errors import InputError
from core.files.atomic import cannot_write
from core.files.csv_text import csv_text
from core.files.reading import csv_rows, read_text
from core.findings.table import note_of
from core.messages import Message

LOG = "recording.csv"
_COLUMNS = ("name", "index", "time_s", "dropped", "taken_at", "camera")


@dataclass(frozen=True, slots=True)
class LoggedFrame:
    """Line of the log: one frame of a recording.

    `name` of its file; `index` and `time_s` as in :class:`core.acquire.source.Frame`; `dropped` counts the frames lost
    so far, by the source or because the disk was too slow. `taken_at` is when it was taken, with a time zone, and
    `camera` what the camera is known by; None and "" in a replay, and in logs of earlier versions.
    """

    name: str
    index: int
    time_s: float
    dropped: int
    taken_at: datetime | None = None
    camera: str = ""


def logged(name: str, frame: Frame, dropped: int, camera: str) -> LoggedFrame:
    """Make the log's entry of a frame just taken by `camera`; "" of a replay, whose camera is not known."""
    return LoggedFrame(name, frame.index, frame.time_s, dropped, datetime.now(UTC) if camera else None, camera)


class RecordingLog:
    """Writer of the log of the recording in `folder`, from its first frame on."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / LOG
        self._file: int | None = None

    def add(self, frame: LoggedFrame) -> None:
        """Append the entry of a frame whose file is complete; InputError, and nothing half-written, if it fails."""
        begin = 0
        try:
            if self._file is None:
                self._file = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
            begin = os.fstat(self._file).st_size
            head = "" if begin else ",".join(_COLUMNS) + "\n"
            at = "" if frame.taken_at is None else frame.taken_at.isoformat(timespec="milliseconds")
            told = (frame.name, frame.index, f"{frame.time_s:.6f}", frame.dropped, at, frame.camera)
            line = (head + csv_text([told])).encode()
            if os.write(self._file, line) < len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError as error:
            with contextlib.suppress(OSError):
                if self._file is not None:
                    os.ftruncate(self._file, begin)
            raise cannot_write(self._path, error) from error

    def close(self) -> None:
        """Close the file of the recording's log."""
        if self._file is not None:
            os.close(self._file)
            self._file = None


def read_log(folder: Path) -> tuple[LoggedFrame, ...]:
    """Read the log of the recording in `folder`: the entries of its frames in order; () if it has none.

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
        return tuple(_frame(*row) for row in rows[1:])
    except (TypeError, ValueError) as error:
        raise InputError(
            Message("set.log_damaged", "a line is damaged ({reason})", reason=str(error)),
            where=path,
            todo=Message("advice.remove_log", "remove the file: frames need it not"),
        ) from error


def _frame(name: str, index: str, time_s: str, dropped: str, taken_at: str = "", camera: str = "") -> LoggedFrame:
    at = datetime.fromisoformat(taken_at) if taken_at else None
    if at is not None and at.tzinfo is None:
        raise ValueError(f"{taken_at} has no time zone")
    return LoggedFrame(name, int(index), float(time_s), int(dropped), at, camera)


@dataclass(frozen=True, slots=True)
class FolderLog:
    """Log of a folder of pictures as far as it can be read; a damaged one is noted and ignored.

    `frames` are its lines, () where there is no log or it is damaged; `notes` say that it is.
    """

    frames: tuple[LoggedFrame, ...] = ()
    notes: tuple[Message, ...] = ()

    @classmethod
    def of(cls, folder: Path | None) -> FolderLog:
        """Read the log of the recording in `folder`; empty if there is none, and with a note if it cannot be read."""
        try:
            return cls() if folder is None else cls(read_log(folder))
        except InputError as error:
            return cls(notes=(note_of("set.log_not_read", reason=error.reason),))

    @property
    def lost(self) -> int:
        """Number of frames lost between the first and the last of the log."""
        return lost_frames(self.frames)

    def acquisition(self, pictures: Sequence[Path]) -> Acquisition | None:
        """Find the camera, first and last time of these pictures; None if the log does not tell them of each."""
        known = {frame.name: frame for frame in self.frames}
        frames = [known.get(path.name) for path in pictures]
        cameras = {"" if frame is None else frame.camera for frame in frames}
        times = [frame.taken_at for frame in frames if frame is not None and frame.taken_at is not None]
        if not times or len(times) < len(frames) or len(cameras) > 1 or "" in cameras:
            return None
        return Acquisition(cameras.pop(), min(times), max(times))


def lost_frames(frames: Sequence[LoggedFrame]) -> int:
    """Count the frames that a log shows as lost between its first and its last; a reopened source counts from 0."""
    return sum(max(0, later.dropped - earlier.dropped) for earlier, later in pairwise(frames))
