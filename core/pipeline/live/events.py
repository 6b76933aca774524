"""What a window hears of a live recording. All of it can be pickled."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.acquire.source import Capabilities, SourceSettings
from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.model.arrays import Array
from core.pipeline.live.commands import Command
from core.scan.preview.preflight import Check
from core.scan.preview.shown import FramePreview, PreviewCloud


@dataclass(frozen=True, eq=False, slots=True)
class CameraDetail:
    """What the live picture shows of the camera's target.

    Parameters
    ----------
    index
        The frame that was looked at last; the picture this comes with may be a later one.
    uv
        (N, 2) corners in pixels of the full picture; None if the target is not seen, or with another
        frame's picture.
    sentence
        Why the view is taken or not.
    cells
        (rows, columns) True where the views taken cover the picture.
    missing
        At most four sentences on what to record next.
    views
        How many views are taken.
    auto
        Whether views are taken without being told.
    wanted
        (5, 2) closed outline in pixels of the target where it would add most; None if nowhere in particular.
    counted
        Columns and rows of the board that is seen in place of the one looked for; None if there is none such.
    """

    index: int
    uv: Array | None
    sentence: Message | None
    cells: NDArray[np.bool_]
    missing: tuple[Message, ...]
    views: int
    auto: bool
    wanted: Array | None = None
    counted: tuple[int, int] | None = None


@dataclass(frozen=True, eq=False, slots=True)
class PlanesDetail:
    """What the live picture shows of the plane target and the fan on it.

    `stripes` are (N, 2) in pixels each, none with a picture of another frame; `line` is the fan line (from 0) each of
    them is likely to be, −1 where that is not clear. Else as CameraDetail; `poses` are taken.
    """

    index: int
    uv: Array | None
    stripes: tuple[Array, ...]
    line: tuple[int, ...]
    sentence: Message | None
    cells: NDArray[np.bool_]
    missing: tuple[Message, ...]
    poses: int
    auto: bool
    wanted: Array | None = None


ScanStage = Literal["reference", "ready", "scanning", "paused"]
"""Waiting for the reference; waiting for Resume; recording; not recording until Resume."""


@dataclass(frozen=True, eq=False, slots=True)
class ScanDetail:
    """What the scan shows so far.

    Parameters
    ----------
    index
        The frame this is about, counted in recorded frames; −1 before there is one.
    stage
        What is going on.
    preview
        Of that frame; None before there is one. Without calibrations it has the stripe's centrelines only, sigma_mm ().
    fan_lines
        The fan's centrelines by line number, as far as settled; what is not settled is in none.
    cells, lit
        (rows, columns) True where there are points, and where any laser light was seen.
    share
        Covered share (0 … 1) of what was lit.
    points
        Points that are new since the last view, or, if `renewed`, all points so far: they replace those before. Only
        these are complete; `preview.points` are of this frame alone, and frames between two views are not shown.
    """

    index: int
    stage: ScanStage
    preview: FramePreview | None
    fan_lines: tuple[tuple[Centreline, ...], ...]
    cells: NDArray[np.bool_]
    lit: NDArray[np.bool_]
    share: float
    points: PreviewCloud
    renewed: bool


Detail = CameraDetail | PlanesDetail | ScanDetail


@dataclass(frozen=True, slots=True)
class LiveStarted:
    """The first picture is there: the source's name, the full (width, height) of its pictures, what it can be told."""

    name: str
    image_size: tuple[int, int]
    capabilities: Capabilities = field(default_factory=Capabilities)


@dataclass(frozen=True, eq=False, slots=True)
class LiveView:
    """A picture to show.

    Parameters
    ----------
    picture
        (h, w) uint8, reduced by the whole factor `scale`: a point uv of the full picture is at
        (uv + 0.5) / scale − 0.5.
    index
        Number of the frame since the source was opened.
    rate_hz
        Frames per second as they come.
    recorded
        Pictures recorded so far: views, poses or frames of the scan.
    dropped
        Frames lost since the first picture was recorded, by the source or because the disk is too slow.
    detail
        What is known when it is shown; what is drawn into a picture was found in this one, but for the scan.
    """

    picture: NDArray[np.uint8]
    scale: int
    index: int
    rate_hz: float
    recorded: int
    dropped: int
    detail: Detail | None


@dataclass(frozen=True, eq=False, slots=True)
class LiveTaken:
    """A view, a pose or the reference is on the disk: its name without ending, and a small (h, w) picture of it."""

    name: str
    thumbnail: NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class LiveAsk:
    """A person must do something and then press a button of this name (a label), which sends `answer`.

    It stands until LiveAnswered, or until another one takes its place.
    """

    sentence: Message
    button: str
    answer: Command


@dataclass(frozen=True, slots=True)
class LiveAnswered:
    """What LiveAsk asked for is done."""


@dataclass(frozen=True, slots=True)
class LiveNotice:
    """A sentence to show; nothing stops for it. Or that a picture was `refused`, and why."""

    sentence: Message
    refused: bool = False


@dataclass(frozen=True, slots=True)
class LiveAdvice:
    """How to expose the stripes better; nothing where all is well.

    `settings` is what to tell the source; None if a person must find out, because what is set now is not known.
    """

    sentence: Message | None = None
    settings: SourceSettings | None = None


@dataclass(frozen=True, slots=True)
class LiveChecks:
    """What was looked at before the scan, each with what came of it; comes again whenever that changes."""

    checks: tuple[Check, ...]


@dataclass(frozen=True, slots=True)
class LiveUnplugged:
    """The source is gone; it is looked for every second. What is recorded is kept."""

    sentence: Message


@dataclass(frozen=True, slots=True)
class LiveBack:
    """The source is there again and the recording goes on."""


@dataclass(frozen=True, slots=True)
class LiveSaving:
    """It is being stopped, and so many frames still wait for the disk, or are there and have not been looked at.

    Comes several times a second until all are.
    """

    waiting: int
    unseen: int = 0


@dataclass(frozen=True, slots=True)
class LiveEnded:
    """The recording has ended: its folder, its pictures and how many were lost; `error` if it ended by itself."""

    folder: Path
    recorded: int
    dropped: int
    error: Message | None = None


LiveEvent = (
    LiveStarted
    | LiveView
    | LiveTaken
    | LiveAsk
    | LiveAnswered
    | LiveNotice
    | LiveAdvice
    | LiveChecks
    | LiveUnplugged
    | LiveBack
    | LiveSaving
    | LiveEnded
)
