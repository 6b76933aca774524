"""Looking at single pictures of a project, and at calibrations made earlier, as a window or a script asks for them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from core.calibrate.pose_features import PoseFeatures
from core.calibrate.pose_stages import PoseStages
from core.calibrate.results import FanCalibration
from core.errors import InputError
from core.files.calibration_store import read_stored_fan, read_stored_poses
from core.files.pictures import read_bytes
from core.files.project_data import Project
from core.files.run_file import read_run
from core.files.scan_file import read_scan
from core.model import Fan
from core.pipeline.frame_stages import frame_stages
from core.pipeline.pose_stages import pose_stages
from core.pipeline.project_steps import accepted_camera, project_set, results_folder, solve_poses
from core.pipeline.workspace import FILES
from core.progress import Progress, silent
from core.scan.stages import FrameStages, SettledScan


def show_frame(folder: Path, project: Project, name: str, progress: Progress = silent) -> FrameStages:
    """Every stage of one frame ("scan/frame0007.png"), with the accepted calibrations as far as there are any.

    What a measurement of this very recording has settled (the look of the stripes, the numbers of the fan's lines) is
    taken from it.

    Raises
    ------
    InputError
        As `frame_stages`, or if an accepted calibration is damaged.
    """
    found = project_set(folder, project)
    camera = accepted_camera(folder, project) if project.accepted.camera else None
    fan = read_stored_fan(folder, project.accepted.fan, camera).fan if camera and project.accepted.fan else None
    settled = _settled(results_folder(folder), found.path_of(name), name, project)
    return frame_stages(found, name, camera, fan, project.options, progress, settled)


def show_pose(
    folder: Path, project: Project, pose: PoseFeatures, fan: Fan | None = None, progress: Progress = silent
) -> PoseStages:
    """The picture of one pose with what was found in it; the lines of its stripes if there is a fan.

    Raises
    ------
    InputError
        If no camera is accepted, or the picture is not there.
    """
    return pose_stages(project_set(folder, project), pose, accepted_camera(folder, project), fan, progress)


def recall_poses(
    folder: Path, project: Project, progress: Progress = silent
) -> tuple[tuple[PoseFeatures, ...], FanCalibration]:
    """What the poses of the accepted fan showed, and the fan solved from them again, with all its points.

    The fan is that of the project's settings as they are: the accepted one only if they are the same.

    Raises
    ------
    InputError
        If no fan is accepted, it is damaged, or the settings of now do not determine a fan.
    """
    if not project.accepted.fan:
        raise InputError("no calibration of the laser planes is accepted yet", todo="calibrate them first")
    poses = read_stored_poses(folder, project.accepted.fan)
    return poses, solve_poses(folder, project, poses, progress)


@dataclass(frozen=True, slots=True)
class _Version:
    """A file as it was written at one time."""

    path: Path
    written_ns: int
    size: int

    @classmethod
    def of(cls, path: Path) -> _Version:
        about = path.stat()
        return cls(path, about.st_mtime_ns, about.st_size)


def _settled(results: Path, picture: Path, name: str, project: Project) -> SettledScan | None:
    """What the measurement among the results has settled, if it is of this very picture and these settings."""
    scan, run = results / FILES["scan"], results / FILES["run"]
    try:
        record = read_run(run)
        same = record.inputs.get(name) == hashlib.sha256(read_bytes(picture)).hexdigest()
        told = record.settings.get("scan", {}).get("stripe")
        return _read_settled(_Version.of(scan)) if same and told == project.options.scan_settings["stripe"] else None
    except (InputError, OSError):
        return None  # nothing measured yet, or damaged: then the recording alone must tell


@lru_cache(maxsize=1)
def _read_settled(scan: _Version) -> SettledScan:
    file = read_scan(scan.path)
    return SettledScan(file.features.sweep_stripe, file.features.fan_stripe, file.fan_line)
