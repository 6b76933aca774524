"""Re-adjust step: camera and fan moved by the pictures of a check, on request → planes.json, planes-calibrated.json."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

import numpy as np

from core.calibrate.change import Stability
from core.calibrate.deviations import Deviation, calibration_deviations
from core.calibrate.fan.interim_check import check_poses, step_errors
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.readjustment import CheckPictures, nothing_changed, readjusted
from core.calibrate.results import ProposedReadjustment
from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.reading import file_hash, read_bytes
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import CHECK, RecordingSet
from core.files.recording.rig import require_tables
from core.files.recording.set_listing import taken_at
from core.files.results.camera_file import read_camera
from core.files.results.planes_file import write_planes
from core.files.step_graph import READJUST
from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.model.arrays import Array
from core.pipeline.steps.check_step import STEP_MM, charted_spread, check_paths, fresh_check, judged, measure_check
from core.pipeline.steps.stated_change import change_at_check
from core.pipeline.steps.workspace import Calibration, Workspace
from core.progress import Progress, silent


def propose_readjustment(
    pictures: PictureReader,
    calibration: Calibration,
    stripe: StripeSettings | None = None,
    progress: Progress = silent,
    poses: Sequence[PoseFeatures] | None = None,
) -> ProposedReadjustment:
    """Compute how camera and fan would be re-adjusted by the pictures of the interim check; nothing is written.

    `stripe` and `poses` are as `core.pipeline.steps.check_step.check_step` has them.

    Raises
    ------
    InputError
        If there is no check that was not used for it already, or `core.calibrate.readjustment.readjusted` refuses.
    """
    require_tables(pictures.recording_set.rig, pictures.recording_set.rig_file, "laser_fan")
    recording_set = fresh_check(pictures.recording_set, calibration.fan)
    pictures = pictures.of(recording_set)
    if not recording_set.check:
        raise InputError(
            Message("readjust.no_check", "a re-adjustment needs the pictures of a check"),
            where=recording_set.rig_file.parent / CHECK,
            todo=Message("advice.record_check", "hold the plane target into the fan and record one to three pictures"),
        )
    camera, fan = calibration.camera, calibration.fan
    seen = measure_check(pictures, camera.camera, stripe, progress) if poses is None else poses
    deviations, evidence, checked, change = judged(recording_set, calibration, seen)
    if (refused := nothing_changed(change.p)) is not None:
        raise refused
    paths = check_paths(recording_set)
    seen_by = CheckPictures(
        squares=sum(pose.squares for pose in checked),
        freedom=sum(pose.freedom for pose in checked),
        poses=sum(pose.located.used for pose in checked),
        taken_at=taken_at(paths),
        pictures_id=pictures.id_of(paths),
        hashes={recording_set.name_of(path): file_hash(path) for path in paths},
    )
    stability = _prior(recording_set, calibration, seen_by.taken_at)
    moved = Calibration(*readjusted((camera, fan, calibration.id), deviations, evidence, seen_by, stability))
    there = moved.camera.camera
    left = calibration_deviations(moved.camera, moved.fan)
    again, _ = check_poses(seen, there, moved.fan, left)
    nominal = None if recording_set.rig.gauge is None else recording_set.rig.gauge.nominal_mm
    step_mm = nominal or STEP_MM
    here = step_errors(again, there, moved.fan.fan, (*left, _as_it_was(calibration)), step_mm)
    return ProposedReadjustment(
        moved.camera,
        moved.fan,
        (_rms([pose.offset_px for pose in checked]), _rms([pose.offset_px for pose in again])),
        (_rms([pose.offset_mm for pose in checked]), _rms([pose.offset_mm for pose in again])),
        step_mm,
        -float(here[-1]),
        float(np.linalg.norm(here[:-1])),
    )


def _prior(recording_set: RecordingSet, calibration: Calibration, when: datetime) -> Stability | None:
    """How far the rig may have changed: by its history where that is more than what is stated or assumed.

    A check that fails shows what quiet days before it have not: they make the prior no smaller.
    """
    spread, stated = (
        charted_spread(recording_set, calibration, when),
        change_at_check(recording_set, calibration.fan, when).stability,
    )
    if spread is None or (stated is None and spread.factor < 1):
        return stated
    return spread.stability


def readjust_step(
    work: Workspace,
    stripe: StripeSettings | None = None,
    progress: Progress = silent,
    poses: Sequence[PoseFeatures] | None = None,
) -> ProposedReadjustment:
    """Re-adjust camera and fan by the pictures of the interim check, and write both and a record into planes.json.

    The file before is kept as planes-calibrated.json; what was measured with it goes.

    Raises
    ------
    InputError
        As `propose_readjustment`; then nothing has changed.
    """
    with work.step(READJUST) as log:
        proposed = propose_readjustment(log.pictures, work.calibration(), stripe, progress, poses)
        kept = work.path("calibrated") if work.path("calibrated").exists() else work.path("planes")
        write_bytes(log.path("calibrated"), read_bytes(kept))
        write_planes(log.path("planes"), proposed.fan, read_camera(work.path("camera")).camera)
        log.notes.append(proposed.record.note)
    return proposed


def undo_readjustment(work: Workspace) -> None:
    """Put planes.json back as it was before camera and fan were re-adjusted.

    Raises
    ------
    InputError
        If camera and fan were not re-adjusted.
    """
    if not work.path("calibrated").exists():
        raise InputError(
            Message("readjust.not_readjusted", "camera and fan are as they were calibrated"), where=work.path("planes")
        )
    with work.step(READJUST, measures=False) as log:
        write_bytes(log.path("planes"), read_bytes(work.path("calibrated")))
        log.gone.add("calibrated")
        log.notes.append(
            Message("readjust.undone", "The re-adjustment was undone: camera and fan are as they were calibrated.")
        )


def _as_it_was(calibration: Calibration) -> Deviation:
    return Deviation("change", calibration.camera.camera, calibration.fan.fan)


def _rms(offsets: Sequence[Array]) -> float:
    return float(np.sqrt(np.mean(np.square(np.concatenate(offsets)))))
