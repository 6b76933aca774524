"""How far the thickness is and what can be done, told by plain facts."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple


class Stage(StrEnum):
    """How far the inspection is."""

    NO_SCAN = "no scan"
    READING = "reading"
    UNREADABLE = "unreadable"
    MEASURING = "measuring"
    UNMEASURED = "unmeasured"
    FAILED = "failed"
    MEASURED = "measured"
    OUTDATED = "outdated"


class WhyNot(StrEnum):
    """Why the thickness cannot be measured now; nothing: it can."""

    NOTHING = ""
    NO_SCAN = "no scan"
    UNREADABLE = "unreadable"
    READ_ONLY = "read-only"
    MEASURING = "measuring"
    FACE_MISSING = "face missing"


class Facts(NamedTuple):
    """What the stage rests on."""

    scan: bool
    """There is a scan among the results."""
    shown: bool
    """It, or the one before, has been read."""
    unreadable: bool
    stale: bool
    """What is shown is the one before."""
    measuring: bool
    failed: bool
    """The last attempt gave no thickness."""
    thickness: bool
    """What is shown has one."""
    outdated: bool
    """It is not what the project would give now."""
    face_missing: bool
    """Only one of the two faces is drawn."""
    read_only: bool
    """Nothing can be kept in the project."""


def stage_of(facts: Facts) -> Stage:
    """How far it is."""
    if facts.measuring:
        return Stage.MEASURING
    if not facts.scan:
        return Stage.NO_SCAN
    if not facts.shown:
        return Stage.UNREADABLE if facts.unreadable else Stage.READING
    if facts.failed:
        return Stage.FAILED
    if facts.stale:
        return Stage.READING
    if not facts.thickness:
        return Stage.UNMEASURED
    return Stage.OUTDATED if facts.outdated else Stage.MEASURED


def why_not_measure(facts: Facts) -> WhyNot:
    """Whether the thickness can be measured."""
    if not facts.scan:
        return WhyNot.NO_SCAN
    if facts.unreadable:
        return WhyNot.UNREADABLE
    if facts.read_only:
        return WhyNot.READ_ONLY
    if facts.measuring:
        return WhyNot.MEASURING
    return WhyNot.FACE_MISSING if facts.face_missing else WhyNot.NOTHING
