"""Check step: pictures of the plane target in the fan, taken on the day of a measurement → check.json."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.calibrate.change import (
    DEFAULT_STABILITY,
    PROVES_NOTHING,
    TOLD,
    Change,
    Evidence,
    changes,
    judge,
    lasting,
)
from core.calibrate.deviations import Deviation, calibration_deviations
from core.calibrate.fan.interim_check import ELSEWHERE, CheckedPose, check_poses, step_errors
from core.calibrate.fan.pose_features import PoseFeatures
from core.errors import InputError
from core.files.json_text import write_json
from core.files.recording.options import Options
from core.files.recording.recording_set import CHECK, RecordingSet
from core.messages import Message, as_json
from core.model import Camera
from core.pipeline.steps.planes_step import measure_poses
from core.pipeline.steps.workspace import Calibration, Workspace
from core.progress import Progress, silent

STEP_MM = 50.0
"""Height of the step whose error is told where no nominal thickness is stated."""


@dataclass(frozen=True, eq=False, slots=True)
class InterimCheck:
    """Result of an interim check.

    Parameters
    ----------
    poses
        What each pose showed.
    change
        What all of them say of camera and laser together.
    step_mm
        Height of the step that the errors are told for.
    error_mm
        By how much the camera and the laser as they are now would measure such a step too high with the calibrations.
    unseen_mm
        Expanded uncertainty (k = 2) of that: an error this large could have been overlooked.
    """

    poses: tuple[CheckedPose, ...]
    change: Change
    step_mm: float
    error_mm: float
    unseen_mm: float

    @property
    def passed(self) -> bool:
        """Whether the pictures agree with the calibrations."""
        return self.change.p >= TOLD

    @property
    def offset_px(self) -> float:
        """RMS distance in pixels of the stripes from where the calibrations have them."""
        return float(np.sqrt(np.mean(np.concatenate([pose.offset_px for pose in self.poses]) ** 2)))

    @property
    def offset_mm(self) -> float:
        """The same in mm on the target."""
        return float(np.sqrt(np.mean(np.concatenate([pose.offset_mm for pose in self.poses]) ** 2)))

    @property
    def sentence(self) -> Message:
        """What came of it, and what to do."""
        values = {"offset_px": self.offset_px, "offset_mm": self.offset_mm, "p": self.change.p}
        if self.passed:
            return Message(
                "check.passed",
                "Camera and laser are where they were calibrated: the stripes are off by {offset_px:.2f} px, "
                "{offset_mm:.3f} mm, as noise and calibration let one expect.",
                **values,
            )
        if self.change.p >= PROVES_NOTHING:
            return Message(
                "check.doubtful",
                "Camera or laser may have changed: the stripes are off by {offset_px:.2f} px, {offset_mm:.3f} mm "
                "(probability that it is chance: {p:.1g}); check again, and calibrate if it stays.",
                **values,
            )
        return Message(
            "check.failed",
            "Camera or laser have changed since they were calibrated: the stripes are off by {offset_px:.2f} px, "
            "{offset_mm:.3f} mm (probability that it is chance: {p:.1g}); calibrate again.",
            **values,
        )


def check_step(work: Workspace, options: Options | None = None, progress: Progress = silent) -> InterimCheck:
    """Check the calibrations in camera.json and planes.json by the pictures in SET/check, and write check.json.

    Raises
    ------
    InputError
        If a calibration is missing or wrong, or no picture shows target and stripes.
    """
    options = options or Options()
    found = work.found
    if not found.check:
        raise InputError(
            Message("check.no_pictures", "there are no pictures of an interim check"),
            where=found.where(CHECK) if CHECK in found.folders else found.rig_file.parent / CHECK,
            todo=Message("advice.record_check", "hold the plane target into the fan and record one to three pictures"),
        )
    calibration = work.calibration()
    camera, fan = calibration.camera.camera, calibration.fan
    with work.step("check") as log:
        deviations, evidence, checked, change = _judged(found, calibration, options, progress)
        if not any(pose.located.used for pose in checked):
            reasons = [pose.located.reason for pose in checked if pose.located.reason is not None]
            raise InputError(
                Message("check.nothing_seen", "no picture shows target and stripes: {reason}", reason=reasons[0]),
                where=found.where(CHECK),
                todo=Message("check.advice", "hold the target where all lines meet it; else calibrate again"),
            )
        nominal = None if found.rig.gauge is None else found.rig.gauge.nominal_mm
        step = nominal or STEP_MM
        by = step_errors(checked, camera, fan.fan, deviations, step)
        estimate, covariance = lasting(deviations, evidence, found.rig.stability or DEFAULT_STABILITY)
        check = InterimCheck(checked, change, step, float(-by @ estimate), 2 * float(np.sqrt(by @ covariance @ by)))
        log.notes.append(check.sentence)
        log.notes.extend(note for pose in checked for note in pose.located.features.notes)
        write_json(work.path("check"), _values(check, calibration.id))
    return check


def since_calibration(
    found: RecordingSet,
    calibration: Calibration,
    options: Options,
    progress: Progress = silent,
    of_measured: Callable[[Sequence[Deviation]], Evidence] | None = None,
) -> Change:
    """What may have changed since the calibration, as far as no picture excludes it.

    Parameters
    ----------
    found, calibration, options, progress
        The pictures, with those of an interim check if there are any, and how they are looked at.
    of_measured
        What the pictures that are measured say of deviations; None: nothing.

    Raises
    ------
    InputError
        If the check's pictures have another size than the camera's.
    """
    return _judged(found, calibration, options, progress, of_measured)[-1]


def _judged(
    found: RecordingSet,
    calibration: Calibration,
    options: Options,
    progress: Progress,
    of_measured: Callable[[Sequence[Deviation]], Evidence] | None = None,
) -> tuple[tuple[Deviation, ...], Evidence, tuple[CheckedPose, ...], Change]:
    """The deviations reckoned with, what all pictures say of them, the check's poses, and what that proves."""
    camera, fan = calibration.camera.camera, calibration.fan
    deviations = (*calibration_deviations(calibration.camera, fan), *changes(camera, fan.fan))
    evidence = Evidence.none(len(deviations)) if of_measured is None else of_measured(deviations)
    checked: tuple[CheckedPose, ...] = ()
    if found.check:
        checked, of_check = check_poses(measure_check(found, camera, options, progress), camera, fan, deviations)
        evidence += of_check
    change = judge(camera, fan.fan, deviations, evidence, found.rig.stability or DEFAULT_STABILITY)
    reasons = [(one.located.features.name, one.located.reason) for one in checked if one.located.reason is not None]
    if any(reason.code == ELSEWHERE for _, reason in reasons):
        change = replace(change, p=0.0, times=math.inf)
    left_out = (
        Message("check.pose_left_out", "Picture {pose} of the check says nothing: {reason}.", pose=pose, reason=reason)
        for pose, reason in reasons
    )
    return deviations, evidence, checked, replace(change, left_out=tuple(left_out))


def assumed_stability(found: RecordingSet) -> tuple[Message, ...]:
    """A note on what is assumed of a rig of which nothing is stated."""
    if found.rig.stability is not None:
        return ()
    size = DEFAULT_STABILITY
    return (
        Message(
            "scan.stability_assumed",
            "How far the rig may have changed since its calibration is not stated ([stability] in rig.toml); assumed "
            "are standard uncertainties of {turn_urad:.0f} µrad, {shift_um:.0f} µm and {centre_px:g} px.",
            turn_urad=size.turn * 1e6,
            shift_um=size.shift_mm * 1e3,
            centre_px=size.centre_px,
        ),
    )


def measure_check(
    found: RecordingSet, camera: Camera, options: Options, progress: Progress = silent
) -> tuple[PoseFeatures, ...]:
    """Target and stripes of every pose of the interim check.

    Raises
    ------
    InputError
        If their pictures have another size than the camera's.
    """
    return measure_poses(replace(found, planes=found.check), camera, progress, options.plane_stripe)


def _values(check: InterimCheck, calibration_id: str) -> dict[str, object]:
    return {
        "calibration_id": calibration_id,
        "passed": check.passed,
        "p": check.change.p,
        "offset_px": check.offset_px,
        "offset_mm": check.offset_mm,
        "step_mm": check.step_mm,
        "error_mm": check.error_mm,
        "unseen_mm": check.unseen_mm,
        "sentence": as_json(check.sentence),
        "poses": [
            {
                "name": pose.located.features.name,
                "reason": None if pose.located.reason is None else as_json(pose.located.reason),
                "lines": [
                    {"line": line + 1, "offset_mm": float(mm), "offset_px": float(px), "sd_mm": float(sd)}
                    for line, mm, px, sd in zip(
                        pose.located.stripes, pose.offset_mm, pose.offset_px, pose.sd_mm, strict=True
                    )
                ],
            }
            for pose in check.poses
        ],
    }
