"""Looking at single pictures of a project, and at calibrations made earlier, as a window or a script asks for them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.fan.poses.pose_stages import PoseStages
from core.calibrate.results import NO_FAN, FanCalibration
from core.calibrate.sitting import Acquisition
from core.errors import InputError
from core.files.project.calibration_store import read_stored_planes, read_stored_poses
from core.files.project.data import Project
from core.files.project.folder import results_folder
from core.files.project.results import ProjectResults
from core.files.reading import file_hash
from core.files.results.run_file import read_run
from core.files.results.scan_file import read_scan
from core.files.step_graph import FILES
from core.findings.table import without_notes_on
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.pipeline.project.calibration import accepted_camera, solve_poses
from core.pipeline.project.frame_stages import frame_stages
from core.pipeline.project.pose_stages import pose_stages
from core.pipeline.project.results import load_results
from core.pipeline.project.workspace import project_set
from core.progress import Progress, silent
from core.scan.features.extraction import ScanFeatures
from core.scan.preview.shown import FrameStages, SettledScan, ShownScan
from core.scan.surface.cloud import Cloud
from core.scan.surface.coverage_map import CoverageMap


def show_frame(folder: Path, project: Project, name: str, progress: Progress = silent) -> FrameStages:
    """Compute every stage of processing the frame `name` ("scan/frame0007.png"), with accepted calibrations if any.

    What a measurement of this very recording has settled (the look of the stripes, the numbers of the fan's lines) is
    taken from it.

    Raises
    ------
    InputError
        As `frame_stages`, or if an accepted calibration is damaged.
    """
    recording_set = project_set(folder, project)
    camera, fan, _ = accepted_calibration(folder, project)
    settled = _settled(results_folder(folder), recording_set.path_of(name), name, project)
    return frame_stages(recording_set, name, camera, fan, project.options.for_scan, progress, settled)


def accepted_calibration(
    folder: Path, project: Project, progress: Progress = silent
) -> tuple[Camera | None, Fan | None, Acquisition | None]:
    """Read the accepted camera and fan, and how the fan's pictures were taken; None for each that is not there.

    A rig without a fan has one of no lines. InputError if one is damaged or they are not a pair.
    """
    camera = accepted_camera(folder, project) if project.accepted.camera else None
    if not project.rig.has_fan:
        return camera, NO_FAN.fan, None
    if camera is None or not project.accepted.planes:
        return camera, None, None
    planes = read_stored_planes(folder, project.accepted.planes, camera)
    return camera, planes.fan, planes.taken


def show_scan(folder: Path, progress: Progress = silent) -> ShownScan:
    """Read the scan among the results of the project in `folder`, for display; without points if none can be read."""
    results = load_results(folder, progress)
    cloud = _NO_POINTS if results.cloud is None else results.cloud
    file = None if results.cloud is None else read_scan(results.files["scan"])
    features = None if file is None else file.features
    half, most = np.quantile(cloud.sigma, (0.5, 0.95)) if len(cloud) else (np.nan, np.nan)
    return ShownScan(
        points=cloud.points.astype(np.float32),
        sigma=cloud.sigma.astype(np.float32),
        uv=cloud.uv.astype(np.float32),
        frame=cloud.frame.astype(np.int32),
        triangles=0 if results.mesh is None else len(results.mesh.triangles),
        frames=results.frames,
        frames_used=sum(frame.used for frame in results.frames),
        median_sigma_mm=float(half),
        sigma_95_mm=float(most),
        share=0.0 if features is None else _covered(features, cloud.uv),
        stripe=None if features is None else features.sweep_stripe,
        notes=without_notes_on("frames", _scan_notes(results)),
        problems=results.problems,
        ground=None if results.gauge is None else results.gauge.lower.plane,
        known_planes={} if file is None else {plane.name: plane.outline for plane in file.planes},
    )


def show_pose(
    folder: Path, project: Project, pose: PoseFeatures, fan: Fan | None = None, progress: Progress = silent
) -> PoseStages:
    """Read the picture of one pose with target and stripes found in it; the stripes are numbered if `fan` is given.

    Raises
    ------
    InputError
        If no camera is accepted, or the picture is not there.
    """
    camera, stripe = accepted_camera(folder, project), project.options.plane_stripe
    return pose_stages(project_set(folder, project), pose, camera, fan, progress, stripe)


def recall_poses(
    folder: Path, project: Project, progress: Progress = silent
) -> tuple[tuple[PoseFeatures, ...], FanCalibration]:
    """Read the poses of the accepted fan, and solve the fan again from them, with the points of all its stripes.

    The fan is that of the project's settings as they are: the accepted one only if they are the same.

    Raises
    ------
    InputError
        If no fan is accepted, it is damaged, or the settings of now do not determine a fan.
    """
    if not project.accepted.planes:
        raise InputError(
            Message("project.no_fan_accepted", "no calibration of the laser planes is accepted yet"),
            todo=Message("advice.calibrate_first", "calibrate them first"),
        )
    poses = read_stored_poses(folder, project.accepted.planes)
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


_NO_POINTS = Cloud(
    points=np.zeros((0, 3)),
    uv=np.zeros((0, 2)),
    sigma=np.zeros(0),
    intensity=np.zeros(0),
    frame=np.zeros(0, np.int64),
    sweep=np.zeros(0, np.int64),
    normals=np.zeros((0, 3)),
)


def _covered(features: ScanFeatures, uv: Array) -> float:
    """Share of what was lit in which there are points, at `uv` (N, 2) in pixels."""
    coverage = CoverageMap(features.image_size)
    for frame in features.frames:
        for piece in frame.centrelines:
            coverage.add_lit(piece.uv)
    coverage.add(uv)
    return coverage.share


def _scan_notes(results: ProjectResults) -> tuple[Message, ...]:
    """What the measurement of the scan says, without what was said of the calibrations."""
    if results.cloud is None or "run" not in results.files:
        return ()
    return tuple(read_run(results.files["run"]).notes.get("scan", ()))


def _settled(results: Path, picture: Path, name: str, project: Project) -> SettledScan | None:
    """What the measurement among the results has settled, if it is of this very picture and these settings."""
    scan, run = results / FILES["scan"], results / FILES["run"]
    try:
        record = read_run(run)
        same = record.inputs.get(name) == file_hash(picture)
        told = record.settings.get("scan", {}).get("stripe")
        return (
            _read_settled(_Version.of(scan))
            if same and told == project.options.for_scan.run_settings("scan")["stripe"]
            else None
        )
    except (InputError, OSError):
        return None  # nothing measured yet, or damaged: then the recording alone must tell


@lru_cache(maxsize=1)
def _read_settled(scan: _Version) -> SettledScan:
    file = read_scan(scan.path)
    return SettledScan(file.features.sweep_stripe, file.features.fan_stripe, file.fan_line, file.second_bounces)
