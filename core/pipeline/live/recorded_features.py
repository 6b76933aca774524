"""Features of a scan while it is recorded: each frame on the disk is looked at as the measurement would look at it.

When the recording ends, what its frames show is kept beside them, so that it can be solved at once. Recording and the
preview come first: the frames are read back from the disk on a thread of its own, however long it takes. A recording
that is ended before all have been looked at waits for the rest, no longer than the measurement would take for them.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet, gather_set
from core.files.recording.rig import Rig
from core.model import Camera
from core.pipeline.steps.kept_features import keep_features
from core.pipeline.steps.scan.features import crossed_scan
from core.pipeline.steps.scan.pictures import look_at_scan
from core.scan.features.extraction import LOOK_AHEAD
from core.settings.options import Options

LOW_PRIORITY = 10
"""Of the threads that look, where an operating system knows one of a thread; 0 is the usual one."""
GIVEN_UP_S = 5.0
"""So long it may take until it has ended when it is given up."""
LOOK_EVERY_S = 0.1
"""How often in s it is seen whether more frames are on the disk."""


class RecordedFeatures:
    """Extractor that extracts features of a scan in a thread while it is recorded, and stores them with it.

    Parameters
    ----------
    folder, ending
        Where reference and frames lie, and how the names of the frames end.
    rig, camera, settings
        As the measurement will take them.
    written
        How many frames are on the disk, in the order in which they were given.
    """

    def __init__(
        self, folder: Path, ending: str, rig: Rig, camera: Camera, settings: Options, written: Callable[[], int]
    ) -> None:
        self._folder, self._ending, self._written = folder, ending, written
        self._rig, self._camera, self._settings = rig, camera, settings
        self._names: list[str] = []
        self._seen = 0
        self._complete, self._given_up = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="features", daemon=True)

    @property
    def unseen(self) -> int:
        """Number of frames given that have not been looked at yet; 0 if the thread does not run."""
        return len(self._names) - self._seen if self._thread.is_alive() else 0

    def add(self, name: str) -> None:
        """Note that the frame `name` (without ending) is being written; the thread starts after LOOK_AHEAD of them."""
        self._names.append(name)
        if len(self._names) == LOOK_AHEAD:
            self._thread.start()

    def finish(self) -> None:
        """Note that all frames are on the disk and no more will come."""
        self._complete.set()

    def wait(self, seconds: float) -> bool:
        """Wait at most `seconds` until the features are stored or given up; return whether that is so."""
        if self._thread.ident is not None:
            self._thread.join(seconds)
        return not self._thread.is_alive()

    def give_up(self) -> None:
        """End the thread without storing features."""
        self._given_up.set()
        self._complete.set()
        self.wait(GIVEN_UP_S)

    def _run(self) -> None:
        if hasattr(os, "setpriority"):  # its threads inherit it: recording and preview come first
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), LOW_PRIORITY)
        with suppress(InputError, _GivenUp):  # told by the measurement, which looks for itself then
            if not self._wait_for(LOOK_AHEAD):
                return
            found = self._set()
            if not found.frames:  # the folder was taken away: the recorder tells it
                return
            job = found, self._settings
            looked = look_at_scan(job, progress=self._go_on, camera=self._camera, coming=self._coming())
            features = crossed_scan(looked, self._camera, self._go_on)
            pictures = PictureReader(self._set())
            pictures.learn(looked.hashes, looked.channels)
            if pictures.recording_set.frames == tuple(map(self._path, self._names)):
                keep_features(pictures, self._settings, self._camera, features)

    def _set(self) -> RecordingSet:
        return gather_set(self._rig, None, None, self._folder)

    def _path(self, name: str) -> Path:
        return self._folder / f"{name}{self._ending}"

    def _coming(self) -> Iterator[Path]:
        """The frames, each when it is on the disk, until all are."""
        number = 0
        while self._wait_for(number + 1):
            yield self._path(self._names[number])
            number += 1
            self._seen = number

    def _go_on(self, step: str, done: int, total: int) -> None:
        """Raise _GivenUp after `give_up`."""
        if self._given_up.is_set():
            raise _GivenUp

    def _wait_for(self, count: int) -> bool:
        """Wait until so many frames are on the disk; False if there will not be so many."""
        while self._written() < count:
            if self._complete.wait(LOOK_EVERY_S) and self._written() < count:
                return False
        return True


class _GivenUp(Exception):
    """The thread ends without features."""
