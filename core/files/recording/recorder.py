"""Raw frames to the disk as they come, without keeping anybody waiting and without losing any unnoticed."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Literal

from core.acquire.source import Frame, Picture
from core.errors import InputError
from core.files.atomic import make_folder
from core.files.pictures import picture_parts
from core.files.recording.direct_file import DirectWriter
from core.files.recording.recording_log import LoggedFrame, RecordingLog, logged

Ending = Literal[".png", ".pgm"]

WAITING_BYTES = 512 * 2**20
"""Pictures waiting for the disk may take so much memory; what comes on top is dropped and counted."""


class Recorder:
    """Writer of pictures, lossless, on a thread of its own, in the order in which they are given.

    A file is there whole or not at all, at whatever moment the program dies. When the disk does not take a picture, it
    and those behind it are kept and the next call raises InputError; the call after that finds them being tried again,
    so that nothing is lost if room has been made meanwhile.

    Parameters
    ----------
    folder
        Where to; made if it is not there.
    ending
        Of the files: ".png" takes half the room, ".pgm" a tenth of the time.
    waiting_bytes
        How much may wait for the disk; at least one picture always may.
    put
        Writes one picture; None: straight to the disk (:mod:`core.files.recording.direct_file`).

    Raises
    ------
    InputError
        If the folder cannot be made or written to.
    """

    def __init__(
        self,
        folder: Path,
        *,
        ending: Ending = ".png",
        waiting_bytes: int = WAITING_BYTES,
        put: Callable[[Path, Picture], None] | None = None,
    ) -> None:
        self._folder = make_folder(folder)
        self._writer = DirectWriter()
        self._ending, self._limit, self._put = ending, waiting_bytes, put or self._put_direct
        self._log = RecordingLog(folder)
        self._changed = threading.Condition()
        self._queue: deque[tuple[Path, Picture, LoggedFrame | None]] = deque()
        self._waiting_bytes = self._written = self._dropped = 0
        self._problem: InputError | None = None
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()

    @property
    def written(self) -> int:
        """Number of pictures that are written to the disk."""
        with self._changed:
            return self._written

    @property
    def dropped(self) -> int:
        """Number of pictures lost: the disk is too slow, or `close` has given them up."""
        with self._changed:
            return self._dropped

    @property
    def waiting(self) -> int:
        """Number of pictures accepted but not yet on the disk."""
        with self._changed:
            return len(self._queue)

    def write(self, name: str, picture: Picture, frame: Frame | None = None, camera: str = "") -> bool:
        """Queue a picture, which must not change any more, to be written as `name`; False if it is dropped.

        Parameters
        ----------
        name
            Name of the file.
        picture
            What it holds.
        frame
            The frame it is of, for the log (:mod:`core.files.recording.recording_log`); without it there is no line.
        camera
            What the camera is known by: the log then says that it has just been taken by it. "" in a replay.

        Returns
        -------
        bool
            False if too many are waiting for the disk: the picture is dropped, and counted.

        Raises
        ------
        InputError
            If an earlier picture could not be written; this one is not taken, and counted as dropped.
        ValueError
            If the name is not a plain file name.
        """
        if not name or Path(name).name != name:
            raise ValueError(f"{name!r} is no plain file name")
        path = self._folder / (name if name.lower().endswith(self._ending) else f"{name}{self._ending}")
        with self._changed:
            if self._closing:
                raise ValueError("the recorder is closed")
            if self._problem is not None:
                self._dropped += 1
                self._tell()
            if self._queue and self._waiting_bytes + picture.nbytes > self._limit:
                self._dropped += 1
                return False
            lost = 0 if frame is None else frame.dropped + self._dropped
            line = None if frame is None else logged(path.name, frame, lost, camera)
            self._queue.append((path, picture, line))
            self._waiting_bytes += picture.nbytes
            self._changed.notify_all()
            return True

    def flush(self) -> None:
        """Wait until all pictures are on the disk; InputError if one cannot be written."""
        with self._changed:
            self._changed.wait_for(lambda: not self._queue or self._problem is not None)
            if self._problem is not None:
                self._tell()

    def close(self) -> None:
        """Write all waiting pictures and close the recorder; what still cannot be written counts as dropped.

        Raises
        ------
        InputError
            If a picture could not be written. The recorder is closed all the same.
        """
        with self._changed:
            if self._closing:
                return
            self._closing = True
            self._problem = None  # the last try
            self._changed.notify_all()
        self._thread.join()
        self._log.close()
        if self._problem is not None:
            raise self._problem

    def _put_direct(self, path: Path, picture: Picture) -> None:
        self._writer.write(path, *picture_parts(path, picture))

    def _tell(self) -> None:
        """Raise the problem once; the writing goes on."""
        problem, self._problem = self._problem, None
        self._changed.notify_all()
        assert problem is not None
        raise problem

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._problem is None and (self._queue or self._closing))
                if not self._queue:
                    return
                last_try = self._closing
                path, picture, line = self._queue[0]
            try:
                self._put(path, picture)
                if line is not None:
                    self._log.add(line)
            except InputError as problem:
                if self._gave_up(problem, last_try=last_try):
                    return
                continue
            with self._changed:
                self._queue.popleft()
                self._waiting_bytes -= picture.nbytes
                self._written += 1
                self._changed.notify_all()

    def _gave_up(self, problem: InputError, *, last_try: bool) -> bool:
        """Keep the problem for the next call; whether there will be none, since the recorder is being closed."""
        with self._changed:
            if self._closing and not last_try:  # closed meanwhile: there may be room now
                return False
            self._problem = problem
            if last_try:
                self._dropped += len(self._queue)
                self._queue.clear()
            self._changed.notify_all()
            return last_try
