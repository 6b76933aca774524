"""How far a calibration is, told by plain facts: one rule for the camera's and the laser planes'."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple


class Stage(StrEnum):
    """How far a calibration is."""

    NO_CAMERA = "no camera"
    NONE = "none"
    EMPTY = "empty"
    FOUND = "found"
    LIVE = "live"
    SEARCHING = "searching"
    SOLVING = "solving"
    FAILED = "failed"
    SOLVED = "solved"
    REJECTED = "rejected"
    ACCEPTED = "accepted"
    OUTDATED = "outdated"
    OTHER = "other"


class Facts(NamedTuple):
    """What the stage rests on."""

    live: bool
    """Pictures are being taken."""
    searching: bool
    solving: bool
    """What the pictures show is known, and is being solved."""
    accepted: str
    """Id of the accepted calibration, or ""."""
    candidate: str
    """Id of the calibration that is shown, or ""."""
    current: bool
    """The accepted calibration is what the project gives now."""
    rejected: bool
    """The candidate is not wanted."""
    camera_missing: bool
    """A camera calibration has to be accepted first."""
    failed: bool
    source: bool
    """A folder of pictures is chosen."""
    empty: bool
    """It holds no pictures."""


def stage_of(facts: Facts) -> Stage:
    """How far it is."""
    if facts.live:
        return Stage.LIVE
    if facts.searching:
        return Stage.SEARCHING
    if facts.solving:
        return Stage.SOLVING
    if facts.accepted and facts.candidate in ("", facts.accepted):
        return Stage.ACCEPTED if facts.current else Stage.OUTDATED
    if facts.candidate:
        if facts.accepted and facts.current:
            return Stage.OTHER
        return Stage.REJECTED if facts.rejected else Stage.SOLVED
    if facts.camera_missing:
        return Stage.NO_CAMERA
    if facts.failed:
        return Stage.FAILED
    if not facts.source:
        return Stage.NONE
    return Stage.EMPTY if facts.empty else Stage.FOUND
