"""How far the scan is and which buttons beside it can be pressed, told by plain facts.

Reasons of the Check card and of fixed lines alone are sentences, or "" where nothing speaks against it.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from core.states import OUT_OF_DATE
from workbench.language import tr
from workbench.reasons import first, why


class Stage(StrEnum):
    """Stage of the scan."""

    NONE = "none"
    LISTING = "listing"
    EMPTY = "empty"
    LIVE = "live"
    RECORDED = "recorded"
    MEASURING = "measuring"
    FAILED = "failed"
    MEASURED = "measured"
    OUTDATED = "outdated"


class WhyNot(StrEnum):
    """Reason why an action is not possible now; "": it is."""

    NOTHING = ""
    LIVE = "live"
    MEASURING = "measuring"
    NOT_MEASURING = "not measuring"
    NO_CAMERA = "no camera"
    NO_PLANES = "no planes"
    NOT_CALIBRATED = "not calibrated"
    NO_SOURCE = "no source"
    LISTING = "listing"
    NO_FRAMES = "no frames"
    ALL_LEFT_OUT = "all left out"
    CHECK_LIVE = "check live"
    NO_BOARDS = "no boards"
    READ_ONLY = "read-only"
    READING_CALIBRATIONS = "reading calibrations"


class Buttons(NamedTuple):
    """Reason for each disabled button, or ""."""

    measure: WhyNot
    cancel: WhyNot
    record: WhyNot
    take_check: WhyNot


class Facts(NamedTuple):
    """Facts from which stage and buttons follow."""

    has_fan: bool
    """The rig has a fan; else boards beside the part stand in for it."""
    boards: bool
    """The rig states boards beside the part."""
    live: bool
    """A scan is being recorded."""
    check_live: bool
    """Pictures of the check are being taken."""
    measuring: bool
    failed: bool
    """The last measurement of the project as it is gave nothing."""
    measured: bool
    """There is a result."""
    outdated: bool
    """It is not what the project would give now."""
    camera: bool
    planes: bool
    """A camera calibration, and laser planes where the rig has a fan, are accepted."""
    calibrations_read: bool
    source: bool
    """A recording is chosen."""
    listed: bool
    """It is known which frames it holds."""
    frames: bool
    """It holds some."""
    counting: bool
    """Some of them are not left out."""
    read_only: bool
    """Nothing can be kept in the project."""


def stage_of(facts: Facts) -> Stage:
    """Derive how far the scan is (`Stage`) from what is known of the recording and the results."""
    if facts.live:
        return Stage.LIVE
    if facts.measuring:
        return Stage.MEASURING
    if facts.failed:
        return Stage.FAILED
    if facts.measured:
        return Stage.OUTDATED if facts.outdated else Stage.MEASURED
    if not facts.source:
        return Stage.NONE
    if not facts.listed:
        return Stage.LISTING
    return Stage.RECORDED if facts.frames else Stage.EMPTY


def disabled_reasons(facts: Facts) -> Buttons:
    """Derive why each button beside the scan is disabled; "" for each that is enabled."""
    cancel = why(not facts.measuring, WhyNot.NOT_MEASURING)
    return Buttons(*map(WhyNot, (_measure(facts), cancel, _record(facts), _take_check(facts))))


def _measure(facts: Facts) -> str:
    return first(
        why(facts.live, WhyNot.LIVE),
        why(facts.measuring, WhyNot.MEASURING),
        why(facts.read_only, WhyNot.READ_ONLY),
        why(not facts.camera, WhyNot.NO_CAMERA),
        why(not facts.planes, WhyNot.NO_PLANES),
        why(not facts.source, WhyNot.NO_SOURCE),
        why(not facts.listed, WhyNot.LISTING),
        why(not facts.frames, WhyNot.NO_FRAMES),
        why(not facts.counting, WhyNot.ALL_LEFT_OUT),
    )


def _record(facts: Facts) -> str:
    return first(
        why(not facts.has_fan and not facts.boards, WhyNot.NO_BOARDS),
        why(not facts.has_fan and not facts.camera, WhyNot.NO_CAMERA),
        why(facts.measuring, WhyNot.MEASURING),
        why(facts.check_live, WhyNot.CHECK_LIVE),
        why(not facts.calibrations_read, WhyNot.READING_CALIBRATIONS),
    )


def _take_check(facts: Facts) -> str:
    return first(
        why(not (facts.camera and facts.planes), WhyNot.NOT_CALIBRATED),
        why(facts.live, WhyNot.LIVE),
        why(not facts.calibrations_read, WhyNot.READING_CALIBRATIONS),
    )


@dataclass(frozen=True, slots=True)
class CheckFacts:
    """Facts from which the buttons of the Check card follow."""

    taking: bool
    """Pictures of the check are being taken."""
    stopping: bool
    """Stop was pressed; the source is not closed yet."""
    cannot_take: str
    """Why none can be taken, apart from these."""
    checking: bool
    cannot_check: str
    cannot_readjust: str
    cannot_compare: str
    moved: bool
    """The check of the pictures in force says that something has changed."""


class CheckButtons(NamedTuple):
    """Reason for each disabled button, or ""; `readjust` is None where it is not shown."""

    take: str
    """Take pictures; Stop while they are being taken."""
    choose: str
    run: str
    """Check; Cancel while it is being checked."""
    compare: str
    readjust: str | None


def check_buttons(facts: CheckFacts) -> CheckButtons:
    """Derive why each button of the interim check is disabled; "" for each that is enabled."""
    taken = tr("Pictures of the check are being taken.") if facts.taking else ""
    cannot_start = "" if facts.taking else facts.cannot_take
    return CheckButtons(
        take=tr("Stopping …") if facts.stopping else cannot_start,
        choose=taken,
        run="" if facts.checking else taken or facts.cannot_check,
        compare=taken or facts.cannot_compare,
        readjust=facts.cannot_readjust if facts.moved and not facts.taking else None,
    )


def why_not_compare(*, comparing: bool, measuring: bool, cannot_write: str, measured: bool, outdated: bool) -> str:
    """Return the reason why a measured length cannot be compared with an artefact; "" if it can."""
    return first(
        why(comparing, tr("An artefact is being compared.")),
        why(measuring, tr("The scan is being measured.")),
        cannot_write,
        why(not measured, tr("Measure the artefact first, like a part.")),
        why(outdated, tr(OUT_OF_DATE["scan"])),
    )
