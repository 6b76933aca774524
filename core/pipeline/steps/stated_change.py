"""How far a rig may have changed when it was checked or measured with, by what rig.toml and its pictures say."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime, timedelta
from typing import NamedTuple

from core.calibrate.change import DEFAULT_STABILITY, Stability
from core.calibrate.drift import KELVINS_WITHIN_DAY, NO_DRIFT, USUAL_KELVINS, Apart, apart, stability_after
from core.calibrate.results import FanCalibration
from core.calibrate.sitting import Acquisition, hours_of_sitting
from core.files.recording.recording_set import RecordingSet
from core.files.recording.rig import Rig
from core.files.recording.set_listing import taken_at
from core.findings.table import note_of
from core.messages import Field, Message

_HOUR = timedelta(hours=1)


class StatedChange(NamedTuple):
    """Stability of a rig since its calibration by what is stated of it, or assumed where it is not."""

    stability: Stability | None
    """None: nothing is stated, and the default will do."""
    assumed: bool
    """Whether a part of it rests on an assumption."""
    since: Apart | None = None
    """How much warmer and later than the calibration it was; None: as re-adjusted on the day."""

    @property
    def known(self) -> Stability | None:
        """Stability of the rig if all of it is stated; None if a part of it is assumed, or nothing is stated."""
        return None if self.assumed else self.stability

    @property
    def guess(self) -> Stability:
        """Stability to begin with where a part of it is assumed; the default where all is stated or nothing is."""
        return self.stability if self.assumed and self.stability is not None else DEFAULT_STABILITY

    def notes(self, rig: Rig, stability: Stability) -> tuple[Message, ...]:
        """Make notes on what is assumed of the rig, given the `stability` that was used; () if nothing is."""
        if self.since is None or (rig.drift == NO_DRIFT and rig.stability is not None):
            return ()
        if rig.drift == NO_DRIFT:
            return (*_warmer(self.since), _not_stated(stability))
        rest = () if rig.stability is not None else (_not_stated(DEFAULT_STABILITY),)
        return (*_said(rig, self.since, stability), *rest)


def change_at_scan(recording_set: RecordingSet, fan: FanCalibration) -> StatedChange:
    """Compute the stability of a rig, stated or assumed, from its calibration until the frames were recorded."""
    when = taken_at(recording_set.frames) if recording_set.frames else None
    return _since_calibration(recording_set, recording_set.rig.air.scanned, when, fan)


class Sitting(NamedTuple):
    """Uninterrupted work in which planes were calibrated and the scan recorded: its hours, and the change meanwhile."""

    hours: float
    """From the first picture of the planes to the last frame."""
    stability: Stability
    """How far the rig may have changed meanwhile."""


def sitting_of(rig: Rig, fan: FanCalibration, scanned: Acquisition | None) -> Sitting | None:
    """Find whether planes were calibrated and frames recorded in one sitting; None if they were not, or not known.

    What had changed before is in the planes' own pictures, as it is in those of a check of the day. `scanned` says by
    which camera and when the frames were taken.
    """
    hours = hours_of_sitting(fan.taken, scanned, rig.validity.fresh_hours)
    if hours is None or fan.readjusted is not None:
        return None
    since = apart(rig.air.calibrated, rig.air.scanned, hours, KELVINS_WITHIN_DAY)
    return Sitting(hours, rig.drift.over(since))


def change_at_check(recording_set: RecordingSet, fan: FanCalibration, when: datetime) -> StatedChange:
    """Compute the stability of a rig, stated or assumed, from its calibration until a check taken at `when`."""
    return _since_calibration(recording_set, recording_set.rig.air.checked, when, fan)


def change_since_check(recording_set: RecordingSet, checked: datetime) -> Stability:
    """Compute how much the rig may have changed from a check on the day to the scan; 0 without stated drift."""
    air = recording_set.rig.air
    hours = 0.0 if not recording_set.frames else (taken_at(recording_set.frames) - checked) / _HOUR
    return recording_set.rig.drift.over(apart(air.checked, air.scanned, hours, KELVINS_WITHIN_DAY))


def notes_since_check(rig: Rig) -> tuple[Message, ...]:
    """Make a note if the warming between a check of the day and the scan is assumed, and matters; else ()."""
    known = rig.air.checked is not None and rig.air.scanned is not None
    if known or not rig.drift.per_kelvin.over_default.any():
        return ()
    return (note_of("scan.kelvins_since_check_assumed", kelvins=KELVINS_WITHIN_DAY),)


def _since_calibration(
    recording_set: RecordingSet, celsius: float | None, when: datetime | None, fan: FanCalibration
) -> StatedChange:
    rig = recording_set.rig
    since = apart(rig.air.calibrated, celsius, _hours(recording_set, when, fan), USUAL_KELVINS)
    stability = stability_after(rig.stability, rig.drift, since)
    guessed = stability is not None and (rig.stability is None or any(_guessed(rig, since)))
    return StatedChange(stability, guessed, since)


def _hours(recording_set: RecordingSet, when: datetime | None, fan: FanCalibration) -> float | None:
    """From the calibration to `when`: the older of camera and planes, or a re-adjustment; None where none can tell."""
    made = [taken_at(there) for paths in (recording_set.camera, [pair.on for pair in recording_set.planes])
            if (there := [path for path in paths if path.exists()])]  # fmt: skip
    if fan.readjusted is not None:
        made = [fan.readjusted.taken_at]
    return None if when is None or not made else abs((when - min(made)) / _HOUR)


def _guessed(rig: Rig, since: Apart) -> Iterator[bool]:
    """Whether kelvins, and hours, are assumed and matter."""
    yield since.kelvins_assumed and bool(rig.drift.per_kelvin.over_default.any())
    yield since.hours_assumed and bool(rig.drift.per_hour.over_default.any())


def _not_stated(size: Stability) -> Message:
    return note_of(
        "scan.stability_assumed", turn_urad=size.turn * 1e6, shift_um=size.shift_mm * 1e3, centre_px=size.centre_px
    )


def _warmer(since: Apart) -> Iterator[Message]:
    """A note where the default is not enough."""
    if not since.kelvins_assumed and since.kelvins > USUAL_KELVINS:
        yield note_of(
            "scan.warmer_than_usual", kelvins=since.kelvins, usual=USUAL_KELVINS, field=Field("[stability] per_kelvin")
        )


def _said(rig: Rig, since: Apart, stability: Stability) -> Iterator[Message]:
    """What is reckoned with, and which of kelvins and hours are assumed."""
    yield note_of(
        "scan.change_by_warmth_and_time",
        kelvins=since.kelvins,
        hours=since.hours,
        turn_urad=stability.turn * 1e6,
        shift_um=stability.shift_mm * 1e3,
        centre_px=stability.centre_px,
    )
    kelvins, hours = _guessed(rig, since)
    if kelvins:
        yield note_of("scan.kelvins_assumed", kelvins=since.kelvins)
    if hours:
        yield note_of("scan.hours_assumed", hours=since.hours)
