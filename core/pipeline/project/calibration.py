"""The calibrations of a project: look at the pictures, solve, and keep what is accepted."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from core.calibrate.camera.views import SeenViews
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import InputError
from core.files.project.calibration_store import read_stored_camera, store_camera, store_planes
from core.files.project.data import Project
from core.files.reading import file_hash
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet, require_planes
from core.files.results.planes_file import planes_id
from core.messages import Message
from core.model import Camera
from core.pipeline.compile_ahead import compile_ahead
from core.pipeline.project.workspace import project_set
from core.pipeline.steps.camera_step import see_views, solve_camera
from core.pipeline.steps.kept_features import store_poses, store_views, stored_poses, stored_views
from core.pipeline.steps.planes_step import (
    check_agreement,
    measure_poses,
    plane_run_settings,
    solve_planes,
    with_acquisition,
)
from core.progress import Progress, silent
from core.second_process import SecondProcess


def accepted_camera(folder: Path, project: Project) -> Camera:
    """Read the camera accepted in a project; InputError if none is, or it is damaged."""
    return _accepted(folder, project).camera


def _accepted(folder: Path, project: Project) -> CameraCalibration:
    if not project.accepted.camera:
        raise InputError(
            Message("project.no_camera_accepted", "no calibration of the camera is accepted yet"),
            todo=Message("advice.calibrate_and_accept", "calibrate it, and accept the result"),
        )
    return read_stored_camera(folder, project.accepted.camera)


def find_views(folder: Path, project: Project, progress: Progress = silent) -> SeenViews:
    """Find the camera target in every picture and store the views in the project; InputError without pictures.

    InputError as well if their sizes differ.
    """
    pictures = PictureReader(project_set(folder, project))
    seen = see_views(pictures, progress)
    store_views(folder, project, pictures, seen)
    return seen


def found_views(folder: Path, project: Project, progress: Progress = silent) -> SeenViews | None:
    """Read the views stored by `find_views`, if they are of the project's pictures and target as of now; else None."""
    return stored_views(folder, project, PictureReader(project_set(folder, project)), progress)


def solve_views(folder: Path, project: Project, seen: SeenViews, progress: Progress = silent) -> CameraCalibration:
    """Calibrate the camera from the views `seen`, except those left out by hand; InputError if they do not suffice."""
    return solve_camera(seen, project.options.for_camera, progress, project.rig.camera_board)


def accept_camera(folder: Path, project: Project, calibration: CameraCalibration, progress: Progress = silent) -> str:
    """Store a camera's calibration in the project's history and return its id; the caller makes it the accepted one.

    Raises
    ------
    InputError
        If nothing can be written.
    """
    progress("keeping the calibration", 0, 1)
    recording_set = project_set(folder, project)
    names = {view.name for view in calibration.views}
    inputs = _hashes(recording_set, (path for path in recording_set.camera if recording_set.name_of(path) in names))
    return store_camera(folder, calibration, project.options.for_camera.run_settings("camera"), inputs)


def find_poses(
    folder: Path, project: Project, progress: Progress = silent, beside: SecondProcess | None = None
) -> tuple[PoseFeatures, ...]:
    """Find target and stripes in the pictures of every pose, and store the poses; InputError without pictures.

    InputError without an accepted camera as well.

    What is found is kept in the project. The process `beside` takes some of the poses.
    """
    pictures, camera = PictureReader(project_set(folder, project)), accepted_camera(folder, project)
    require_planes(pictures.recording_set)
    compile_ahead(progress)
    poses = measure_poses(pictures, camera, progress, project.options.plane_stripe, beside)
    store_poses(folder, project, pictures, poses)
    return poses


def found_poses(folder: Path, project: Project, progress: Progress = silent) -> tuple[PoseFeatures, ...]:
    """Read the poses stored by `find_poses`, if they are of the same pictures, plate and camera; else ()."""
    return stored_poses(folder, project, PictureReader(project_set(folder, project)), progress)


def solve_poses(
    folder: Path, project: Project, poses: Sequence[PoseFeatures], progress: Progress = silent
) -> FanCalibration:
    """Calibrate the fan from `poses` with the accepted camera, except the poses left out by hand.

    Raises
    ------
    InputError
        If no camera is accepted, or the poses do not determine the fan.
    """
    camera = _accepted(folder, project)
    planes = solve_planes(poses, camera.camera, project.rig, project.options.for_planes, progress, camera)
    return with_acquisition(planes, project_set(folder, project))


def accept_planes(
    folder: Path,
    project: Project,
    calibration: FanCalibration,
    poses: Sequence[PoseFeatures],
    accept_few_poses: bool = False,
    progress: Progress = silent,
) -> str:
    """Store a fan's calibration in the project's history and return its id; the caller makes it the accepted one.

    With `accept_few_poses` somebody has decided that it may rest on fewer than half of the poses.

    Raises
    ------
    InputError
        If the accepted camera is not the one it was solved with, fewer than half of the poses agree and nobody has
        decided that they may, or nothing can be written.
    """
    check_agreement(calibration, accept_few_poses or project.options.accept_few_poses)
    if planes_id(solve_poses(folder, project, poses, progress).fan) != planes_id(calibration.fan):
        raise InputError(
            Message(
                "project.fan_not_of_poses",
                "this is not what the poses give with the accepted camera and the settings as they are",
            ),
            where="laser planes",
            todo=Message("advice.solve_laser_planes_again", "solve the laser planes again, then accept them"),
        )
    recording_set = project_set(folder, project)
    names = {pose.name for pose in poses}
    pictures = recording_set.pictures_of(pair for pair in recording_set.planes if pair.name in names)
    settings = plane_run_settings(project.rig, project.options.for_planes)
    if calibration.minority is not None:
        settings["accept_few_poses"] = True
    return store_planes(
        folder, calibration, accepted_camera(folder, project), poses, settings, _hashes(recording_set, pictures)
    )


def _hashes(recording_set: RecordingSet, paths: Iterable[Path]) -> dict[str, str]:
    """SHA-256 of pictures by their names within the set."""
    return {recording_set.name_of(path): file_hash(path) for path in paths}
