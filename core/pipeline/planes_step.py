"""Planes step: pictures of the plane target with the fan on (and off) → planes.json."""

from __future__ import annotations

from core.calibrate.fan import FanOptions, fit_fan
from core.calibrate.plane_pose import PoseFeatures, measure_plane_pose
from core.calibrate.results import FanCalibration
from core.errors import InputError
from core.files.camera_file import read_camera
from core.files.fan_file import fan_id, read_fan, write_fan
from core.files.poses_file import write_poses
from core.files.recording_set import PlanePair, RecordingSet, require_planes
from core.model import Camera
from core.pipeline.workspace import Workspace, check_size
from core.progress import Progress, silent
from core.threads import ordered_map


def planes_step(work: Workspace, progress: Progress = silent) -> FanCalibration:
    """Calibrate the fan of a set with the camera in camera.json, and write planes.json.

    Raises
    ------
    InputError
        If camera.json is missing or wrong, the pictures have another size, or the poses do not determine the fan.
    """
    require_planes(work.found)
    camera = read_camera(work.path("camera")).camera
    with work.step("planes") as log:
        rig = work.found.rig
        options = FanOptions(rig.lines, rig.angle or None)
        log.settings.update({"lines": options.lines, "angle_rad": options.angle, "constrained": options.constrained})
        features = _measure_all(work.found, camera, progress)
        calibration = fit_fan(features, camera, options, progress)
        log.notes.extend(note for pose in features for note in pose.notes)
        log.notes.extend(calibration.notes)
        write_fan(work.path("planes"), calibration, camera)
        write_poses(work.path("poses"), fan_id(calibration.fan), features)
    return read_fan(work.path("planes"), camera)


def _measure_all(found: RecordingSet, camera: Camera, progress: Progress) -> list[PoseFeatures]:
    """Target and stripes of every pose, a few poses at a time."""

    def measure(pair: PlanePair) -> PoseFeatures:
        try:
            on = found.read(pair.on)
            off = found.read(pair.off) if pair.off is not None else None
        except InputError as error:
            return PoseFeatures(pair.name, None, (), str(error).rstrip("."))
        check_size(pair.on, on, camera)
        if off is not None and off.dtype != on.dtype:
            return PoseFeatures(
                pair.name, None, (), "the pictures with the fan on and off differ in depth (8 or 16 bit)"
            )
        return measure_plane_pose(pair.name, on, off, found.rig.plane_target, camera)

    features: list[PoseFeatures] = []
    total = len(found.planes)
    progress("plane poses", 0, total)
    for pose in ordered_map(measure, found.planes):
        features.append(pose)
        progress("plane poses", len(features), total)
    return features
