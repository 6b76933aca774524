"""Recorded pictures played back as if a camera took them now."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from core.acquire.pace import Pace
from core.acquire.source import Capabilities, Ended, Frame, Lasers, Picture, Shown, SourceSettings, Unplugged
from core.errors import InputError
from core.messages import Message

RATE_HZ = 10.0
"""Frames per second at which a folder of pictures is played back until another rate is set."""
ANY_RATE_HZ = (0.0, 10_000.0)
"""Frames per second that can be set: a folder has no limit of its own. 0: as fast as they can be read."""

FRAMES_HELD: dict[Shown, int] = {"camera": 12, "planes": 25, "scan": 1, "check": 25, "boards": 25}
"""For how many frames a picture of a recording is shown: in a recording of targets each one was held still."""

Listing = Callable[[Shown, Lasers], Sequence[Path]]
"""The pictures of a step under given lasers, in order; empty if there are none."""


class ReplaySource:
    """Folder of pictures as a :class:`core.acquire.source.FrameSource`.

    Pictures of the two targets are each shown for a while, as if held still; switching the fan in the middle shows
    the same pose with the fan off. While the hand-held laser is off the reference is shown, as long as it takes.
    No frame is lost, however late it is read. A damaged picture raises InputError in its turn; reading goes on after.

    Parameters
    ----------
    name
        What a person calls it.
    folder
        Where the pictures are; if it vanishes the source is unplugged.
    listing, read
        Which pictures there are, and how to read one.
    holds
        How many frames each picture is shown for, by step.
    loops
        Begin again at the end, instead of ending.
    clock, sleep
        Time in s that only runs forward, and how to wait.
    """

    def __init__(
        self,
        name: str,
        folder: Path,
        listing: Listing,
        read: Callable[[Path], Picture],
        *,
        holds: dict[Shown, int] | None = None,
        loops: bool = False,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.name = name
        self._folder, self._listing, self._read = folder, listing, read
        self._holds = FRAMES_HELD if holds is None else holds
        self._loops = loops
        self._pace = Pace(RATE_HZ, clock, sleep)
        self._step: Shown = "camera"
        self._lasers = Lasers(fan=False, hand=False)
        self._paths: Sequence[Path] = ()
        self._at = self._shown = self._count = 0
        self._decoded: tuple[Path, Picture] | None = None

    @property
    def capabilities(self) -> Capabilities:
        """Settings that a replay has: its rate alone."""
        return Capabilities(rate_hz=ANY_RATE_HZ)

    def open(self) -> None:
        """Check that the folder is there, and count frames from 0; InputError if it is not."""
        if not self._folder.is_dir():
            what = (
                Message("source.file_not_folder", "this is a file, not a folder")
                if self._folder.exists()
                else Message("source.no_such_folder", "there is no such folder")
            )
            raise InputError(
                what, where=self._folder, todo=Message("advice.choose_pictures", "choose a folder of pictures")
            )
        self._count = 0
        self._pace.restart()
        self._list()

    def configure(self, settings: SourceSettings) -> None:
        """Set the replay's rate (default 10 Hz; 0: as fast as it is read), its only setting."""
        self.capabilities.check(settings, self.name)
        if settings.rate_hz is not None:
            self._pace.rate_hz = settings.rate_hz

    def prepare(self, step: Shown) -> None:
        """Go to the first picture in the folder of what this `step` shows."""
        self._step = step
        self._at = self._shown = 0
        self._list()

    def lasers(self, lasers: Lasers) -> bool:
        """Show pictures taken with these lasers on; False if the folder has none, and all others are shown."""
        swept = lasers.hand and not self._lasers.hand
        darkened = self._lasers.fan and not lasers.fan
        self._lasers = lasers
        if self._step == "scan" and swept:
            self._at = 0
        if self._step == "planes" and darkened and self._shown == 0:
            self._at = max(0, self._at - 1)  # the pose that was seen last
        self._shown = 0
        return self._list()

    def read(self, timeout_s: float) -> Frame | None:
        """Return the next picture as a frame; Ended after the last one, InputError for a damaged one."""
        if self._at >= len(self._paths):
            if not (self._loops or self._rests) or not self._paths:
                raise Ended
            self._at = 0
        if not self._pace.wait(timeout_s):
            return None
        path = self._paths[self._at]
        picture = self._picture(path)
        self._shown += 1
        if self._shown >= self._holds.get(self._step, 1):
            self._at, self._shown = self._at + 1, 0
        frame = Frame(picture, self._count, self._count / (self._pace.rate_hz or RATE_HZ), 0)
        self._count += 1
        return frame

    def close(self) -> None:
        """Close the replay: drop the picture decoded last."""
        self._decoded = None

    @property
    def _rests(self) -> bool:
        """Whether this is the still object without the hand-held laser, which nothing brings to an end."""
        return self._step == "boards" or (self._step == "scan" and not self._lasers.hand)

    def _list(self) -> bool:
        wanted = self._listing(self._step, self._lasers)
        other = Lasers(fan=self._step not in ("camera", "boards"), hand=self._step == "scan")
        self._paths = wanted or self._listing(self._step, other)
        return bool(wanted)

    def _picture(self, path: Path) -> Picture:
        if self._decoded is None or self._decoded[0] != path:
            try:
                self._decoded = path, self._read(path)
            except InputError as damage:
                if not self._folder.is_dir():
                    raise Unplugged(
                        Message("source.folder_gone", "the folder is not there any more"), where=self._folder
                    ) from damage
                self._at, self._shown = self._at + 1, 0
                raise
        return self._decoded[1].copy()
