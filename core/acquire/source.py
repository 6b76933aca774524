"""What every live source of frames is: opened, told what to do, read frame by frame, closed.

One source is used from one thread at a time. Times are those of a clock that only runs forward, in s, from an origin
of the source's own. A source that is unplugged raises :class:`Unplugged` once and is then closed: `open` it again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from core.acquire.settings import Capabilities, Region, SourceSettings
from core.errors import InputError
from core.messages import Message

__all__ = [
    "Capabilities",
    "Ended",
    "Frame",
    "FrameSource",
    "Lasers",
    "Picture",
    "Region",
    "Shown",
    "SourceChoice",
    "SourceInfo",
    "SourceSettings",
    "Step",
    "Unplugged",
    "WaitingSource",
]

Step = Literal["camera", "planes", "scan", "check"]
"""What is being recorded, named as the part of the recording set it becomes."""
Shown = Literal["camera", "planes", "scan", "check", "boards"]
"""What is before a source: that of a step, or of a scan the boards beside the part, with light on them."""

Picture = NDArray[np.uint8] | NDArray[np.uint16]
"""Grey levels (height, width)."""


@dataclass(frozen=True, slots=True)
class Lasers:
    """State of the lasers: whether the fixed fan is on, and the one moved by hand."""

    fan: bool
    hand: bool


@dataclass(frozen=True, slots=True)
class SourceChoice:
    """Choice of a source: its kind by name, and which of that kind.

    Parameters
    ----------
    kind
        One of :data:`core.pipeline.live.sources.SOURCES`.
    id
        What that kind knows it by (`SourceKind.device_help`): a number, a name, an address, a folder, a scenario. "" is
        the first or usual one.
    """

    kind: str
    id: str = ""


@dataclass(frozen=True, slots=True)
class SourceInfo:
    """Source that can be chosen, as a list shows it: its name, and what else is known of it.

    Texts are what the device calls itself, messages what we call it.
    """

    choice: SourceChoice
    name: Message | str
    detail: Message | str = ""


@dataclass(frozen=True, eq=False, slots=True)
class Frame:
    """Picture of a source.

    Parameters
    ----------
    picture
        (height, width) uint8 or uint16.
    index
        Number of the frame since the source was opened, from 0; lost ones are counted, so a gap is a loss.
    time_s
        When it was exposed, in s on the source's clock.
    dropped
        Frames lost so far, exact where the driver tells, else as far as it is known.
    """

    picture: Picture
    index: int
    time_s: float
    dropped: int


class Unplugged(InputError):
    """Error that the source is gone during its work; it may come back, so open it again."""


class Ended(Exception):
    """Exception that a replay is at its end: there are no more frames."""


class FrameSource(Protocol):
    """Camera, or a substitute for one."""

    @property
    def name(self) -> str:
        """Displayed name of the source."""

    @property
    def capabilities(self) -> Capabilities:
        """Settings that the source has, with their limits; exact only while it is open."""

    def open(self) -> None:
        """Open the source for reading, also again after `close` or `Unplugged`; InputError if that fails."""

    def configure(self, settings: SourceSettings) -> None:
        """Change the settings that are not None, before or after `open`; InputError if one cannot be set."""

    def prepare(self, step: Shown) -> None:
        """Announce what is to be shown next; only simulated rigs and replays change their scene by it."""

    def lasers(self, lasers: Lasers) -> bool:
        """Switch the lasers, and return whether the source has done it; if False, the user must."""

    def read(self, timeout_s: float) -> Frame | None:
        """Return the next frame; None if none comes within `timeout_s`; raises Unplugged, or Ended at the end."""

    def close(self) -> None:
        """Release the source; does nothing if it is closed already."""


@runtime_checkable
class WaitingSource(FrameSource, Protocol):
    """Source that keeps its scene until that has been recorded."""

    @property
    def waits(self) -> bool:
        """Whether the source exposes its next frame only when the last one was read, at its present rate."""

    def go_on(self, frame: Frame) -> None:
        """Let the scene go on: the content of `frame` was recorded, or cannot be used."""
