"""The history of a project's camera calibrations, compared."""

from __future__ import annotations

from pathlib import Path

from core.calibrate.camera_changes import CameraChanges, camera_changes
from core.calibrate.results import CameraCalibration
from core.files.calibration_store import read_stored_camera
from core.progress import Progress, silent


def compare_stored(
    project_folder: Path, first_id: str, second: CameraCalibration | str, progress: Progress = silent
) -> CameraChanges:
    """What is different in `second`, a calibration or the id of one, against one of the history.

    Raises
    ------
    InputError
        If one is not in the history, or damaged.
    """
    if isinstance(second, str):
        second = read_stored_camera(project_folder, second)
    return camera_changes(read_stored_camera(project_folder, first_id), second, progress)
