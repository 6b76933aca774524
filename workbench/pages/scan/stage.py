"""How far the scan is and what can be done, told by plain facts."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple


class Stage(StrEnum):
    """How far the scan is."""

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
    """Why something cannot be done now; nothing: it can."""

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
    READ_ONLY = "read-only"
    READING_CALIBRATIONS = "reading calibrations"


class Buttons(NamedTuple):
    """Why each button is grey."""

    measure: WhyNot
    cancel: WhyNot
    record: WhyNot
    take_check: WhyNot


class Facts(NamedTuple):
    """What the stage rests on."""

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
    """A camera calibration, and laser planes, are accepted."""
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
    """How far it is."""
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


def buttons_of(facts: Facts) -> Buttons:
    """What can be done."""
    cancel = WhyNot.NOTHING if facts.measuring else WhyNot.NOT_MEASURING
    return Buttons(_measure(facts), cancel, _record(facts), _take_check(facts))


def _measure(facts: Facts) -> WhyNot:
    reasons = (
        (facts.live, WhyNot.LIVE),
        (facts.measuring, WhyNot.MEASURING),
        (facts.read_only, WhyNot.READ_ONLY),
        (not facts.camera, WhyNot.NO_CAMERA),
        (not facts.planes, WhyNot.NO_PLANES),
        (not facts.source, WhyNot.NO_SOURCE),
        (not facts.listed, WhyNot.LISTING),
        (not facts.frames, WhyNot.NO_FRAMES),
        (not facts.counting, WhyNot.ALL_LEFT_OUT),
    )
    return next((why for true, why in reasons if true), WhyNot.NOTHING)


def _record(facts: Facts) -> WhyNot:
    if facts.measuring:
        return WhyNot.MEASURING
    if facts.check_live:
        return WhyNot.CHECK_LIVE
    return WhyNot.NOTHING if facts.calibrations_read else WhyNot.READING_CALIBRATIONS


def _take_check(facts: Facts) -> WhyNot:
    if not (facts.camera and facts.planes):
        return WhyNot.NOT_CALIBRATED
    if facts.live:
        return WhyNot.LIVE
    return WhyNot.NOTHING if facts.calibrations_read else WhyNot.READING_CALIBRATIONS
