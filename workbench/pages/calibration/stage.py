"""How far a calibration is and what can be done, told by plain facts: one rule for camera and laser planes."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

from workbench.reasons import first, why


class Stage(StrEnum):
    """Stage of a calibration."""

    NOT_NEEDED = "not needed"
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


class WhyNot(StrEnum):
    """Reason why an action is not possible now; "": it is."""

    NOTHING = ""
    LIVE = "live"
    NOT_NEEDED = "not needed"
    NO_CAMERA = "no camera"
    NO_SOURCE = "no source"
    SEARCHING = "searching"
    SOLVING = "solving"
    NO_CALIBRATION = "no calibration"
    ACCEPTED = "accepted"
    REJECTED = "rejected"
    READ_ONLY = "read-only"


class Buttons(NamedTuple):
    """Reason for each disabled button, or ""."""

    run: WhyNot
    accept: WhyNot
    reject: WhyNot


class Facts(NamedTuple):
    """Facts from which stage and buttons follow."""

    needed: bool
    """The rig has what is calibrated."""
    live: bool
    """Pictures are being taken."""
    searching: bool
    solving: bool
    """What the pictures show is being solved."""
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
    calibration: bool
    """There is one that could be accepted."""
    keeping: bool
    """It is being put into the project."""
    read_only: bool
    """Nothing can be kept in it."""


class WhyNotRestore(StrEnum):
    """Reason why the calibration chosen in the history cannot be accepted again; "": it can."""

    NOTHING = ""
    NONE_KEPT = "none kept"
    NONE_CHOSEN = "none chosen"
    IN_USE = "in use"
    OTHER_CAMERA = "other camera"
    LIVE = "live"
    KEEPING = "keeping"
    JOB = "job"


class RestoreFacts(NamedTuple):
    """Facts from which it follows whether a calibration can be restored."""

    kept: bool
    """The history holds some."""
    chosen: bool
    in_use: bool
    """The chosen one is the accepted one."""
    other_camera: bool
    """It rests on another camera calibration than the accepted one."""
    live: bool
    """Pictures are being taken."""
    keeping: bool
    """Another one is being put into the project."""
    job: bool
    """A long job runs: it was begun with the calibration in use, or will put another in its place."""


def stage_of(facts: Facts) -> Stage:
    """Derive how far a calibration is (`Stage`) from what is known of its pictures and results."""
    if not facts.needed:
        return Stage.NOT_NEEDED
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


def disabled_reasons(facts: Facts) -> Buttons:
    """Derive why the buttons run, accept and reject are disabled; "" for each that is enabled."""
    if not facts.needed:
        return Buttons(*[WhyNot.NOT_NEEDED] * len(Buttons._fields))
    return Buttons(*map(WhyNot, (_run(facts), _accept(facts), _reject(facts))))


def why_not_restore(facts: RestoreFacts) -> WhyNotRestore:
    """Return the reason why the chosen stored calibration cannot be accepted again; `WhyNotRestore` "" if it can.

    Reasons in the choice come first, as waiting does not help there.
    """
    reason = first(
        why(not facts.kept, WhyNotRestore.NONE_KEPT),
        why(not facts.chosen, WhyNotRestore.NONE_CHOSEN),
        why(facts.in_use, WhyNotRestore.IN_USE),
        why(facts.other_camera, WhyNotRestore.OTHER_CAMERA),
        why(facts.live, WhyNotRestore.LIVE),
        why(facts.keeping, WhyNotRestore.KEEPING),
        why(facts.job, WhyNotRestore.JOB),
    )
    return WhyNotRestore(reason)


def _run(facts: Facts) -> str:
    return first(
        why(facts.live, WhyNot.LIVE),
        why(facts.read_only, WhyNot.READ_ONLY),
        why(facts.camera_missing, WhyNot.NO_CAMERA),
        why(not facts.source, WhyNot.NO_SOURCE),
        why(facts.searching, WhyNot.SEARCHING),
        why(facts.solving, WhyNot.SOLVING),
    )


def _accept(facts: Facts) -> str:
    return first(
        why(facts.live, WhyNot.LIVE),
        why(facts.read_only, WhyNot.READ_ONLY),
        why(not facts.calibration or facts.solving or facts.keeping, WhyNot.NO_CALIBRATION),
        why(facts.candidate == facts.accepted and facts.current, WhyNot.ACCEPTED),
    )


def _reject(facts: Facts) -> str:
    return first(
        why(facts.live, WhyNot.LIVE),
        why(not facts.candidate or facts.solving, WhyNot.NO_CALIBRATION),
        why(facts.rejected and facts.candidate != facts.accepted, WhyNot.REJECTED),
    )
