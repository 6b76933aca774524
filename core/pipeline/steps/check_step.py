"""Check step: pictures of the plane target in the fan, taken on the day of a measurement → check.json."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from core.calibrate.change import (
    DEFAULT_STABILITY,
    P_TOLD,
    Change,
    Evidence,
    RigSpread,
    Stability,
    agrees,
    changes,
    judge,
    lasting,
    stability_in_use,
)
from core.calibrate.deviations import UNEXPLAINED, Deviation
from core.calibrate.drift import NO_DRIFT, widened_evidence
from core.calibrate.fan.interim_check import CheckedPose, check_poses, step_errors
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration
from core.calibrate.rig_spread import log_likelihoods, stability_by_pictures
from core.calibrate.sitting import Acquisition
from core.errors import InputError
from core.files.reading import file_hash
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import CHECK, RecordingSet
from core.files.recording.rig import require_tables
from core.files.recording.set_listing import taken_at
from core.files.results.check_file import CheckedLine, CheckedPicture, InterimCheck, write_check
from core.files.results.rig_history import PastCheck, store_check
from core.findings.table import note_of
from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.pipeline.steps.kept_features import poses_once
from core.pipeline.steps.planes_step import measure_poses
from core.pipeline.steps.stated_change import (
    StatedChange,
    change_at_check,
    change_at_scan,
    change_since_check,
    notes_since_check,
    sitting_of,
)
from core.pipeline.steps.validity import history_name, history_of, stated_validity
from core.pipeline.steps.workspace import Calibration, Workspace
from core.progress import Progress, silent
from core.scan.known_planes.plane_deviations import followed_by_planes
from core.second_process import SecondProcess

SAME_DAY = 1.0
"""Days within which a check says something of a scan."""
LEAVES_MUCH = 1.2
"""A check leaves much open that leaves a step so many times as uncertain as the calibrations by themselves."""
STEP_MM = 50.0
"""Height of the step whose error is told where no nominal thickness is stated."""


def check_step(
    work: Workspace,
    stripe: StripeSettings | None = None,
    progress: Progress = silent,
    celsius: float | None = None,
    poses: Sequence[PoseFeatures] | None = None,
) -> InterimCheck:
    """Check the calibrations in camera.json and planes.json by the pictures in SET/check, and write check.json.

    The check goes into the rig's history, with the temperature of the air if it is known. `stripe` are width and
    contrast of the stripes on the plane target, if they are stated; `poses` are what `measure_check` has found, if it
    was asked before.

    Raises
    ------
    InputError
        If a calibration is missing or wrong, or no picture shows target and stripes.
    """
    recording_set = work.recording_set
    require_tables(recording_set.rig, recording_set.rig_file, "laser_fan")
    if not recording_set.check:
        raise InputError(
            Message("check.no_pictures", "there are no pictures of an interim check"),
            where=recording_set.where(CHECK)
            if CHECK in recording_set.folders
            else recording_set.rig_file.parent / CHECK,
            todo=Message("advice.record_check", "hold the plane target into the fan and record one to three pictures"),
        )
    calibration = work.calibration()
    camera, fan = calibration.camera.camera, calibration.fan
    recording_set = fresh_check(recording_set, calibration.fan)
    if celsius is not None:
        recording_set = replace(
            recording_set, rig=replace(recording_set.rig, air=replace(recording_set.rig.air, checked=celsius))
        )
    if not recording_set.check:
        raise InputError(
            Message(
                "check.made_readjustment",
                "camera and fan were re-adjusted by these very pictures: they are no check of it",
            ),
            where=work.recording_set.where(CHECK),
            todo=Message("advice.record_check_anew", "record one to three new pictures"),
        )
    with work.step("check") as log:
        pictures = log.pictures.of(recording_set)
        seen = measure_check(pictures, camera, stripe, progress, kept=work.kept) if poses is None else poses
        deviations, evidence, checked, change = judged(recording_set, calibration, seen)
        reasons = [pose.located.reason for pose in checked if pose.located.reason is not None]
        if len(reasons) == len(checked) and not any(pose.misses_fan for pose in checked):
            raise InputError(
                Message("check.nothing_seen", "no picture shows target and stripes: {reason}", reason=reasons[0]),
                where=recording_set.where(CHECK),
                todo=Message("check.advice", "hold the target where all lines meet it; else calibrate again"),
            )
        nominal = None if recording_set.rig.gauge is None else recording_set.rig.gauge.nominal_mm
        paths = check_paths(recording_set)
        check = InterimCheck(
            calibration.id, pictures.id_of(paths), taken_at(paths), change.p, tuple(map(_told, checked)),
            nominal or STEP_MM,
        )  # fmt: skip
        celsius = recording_set.rig.air.checked
        past, spread = PastCheck.of(check, celsius), charted_spread(recording_set, calibration, check.taken_at)
        stated = change_at_check(recording_set, calibration.fan, check.taken_at)
        sees: _OfStep | None = None
        if check.used:
            by = step_errors(checked, camera, fan.fan, deviations, check.step_mm)
            sees = _OfStep(by, deviations, evidence)
            likelihoods = tuple(map(float, log_likelihoods(deviations, evidence)))
            by_default = sees.told(check, DEFAULT_STABILITY).stated_mm
            # what a history says must not rest on what it has said before
            past = PastCheck.of(
                sees.told(check, stability_in_use(stated.stability, None)[0]), celsius, likelihoods, by_default
            )
            check = sees.told(check, stability_in_use(stated.stability, spread)[0])
        log.notes.append(check.sentence)
        log.notes.extend(() if sees is None else sees.notes_on_what_is_open(check))
        log.notes.extend(_kept(recording_set, past))
        log.notes.extend(() if spread is None else (_charted(spread, recording_set),))
        log.notes.extend(stated_validity(recording_set.rig))
        log.notes.extend(change.left_out)
        log.notes.extend(note for pose in checked for note in pose.located.features.notes)
        write_check(log.path("check"), check)
    return check


class _OfStep(NamedTuple):
    """What a check sees of a step: its errors by the deviations, and what the pictures say of these."""

    by: Array
    deviations: Sequence[Deviation]
    evidence: Evidence

    def told(self, check: InterimCheck, stability: Stability) -> InterimCheck:
        """The check with its errors of a step, for a rig of this stability."""
        estimate, covariance = lasting(self.deviations, self.evidence, stability)
        of_changes = self.by[[one.source == "change" for one in self.deviations]]
        return replace(
            check,
            error_mm=float(-self.by @ estimate),
            unseen_mm=2 * float(np.sqrt(self.by @ covariance @ self.by)),
            stated_mm=float(np.linalg.norm(of_changes * stability.over_default)),
        )

    def notes_on_what_is_open(self, check: InterimCheck) -> tuple[Message, ...]:
        """A note if the check excludes so little that U stays much larger than the calibrations alone make it."""
        lasts = [one.source not in ("change", UNEXPLAINED) for one in self.deviations]
        calibrations = 2 * float(np.linalg.norm(self.by[lasts]))
        if not calibrations or check.unseen_mm <= LEAVES_MUCH * calibrations:
            return ()
        return (
            note_of(
                "check.leaves_much", step_mm=check.step_mm, unseen_mm=check.unseen_mm, calibrations_mm=calibrations
            ),
        )


def check_paths(recording_set: RecordingSet) -> list[Path]:
    """List the paths of the pictures of a set's interim check."""
    return recording_set.pictures_of(recording_set.check)


def fresh_check(recording_set: RecordingSet, fan: FanCalibration) -> RecordingSet:
    """Remove from a set those pictures of its interim check that camera and fan were already re-adjusted by.

    They cannot check what was made with them, and are known again by their content. Without a fan no picture is left:
    there are no light planes to be where they were.
    """
    if not fan.fan.lines:
        return replace(recording_set, check=())
    used: set[str] = set()
    known = fan.readjusted
    while known is not None:
        used |= set(known.hashes.values())
        known = known.before
    if not used:
        return recording_set
    return replace(recording_set, check=tuple(pair for pair in recording_set.check if file_hash(pair.on) not in used))


def _kept(recording_set: RecordingSet, past: PastCheck) -> tuple[Message, ...]:
    """Keep a check in the rig's history; what that says of it, or why it could not be kept."""
    try:
        history = store_check(history_name(recording_set.rig, past.calibration_id), past)
    except InputError as error:
        return (Message("check.not_kept", "The check is not in the rig's history: {reason}", reason=error.message),)
    outside = history.beyond(past)
    return () if outside is None else (outside,)


def since_calibration(
    recording_set: RecordingSet,
    calibration: Calibration,
    check: Sequence[PoseFeatures],
    scanned: Acquisition | None,
    of_measured: Callable[[Sequence[Deviation]], Evidence] | None = None,
    *,
    by_planes: bool = False,
) -> Change:
    """Estimate how camera and fan may have changed from calibration to scan, as far as no picture excludes it.

    Parameters
    ----------
    recording_set, calibration
        The set that is measured.
    check
        The poses of its interim check, as `check_of_the_day` gives them; those of another day say nothing.
    scanned
        By which camera and when the frames were taken; None: not known.
    of_measured
        What the pictures that are measured say of deviations; None: nothing.
    by_planes
        Whether known planes in the scan show that camera and fan are as calibrated: a passed check of that hour.
    """
    fresh = fresh_check(recording_set, calibration.fan)
    apart = _days_apart(fresh)
    unused: tuple[Message, ...] = ()
    if recording_set.check and not calibration.fan.fan.lines:
        unused = (note_of("check.without_fan"),)
    elif apart > SAME_DAY:
        fresh, unused = replace(fresh, check=()), (note_of("check.another_day", days=apart),)
    change = judged(fresh, calibration, check, of_measured, at_scan=True, scanned=scanned, by_planes=by_planes).change
    return replace(change, left_out=(*unused, *change.left_out))


def _days_apart(recording_set: RecordingSet) -> float:
    """Days between the pictures of the check and those measured; 0 where one of them is missing."""
    if not recording_set.check or not recording_set.frames:
        return 0.0
    apart = taken_at([pair.on for pair in recording_set.check]) - taken_at(recording_set.frames)
    return abs(apart.total_seconds()) / 86_400.0


def _stated(recording_set: RecordingSet, fan: FanCalibration) -> StatedChange:
    """How far the rig may have changed since its calibration, or since a re-adjustment.

    On the day of its pictures a re-adjustment is what a check is: they show the rig as it was in the scan, but for what
    warmth and time have changed since.
    """
    if fan.readjusted is not None and not recording_set.check and _readjusted_on_the_day(recording_set, fan):
        return StatedChange(change_since_check(recording_set, fan.readjusted.taken_at), assumed=False)
    return change_at_scan(recording_set, fan)


def _readjusted_on_the_day(recording_set: RecordingSet, fan: FanCalibration) -> bool:
    if fan.readjusted is None or not recording_set.frames:
        return False
    apart = abs(taken_at(recording_set.frames) - fan.readjusted.taken_at).total_seconds() / 86_400.0
    return apart <= SAME_DAY


def checked_on_the_day(recording_set: RecordingSet, fan: FanCalibration) -> bool:
    """Whether pictures show the rig on the day of the scan: of an interim check, or of its re-adjustment."""
    fresh = fresh_check(recording_set, fan)
    return _days_apart(fresh) <= SAME_DAY if fresh.check else _readjusted_on_the_day(recording_set, fan)


def charted_spread(
    recording_set: RecordingSet, calibration: Calibration, when: datetime | None = None
) -> RigSpread | None:
    """Estimate from a rig's history of checks before `when` how much it changes; None where that tells too little.

    Without `when` it is for the scan's frames, and None where there are none.
    """
    if when is None and not recording_set.frames:
        return None
    fan = calibration.fan
    stated = (_stated(recording_set, fan) if when is None else change_at_check(recording_set, fan, when)).stability
    try:
        history = history_of(recording_set.rig, calibration.id)
        return history.spread(calibration.id, when or taken_at(recording_set.frames), stated)
    except InputError:
        return None  # facts_of_the_day tells that it cannot be read


class Judged(NamedTuple):
    """Judgement of how camera and fan have changed since their calibration, and what it rests on."""

    deviations: tuple[Deviation, ...]
    """Those that are reckoned with."""
    evidence: Evidence
    """What all pictures say of them."""
    poses: tuple[CheckedPose, ...]
    """Those of the interim check."""
    change: Change


def judged(
    recording_set: RecordingSet,
    calibration: Calibration,
    check: Sequence[PoseFeatures],
    of_measured: Callable[[Sequence[Deviation]], Evidence] | None = None,
    *,
    at_scan: bool = False,
    scanned: Acquisition | None = None,
    by_planes: bool = False,
) -> Judged:
    """Judge how camera and fan have changed since calibration, by the poses of an interim `check` and by the scan.

    When the check was taken, or `at_scan`, when the frames were; `scanned` says by which camera and when these were
    taken, None where it is not known. `of_measured` says how well deviations agree with the scan, `by_planes` whether
    known planes in it show that camera and fan are as calibrated.
    """
    camera, fan, control = calibration.camera.camera, calibration.fan, calibration.control
    deviations = (
        *calibration.deviations,
        *followed_by_planes(changes(camera, fan.fan), camera, control, fan.scale_sd),
    )
    evidence = Evidence.none(len(deviations)) if of_measured is None else of_measured(deviations)
    checked: tuple[CheckedPose, ...] = ()
    agree = by_planes or _readjusted_on_the_day(recording_set, calibration.fan)
    if recording_set.check:
        names = {pair.name for pair in recording_set.check}
        seen = tuple(pose for pose in check if pose.name in names)
        checked, of_check = check_poses(seen, camera, fan, deviations)
        agree = agrees(deviations, of_check)
        if at_scan:
            of_check = widened_evidence(
                of_check, deviations, change_since_check(recording_set, taken_at(check_paths(recording_set)))
            )
        evidence += of_check
    stated = _stated(recording_set, fan)
    sitting = sitting_of(recording_set.rig, fan, scanned) if at_scan and not recording_set.check else None
    if sitting is not None:
        change = judge(camera, fan.fan, deviations, evidence, sitting.stability, planes=control.plane_pis)
    if sitting is not None and change.p >= P_TOLD:
        change = replace(change, checked=True, sitting_hours=sitting.hours)
    else:  # frames that show a change since the planes' calibration are not of its sitting, whatever their log says
        change = judge(
            camera,
            fan.fan,
            deviations,
            evidence,
            stated.known,
            charted_spread(recording_set, calibration),
            stated.guess if agree else stability_by_pictures(deviations, evidence, stated.guess),
            control.plane_pis,
        )
        change = replace(change, checked=agree)
    reasons = [(one.located.features.name, one.located.reason) for one in checked if one.located.reason is not None]
    if any(pose.misses_fan for pose in checked):
        change = replace(change, p=0.0, times=math.inf)
    left_out = (note_of("check.pose_left_out", pose=pose, reason=reason) for pose, reason in reasons)
    return Judged(deviations, evidence, checked, replace(change, left_out=tuple(left_out)))


def assumed_stability(recording_set: RecordingSet, change: Change, fan: FanCalibration) -> tuple[Message, ...]:
    """Make notes on what is assumed of a rig's stability: where not all is stated, or its history of checks is used."""
    if change.sitting_hours is not None:
        kelvins = notes_since_check(recording_set.rig)
        return (note_of("scan.calibrated_in_this_sitting", hours=change.sitting_hours), *kelvins)
    if change.spread is not None:
        return (_charted(change.spread, recording_set),)
    since_check = notes_since_check(recording_set.rig) if checked_on_the_day(recording_set, fan) else ()
    return (*_stated(recording_set, fan).notes(recording_set.rig, change.stability), *since_check)


def _charted(spread: RigSpread, recording_set: RecordingSet) -> Message:
    """What the history of the rig's checks says of how much it changes."""
    stated = recording_set.rig.stability is not None or recording_set.rig.drift != NO_DRIFT
    return note_of(
        "scan.stability_more_than_stated" if stated else "scan.stability_charted",
        times=spread.factor,
        days=spread.days,
        first=spread.first.astimezone(),
        last=spread.last.astimezone(),
    )


def check_of_the_day(
    pictures: PictureReader,
    calibration: Calibration,
    stripe: StripeSettings | None = None,
    progress: Progress = silent,
    kept: Path | None = None,
) -> tuple[PoseFeatures, ...]:
    """Measure the poses of the interim check; () if it has no pictures from the day of the scan.

    They are looked for in the folder `kept` first, as by `measure_check`.

    Raises
    ------
    InputError
        If their pictures have another size than the camera's.
    """
    fresh = fresh_check(pictures.recording_set, calibration.fan)
    if not fresh.check or _days_apart(fresh) > SAME_DAY:
        return ()
    return measure_check(pictures.of(fresh), calibration.camera.camera, stripe, progress, kept=kept)


def measure_check(
    pictures: PictureReader,
    camera: Camera,
    stripe: StripeSettings | None = None,
    progress: Progress = silent,
    beside: SecondProcess | None = None,
    kept: Path | None = None,
) -> tuple[PoseFeatures, ...]:
    """Find plane target and stripes in every pose of the interim check; the process `beside` takes a share.

    Those in the folder `kept` are taken if they are of these very pictures; else they are kept there.

    Raises
    ------
    InputError
        If their pictures have another size than the camera's.
    """
    checked = replace(pictures.recording_set, planes=pictures.recording_set.check)
    reader = pictures.of(checked)
    measure = partial(measure_poses, reader, camera, progress, stripe, beside)
    return poses_once(kept, reader, camera, stripe, measure, progress)


def _told(pose: CheckedPose) -> CheckedPicture:
    """One pose as it is kept."""
    offsets = zip(pose.located.stripes, pose.offset_mm, pose.offset_px, pose.sd_mm, strict=True)
    lines = (CheckedLine(line + 1, float(mm), float(px), float(sd)) for line, mm, px, sd in offsets)
    return CheckedPicture(pose.located.features.name, pose.located.reason, tuple(lines))
