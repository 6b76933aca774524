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
    """Corners of the camera target in the live picture, and what the views taken so far still lack.

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
    """Corners of the plane target and the fan's stripes in the live picture, and what the poses taken still lack.

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


ScanStage = Literal["boards", "reference", "ready", "scanning", "paused"]
"""Taking the boards' pictures; waiting for the reference; waiting for Resume; recording; not recording until Resume."""


@dataclass(frozen=True, eq=False, slots=True)
class ScanDetail:
    """State of a live scan for display: the last preview, the fan's lines, new points and covered cells.

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
    """Event that the first picture has come: the source's name, the picture's (width, height), what can be set."""

    name: str
    image_size: tuple[int, int]
    capabilities: Capabilities = field(default_factory=Capabilities)


@dataclass(frozen=True, eq=False, slots=True)
class LiveView:
    """Event with a live picture to show, reduced to 8 bit, with what is known of it and counts of frames.

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
    """Event that a view, a pose or the reference is on the disk.

    Its name has no ending, its small picture is (h, w).
    """

    name: str
    thumbnail: NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class LiveAsk:
    """Event that the user must do what `sentence` says, then press `button` (a label), which sends `answer`.

    It stands until LiveAnswered, or until another one takes its place.
    """

    sentence: Message
    button: str
    answer: Command


@dataclass(frozen=True, slots=True)
class LiveAnswered:
    """Event that the user has followed the request of the last LiveAsk."""


@dataclass(frozen=True, slots=True)
class LiveNotice:
    """Event with a sentence to show, for which nothing stops; `refused`: it says why a picture was not taken."""

    sentence: Message
    refused: bool = False


@dataclass(frozen=True, slots=True)
class LiveAdvice:
    """Event with advice on the exposure of the stripes; without a sentence where the exposure is good.

    `settings` is what to tell the source; None if a person must find out, because what is set now is not known.
    """

    sentence: Message | None = None
    settings: SourceSettings | None = None


@dataclass(frozen=True, slots=True)
class LiveChecks:
    """Event with the checks before the scan and their results; sent again whenever they change."""

    checks: tuple[Check, ...]


@dataclass(frozen=True, slots=True)
class LiveUnplugged:
    """Event that the source is gone; it is looked for every second, and what is recorded is kept."""

    sentence: Message


@dataclass(frozen=True, slots=True)
class LiveBack:
    """Event that the source, which was gone, is there again and the recording continues."""


@dataclass(frozen=True, slots=True)
class LiveSaving:
    """Event that the recording is stopping, and how many frames wait for the disk or for their analysis.

    Comes several times a second until all are.
    """

    waiting: int
    unseen: int = 0


@dataclass(frozen=True, slots=True)
class LiveEnded:
    """Event that the recording has ended: its folder, its pictures and how many were lost; `error` if it failed."""

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
