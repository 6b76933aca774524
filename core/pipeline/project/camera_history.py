"""The history of a project's camera calibrations: compared, and gone on with without searching the pictures again."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from core.calibrate.camera.changes import CameraChanges, camera_changes
from core.calibrate.camera.views import RecalledCamera, recovered_views
from core.calibrate.results import CameraCalibration
from core.files.project.calibration_store import read_stored, read_stored_camera
from core.files.project.data import Project
from core.files.project.folder import source_folder
from core.files.reading import file_hash
from core.files.recording.set_listing import pictures_in
from core.image.targets import Target
from core.progress import Progress, silent


def recall_camera(project_folder: Path, project: Project, progress: Progress = silent) -> RecalledCamera:
    """Read a project's accepted camera, with its views if it was made from the project's pictures as they are.

    Raises
    ------
    InputError
        If it is not in the history, or damaged, or a picture cannot be read.
    """
    id_ = project.accepted.camera
    calibration, about = read_stored_camera(project_folder, id_), read_stored(project_folder, "camera", id_)
    folder = source_folder(project_folder, project.sources.camera)
    if about is None or not about.inputs or not calibration.views:
        return RecalledCamera(calibration, None, False)
    hashes: dict[str, str] = {}
    paths = pictures_in(folder)
    for path in paths:
        progress("comparing the pictures", len(hashes), len(paths))
        hashes[f"camera/{path.name}"] = file_hash(path)
    if hashes != about.inputs or not _shows(calibration, project.rig.camera_target):
        return RecalledCamera(calibration, None, False)
    same = _plain(about.settings) == _plain(project.options.for_camera.run_settings("camera"))
    return RecalledCamera(calibration, recovered_views(calibration, project.sources.camera), same)


def compare_stored(
    project_folder: Path, first_id: str, second: CameraCalibration | str, progress: Progress = silent
) -> CameraChanges:
    """Compare the camera calibration `first_id` of the history with `second`, a calibration or the id of one.

    Raises
    ------
    InputError
        If one is not in the history, or damaged.
    """
    if isinstance(second, str):
        second = read_stored_camera(project_folder, second)
    return camera_changes(read_stored_camera(project_folder, first_id), second, progress)


def _shows(calibration: CameraCalibration, target: Target) -> bool:
    """Whether the views are of this target: every point seen is one of its points, and they reach all its ends.

    A larger board has the points of a smaller one, too.
    """
    points = np.round(target.points, 4)
    seen = np.concatenate([np.round(view.view.points, 4) for view in calibration.views])
    if not {*map(tuple, seen.tolist())} <= {*map(tuple, points.tolist())}:
        return False
    return bool((seen.min(axis=0) == points.min(axis=0)).all() and (seen.max(axis=0) == points.max(axis=0)).all())


def _plain(settings: object) -> object:
    """Settings as they come back from a file."""
    return json.loads(json.dumps(settings, sort_keys=True, default=list))
