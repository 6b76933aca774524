"""Whether calibration and check held when a part was measured: by `[validity]` in rig.toml and the rig's history."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import datetime, timedelta

from core.calibrate.board_shape import LARGEST_SCALE_SD
from core.calibrate.results import Readjustment
from core.errors import InputError
from core.files.recording.recording_set import RecordingSet
from core.files.recording.rig import Rig
from core.files.recording.set_listing import taken_at
from core.files.results.rig_history import PastCheck, RigHistory, read_history
from core.files.results.run_file import RunRecord
from core.findings.proof import Doubt, ScanFacts
from core.findings.table import note_of
from core.messages import Message
from core.pipeline.steps.target_sizes import with_known_size
from core.pipeline.steps.workspace import Calibration, Workspace

_DAY_S = 86_400.0
"""Seconds of a day."""
_WORST_FIRST = ("failed", "doubtful", "passed")


def history_name(rig: Rig, calibration_id: str) -> str:
    """Return the name of a rig's history of checks: the rig's name, else the id of its calibration."""
    return rig.name or calibration_id


def history_of(rig: Rig, calibration_id: str) -> RigHistory:
    """Read the history of all checks of a rig; InputError if the file is damaged."""
    return read_history(history_name(rig, calibration_id))


def facts_of_the_day(work: Workspace, calibration: Calibration, *, checked: bool = False) -> ScanFacts:
    """Collect the facts, of calibrations and checks, that decide whether results of this recording prove conformity.

    The check nearest in time counts, before the recording or after it. `checked`: known planes in the scan have passed;
    that stands in for a check by pictures that is missing or has lapsed. It lifts none that failed, nor an artefact's:
    fan and boards may share an error of size, which an artefact shows and they do not. What is not stated has no limit.
    That the target's points lie off alike in all poses counts no more once U contains what an artefact has left
    possible.
    """
    recording_set, fan = work.recording_set, calibration.fan
    when = taken_at(recording_set.frames)
    facts = facts_of_calibration(calibration)
    try:
        checks = history_of(recording_set.rig, calibration.id).of_calibration(calibration.id)
    except InputError as error:
        unreadable = note_of("validity.history_unreadable", reason=error.message)
        return replace(facts, of_the_day=(Doubt.of(unreadable),))
    if fan.readjusted is not None:
        checks = (*checks, _as_check(fan.readjusted, calibration.id))
    nearest = _nearest(checks, when)
    if nearest is not None and nearest.verdict == "failed":
        failed = note_of("validity.check_failed", date=nearest.taken_at.astimezone())
        return replace(facts, of_the_day=(Doubt.of(failed),))
    stood_in = checked and not (nearest is not None and nearest.artefact)
    lapsed = (
        _calibration_lapsed(recording_set, work.record(), when),
        None if stood_in else _check_lapsed(recording_set.rig, nearest, when),
    )
    artefact = _passed_artefact(recording_set.rig, checks, when)
    if artefact is not None and _left_possible(artefact) <= fan.scale_sd:
        facts = replace(facts, points_off_alike=False)
    return replace(facts, of_the_day=tuple(Doubt.of(why) for why in lapsed if why is not None))


def facts_of_calibration(calibration: Calibration) -> ScanFacts:
    """Collect the facts of the calibrations that decide whether results measured with them prove conformity."""
    camera, fan = calibration.camera, calibration.fan
    return ScanFacts(
        camera_unsettled=None if camera.converged is None else not camera.converged,
        planes_unsettled=None if fan.converged is None else not fan.converged,
        points_off_alike=fan.points_off_alike,
        size_unconfirmed=fan.scale_assumed,
    )


def with_size_by_artefact(work: Workspace, calibration: Calibration) -> Calibration:
    """Reduce the uncertainty of the plane target's size as far as a measured artefact has confirmed it.

    That is one whose size is not stated, or whose points lie off alike in all poses. The artefact measured nearest in
    time counts, if it passed and that is no longer ago than `[validity]` lets a check hold. The size is then uncertain
    by what that leaves possible: a short artefact says less of a long part. A re-adjusted fan keeps the uncertainty it
    was re-adjusted with, and is confirmed only by an artefact that says as much.
    """
    fan = calibration.fan
    if fan.scale_assumed is False and fan.points_off_alike is False:
        return calibration
    when = taken_at(work.recording_set.frames)
    try:
        checks = history_of(work.recording_set.rig, calibration.id).of_calibration(calibration.id)
    except InputError:
        return calibration  # facts_of_the_day tells that it cannot be read
    nearest = _passed_artefact(work.recording_set.rig, checks, when)
    if nearest is None:
        return calibration
    left = _left_possible(nearest)
    if left > (fan.scale_sd if fan.readjusted is not None else LARGEST_SCALE_SD):
        return calibration
    return replace(
        calibration, fan=with_known_size(fan, max(fan.scale_sd, left) if fan.scale_assumed is False else left)
    )


def _left_possible(check: PastCheck) -> float:
    """Standard uncertainty of all lengths, as a share, after an artefact has passed.

    By the error found, which nothing corrects, and by how sure that is.
    """
    return math.hypot(check.error_mm, check.unseen_mm / 2) / check.step_mm


def _passed_artefact(rig: Rig, checks: Sequence[PastCheck], when: datetime) -> PastCheck | None:
    """The artefact measured nearest in time to `when`, if it passed no longer ago than a check holds."""
    artefacts = [check for check in checks if check.artefact]
    nearest = _nearest(artefacts, when)
    if nearest is None or nearest.verdict != "passed":
        return None
    holds = rig.validity.check_days is None or abs(_days(when, nearest.taken_at)) <= rig.validity.check_days
    return nearest if holds else None


def _nearest(checks: Sequence[PastCheck], when: datetime) -> PastCheck | None:
    """The check nearest in time.

    Of several lengths of one scan it is the one that failed, and of those that passed the longest, which says most.
    """
    return min(
        checks,
        key=lambda check: (abs(check.taken_at - when), _WORST_FIRST.index(check.verdict), -check.step_mm),
        default=None,
    )


def _as_check(known: Readjustment, calibration_id: str) -> PastCheck:
    """A re-adjustment, which lapses as a check does."""
    return PastCheck(known.taken_at, calibration_id, known.pictures_id, "passed", known.p_after, 1.0)


def stated_validity(rig: Rig) -> tuple[Message, ...]:
    """Make a note where no limit is stated of how long a calibration or a check holds; () if both are."""
    if rig.validity.calibration_days is not None and rig.validity.check_days is not None:
        return ()
    return (note_of("validity.not_stated"),)


def _calibration_lapsed(recording_set: RecordingSet, record: RunRecord, when: datetime) -> Message | None:
    days = recording_set.rig.validity.calibration_days
    if days is None:
        return None
    made = list(_made(recording_set, record))
    if not made:
        return note_of("validity.calibration_undated", days=days)
    age = _days(when, min(made))
    if age <= days:
        return None
    return note_of("validity.calibration_lapsed", n=math.ceil(age), days=days)


def _check_lapsed(rig: Rig, nearest: PastCheck | None, when: datetime) -> Message | None:
    days = rig.validity.check_days
    if days is None or (nearest is not None and abs(_days(when, nearest.taken_at)) <= days):
        return None
    if nearest is None:
        return note_of("validity.never_checked", days=days)
    return note_of("validity.check_lapsed", date=nearest.taken_at.astimezone(), days=days)


def _made(recording_set: RecordingSet, record: RunRecord) -> Iterator[datetime]:
    """When the camera and the laser planes were calibrated, by their pictures or by the run, whichever is older."""
    pictures = {"camera": recording_set.camera, "planes": tuple(pair.on for pair in recording_set.planes)}
    for step, paths in pictures.items():
        known = [record.made_at[step]] if step in record.made_at else []
        if there := [path for path in paths if path.exists()]:
            known.append(taken_at(there))
        if known:
            yield min(known)


def _days(later: datetime, earlier: datetime) -> float:
    return (later - earlier) / timedelta(seconds=_DAY_S)
