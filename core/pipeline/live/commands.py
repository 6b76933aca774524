"""What a window tells a live recording: what it is to be, and then commands. All of it can be pickled."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from core.acquire.source import Lasers, SourceChoice, SourceSettings, Step
from core.files.recording.recorder import Ending
from core.files.recording.rig import Rig
from core.files.results.check_file import InterimCheck
from core.image.targets.kinds import Target
from core.image.targets.target_view import TargetView
from core.model import Camera, Fan
from core.settings.options import Options


@dataclass(frozen=True, eq=False, slots=True)
class LiveRequest:
    """Request for a live recording: what to record, from which source, into which folder.

    Parameters
    ----------
    step
        What is recorded.
    source, settings
        The source, and what it is told at first.
    rig
        Targets and lasers.
    folder
        Made for the pictures; must not hold anything yet.
    camera, fan
        The calibrations as far as they are known; a scan without both shows stripes, but no points.
    options
        How the scan will be measured.
    display_px
        Width of the pictures for display, at most.
    auto
        Take views and poses without being told.
    pairs
        Take each pose of the plane target with the fan on and off.
    there
        What the target showed in the pictures that these are added to.
    calibrated_s
        When the older of the two calibrations was made, in s since 1970; None if that is not known.
    ending
        Of the files of a scan's frames: ".png" takes half the room, ".pgm" a tenth of the time.
    kept_planes
        The project whose history holds the fan, and its id there: it says how sharp the fan's stripes were then.
    check
        The last interim check of these calibrations; None if there is none.
    boards
        Names of the boards that lie beside the part during the scan; their pictures are taken before it.
    """

    step: Step
    source: SourceChoice
    settings: SourceSettings
    rig: Rig
    folder: Path
    camera: Camera | None = None
    fan: Fan | None = None
    options: Options = field(default_factory=Options)
    display_px: int = 1280
    auto: bool = True
    pairs: bool = True
    there: tuple[TargetView, ...] = ()
    calibrated_s: float | None = None
    ending: Ending = ".png"
    kept_planes: tuple[Path, str] | None = None
    check: InterimCheck | None = None
    boards: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Capture:
    """Command to take a view or pose from the next frame searched, whatever its quality."""


@dataclass(frozen=True, slots=True)
class Auto:
    """Command to take views and poses automatically, or no longer."""

    on: bool


@dataclass(frozen=True, slots=True)
class Switch:
    """Command to switch the lasers, if the source can."""

    lasers: Lasers


@dataclass(frozen=True, slots=True)
class TakeReference:
    """Command to take the reference, with the fan alone on; given again while it is waited for: take it as it is."""


@dataclass(frozen=True, slots=True)
class TakeBoards:
    """Command to take the boards' pictures, all lasers off; given again while they are sought: go on without some."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Command to record no frames until Resume is given."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Command to record frames again after Pause."""


@dataclass(frozen=True, slots=True)
class Mark:
    """Command to mark the newest recorded frame, so that it can be found again."""


@dataclass(frozen=True, slots=True)
class Stop:
    """Command to finish the recording: what has been recorded is complete."""


@dataclass(frozen=True, slots=True)
class Configure:
    """Command to change the settings of the source to `settings`."""

    settings: SourceSettings


@dataclass(frozen=True, slots=True)
class Discard:
    """Command to move the view or pose called `name` into the folder `discarded`."""

    name: str


@dataclass(frozen=True, slots=True)
class LookFor:
    """Command to look for `target` from now on, as the camera target was stated wrongly."""

    target: Target


Command = (
    Capture | Auto | Switch | TakeReference | TakeBoards | Pause | Resume | Mark | Stop | Configure | Discard | LookFor
)
