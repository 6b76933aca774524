"""What became of each frame of a scan, and why. Light to import: a window holds these."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from core.findings.table import note_of
from core.image.exclusion import MOVEMENTS, Excludable, Reason
from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.model.arrays import Array

if TYPE_CHECKING:  # a window that holds these loads no search trees
    from core.image.mosaic import Sites
    from core.image.stripes.bracket import Exposures

NO_REASON = Message("scan.no_reason", "no reason recorded")
FEW_CROSSINGS = Message("scan.frame_few_crossings", "fewer than three crossings with the fan")

_NAMED = 3
"""So many frames are named in a note."""


@dataclass(frozen=True, eq=False, slots=True)
class FrameFeatures(Excludable):
    """Features of one frame: the sweep's centrelines, or the `exclusion` that says why there are none.

    Against the reference: `shift_px` of the fan's light, `fan_shifts_px` (C,) of each of its stretches
    (`core.scan.features.reference.fan_stretches`; none where not known), and `light_change` of the background as a
    share of it, 0 where it is too small to tell. `exposures` tells how each of its further exposures goes with
    it, by their number. `gain` is the factor of its light over the reference's that was taken off; 1 where it is the
    same, or not known.
    """

    index: int
    name: str
    centrelines: tuple[Centreline, ...]
    exclusion: Reason | None = None
    shift_px: float = 0.0
    light_change: float = 0.0
    fan_shifts_px: Array = field(default_factory=lambda: np.zeros(0))
    exposures: Mapping[int, Exposures] = field(default_factory=dict)
    gain: float = 1.0

    def in_whole_picture(self, sites: Sites) -> FrameFeatures:
        """Convert centrelines and shifts from px of the `sites` of a colour mosaic to px of the whole picture."""
        return replace(
            self,
            centrelines=sites.in_whole_picture(self.centrelines),
            shift_px=sites.period * self.shift_px,
            fan_shifts_px=sites.period * self.fan_shifts_px,
        )


class CrossingUse(IntEnum):
    """Use of a crossing in the network: that it counts, or the reason why it does not."""

    COUNTS = 0
    NOT_THE_FAN = 1
    NOT_THE_SWEEPS = 2
    MOVED = 3
    NOT_LOCATED = 4
    SECOND_BOUNCE = 5

    @property
    def message(self) -> Message:
        """Words for the use of the crossing: "counts", or the reason why it does not."""
        return _WHY_LEFT_OUT[self]


_WHY_LEFT_OUT = {
    CrossingUse.COUNTS: Message("scan.crossing_counts", "counts"),
    CrossingUse.NOT_THE_FAN: Message("scan.crossing_not_the_fan", "disagrees with the fan"),
    CrossingUse.NOT_THE_SWEEPS: Message("scan.crossing_not_the_sweeps", "disagrees with other sweeps"),
    CrossingUse.MOVED: Message(
        "scan.crossing_moved", "object or camera moved between its frame and the others, or the fan"
    ),
    CrossingUse.NOT_LOCATED: Message("scan.crossing_not_located", "its frame was not located"),
    CrossingUse.SECOND_BOUNCE: Message("scan.crossing_second_bounce", "lies on a second bounce, or on what may be one"),
}


@dataclass(frozen=True, slots=True)
class FrameRecord:
    """Record of one frame: whether it was used, what it shows, and the reason if it gave no points.

    Parameters
    ----------
    index, name
        Of the frame, in the order of the recording.
    used
        Whether it gave points.
    reason
        Why it gave none; None if it did.
    stripes, stripe_px
        How many centrelines its stripe has, and of how many points in all.
    fan_crossings, fan_lines_met, sweep_crossings
        Crossings with the fan, on how many different lines, and crossings with other sweeps.
    left_out, left_out_reasons
        How many of the crossings did not count: in all, and by reason.
    condition
        Ratio of the singular values of the crossings with the fan: how near to collinear they are.
    second_bounces
        How many of its centrelines were left out because a shiny side had mirrored the light, or may have.
    points, sigma_mm
        How many it gave, and their median σ.
    """

    index: int
    name: str
    used: bool
    reason: Message | None = None
    stripes: int = 0
    stripe_px: int = 0
    fan_crossings: int = 0
    fan_lines_met: int = 0
    sweep_crossings: int = 0
    left_out: int = 0
    condition: float = float("inf")
    points: int = 0
    sigma_mm: float = float("nan")
    left_out_reasons: tuple[tuple[CrossingUse, int], ...] = ()
    second_bounces: int = 0


def notes_on(frames: Sequence[FrameFeatures]) -> tuple[Message, ...]:
    """Make notes on movements, changes of brightness and further exposures in a scan's frames; () for none."""
    return _moved_notes(frames) + _gain_notes(frames) + _exposure_notes(frames)


def light_faults(frames: Sequence[FrameFeatures]) -> tuple[Message, ...]:
    """Make the notes on faults of the light over a scan's frames: that the room's light has changed; else ()."""
    return _light_notes(frames)


def _exposure_notes(frames: Sequence[FrameFeatures]) -> tuple[Message, ...]:
    """How much further exposures gave, and which were of no use."""
    numbers = sorted({number for frame in frames for number in frame.exposures})
    return tuple(note for number in numbers for note in _notes_on_exposure(frames, number))


def _notes_on_exposure(frames: Sequence[FrameFeatures], number: int) -> Iterator[Message]:
    """The same of the exposures of one number."""
    again = [(frame, frame.exposures[number]) for frame in frames if number in frame.exposures]
    factors = [seen.factor for _, seen in again if np.isfinite(seen.factor)]
    moved = [(frame, seen) for frame, seen in again if seen.moved]
    if factors:
        points = sum(sum(map(len, frame.centrelines)) for frame, _ in again)
        stops = float(np.log2(np.median(factors)))
        shorter, longer = Message("scan.shorter", "shorter"), Message("scan.longer", "longer")
        yield note_of(
            "scan.further_exposures",
            n=len(again),
            all=len(frames),
            number=number,
            stops=abs(stops),
            which=shorter if stops >= 0 else longer,
            percent=100 * sum(seen.points for _, seen in again) / max(points, 1),
        )
    if moved:
        yield note_of(
            "scan.further_exposures_moved",
            number=number,
            n=len(moved),
            all=len(again),
            name=moved[0][0].name,
            shift_px=moved[0][1].shift_px,
        )


def _gain_notes(frames: Sequence[FrameFeatures]) -> tuple[Message, ...]:
    changed = [frame for frame in frames if frame.gain != 1]
    if not changed:
        return ()
    most = max(abs(frame.gain - 1) for frame in changed)
    return (
        note_of("scan.brightness_changed", n=len(changed), all=len(frames), name=changed[0].name, percent=100 * most),
    )


def _light_notes(frames: Sequence[FrameFeatures]) -> tuple[Message, ...]:
    changed = [frame for frame in frames if frame.light_change]
    if not changed:
        return ()
    most = max((frame.light_change for frame in changed), key=abs)
    brighter, darker = Message("scan.brighter", "brighter"), Message("scan.darker", "darker")
    return (
        note_of(
            "scan.room_light_changed",
            n=len(changed),
            all=len(frames),
            name=changed[0].name,
            percent=100 * abs(most),
            which=brighter if most > 0 else darker,
        ),
    )


def _moved_notes(frames: Sequence[FrameFeatures]) -> tuple[Message, ...]:
    moved = [frame for frame in frames if frame.exclusion in MOVEMENTS]
    if not moved:
        return ()
    return (
        note_of("scan.frames_moved", n=len(moved), all=len(frames), name=moved[0].name, shift_px=moved[0].shift_px),
    )


def left_out_notes(frames: Sequence[FrameRecord]) -> tuple[Message, ...]:
    """Make a note for each reason why frames gave no points, with the names of its first frames; () for none."""
    names: dict[Message, list[str]] = {}
    for frame in frames:
        if not frame.used:
            names.setdefault(frame.reason or NO_REASON, []).append(frame.name)
    return tuple(
        note_of("scan.frames_without_points", n=len(mine), all=len(frames), reason=reason, names=mine)
        if len(mine) <= _NAMED
        else note_of(
            "scan.many_frames_without_points", n=len(mine), all=len(frames), reason=reason, names=mine[:_NAMED]
        )
        for reason, mine in names.items()
    )
