"""The whole way in one call: from a recording set to thickness, cloud, mesh and report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import InputError
from core.files.folder_lock import alone_in
from core.files.recording.options import Options
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet, open_set, require_camera, require_planes, require_scan
from core.files.recording.step_settings import ScanSettings
from core.files.results.folder_results import read_results
from core.files.step_graph import READJUST
from core.image.stripes.stripe import StripeSettings
from core.inspect.result_list import ResultList
from core.inspect.results import GaugeResult
from core.messages import Message
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.check_step import check_step, measure_check
from core.pipeline.steps.gauge_step import gauge_if_possible, gauge_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.readjust_step import readjust_step
from core.pipeline.steps.report_step import prepare_report, report_step
from core.pipeline.steps.scan.pictures import SeenScan, look_at_scan
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.progress import Progress, silent
from core.scan.results import FrameRecord
from core.second_process import SecondProcess


@dataclass(frozen=True, eq=False, slots=True)
class RunResult:
    """What a whole run measured, and where its files are.

    `gauge` is None where no thickness was asked for and the part has no two parallel faces. `results` are all that are
    in the folder, with the verdict on the part. `files` holds what was
    written, by the names in `core.pipeline.steps.workspace.FILES`.
    """

    camera: CameraCalibration
    fan: FanCalibration
    frames: tuple[FrameRecord, ...]
    points: int
    triangles: int
    gauge: GaugeResult | None
    results: ResultList
    notes: tuple[Message, ...]
    files: dict[str, Path]


def run(
    set_folder: Path,
    out_folder: Path,
    options: Options | None = None,
    progress: Progress = silent,
    beside: SecondProcess | None = None,
) -> RunResult:
    """Measure a recording set; every step's results are written as soon as they are there.

    Parameters
    ----------
    set_folder
        The recording set.
    out_folder
        Where the results go; made if it is not there. Results of an earlier run in it are replaced.
    options
        Method and cuts.
    progress
        Called with what is being done; may raise Cancelled.
    beside
        A second process that takes part of the work; the results are the same, byte for byte.

    Raises
    ------
    InputError
        If anything in the set keeps it from being measured; what was finished before stays, whole.
    """
    options = options or Options()
    recording_set = open_set(set_folder).seen_in(options.channel)
    require_camera(recording_set)
    require_planes(recording_set)
    require_scan(recording_set)
    work = Workspace.open(recording_set, out_folder, options.part)
    with alone_in(work.out):
        return _measured(work, options, progress, beside)


def _measured(work: Workspace, options: Options, progress: Progress, beside: SecondProcess | None) -> RunResult:
    recording_set = work.recording_set
    work.clear()
    seen = _looking(recording_set, options.for_scan, progress, beside)
    camera = camera_step(work, options.for_camera, progress)
    fan = planes_step(work, options.for_planes, progress, beside)
    check = (
        measure_check(PictureReader(recording_set), camera.camera, options.plane_stripe, progress, beside)
        if recording_set.check
        else None
    )
    if (
        check is not None
        and not check_step(work, options.plane_stripe, progress, poses=check).passed
        and recording_set.rig.readjust
    ):
        fan = _readjusted(work, fan, options.plane_stripe, progress, check)
    if beside is not None:
        beside.submit(prepare_report, None)
    measured = scan_step(work, options.for_scan, progress, check=check, seen=seen, beside=beside)
    frames, points, triangles = measured.scan.frames, len(measured.scan.cloud), len(measured.mesh.triangles)
    del seen, measured  # all else of it lies in the files
    # a part without two parallel faces is no error when rig.toml does not ask for a thickness
    asked = recording_set.rig.gauge is not None
    gauge = gauge_step(work, progress) if asked else gauge_if_possible(work, progress)[0]
    report_step(work, progress, beside=beside)
    return RunResult(
        camera=camera,
        fan=fan,
        frames=frames,
        points=points,
        triangles=triangles,
        gauge=gauge,
        results=read_results(work.out),
        notes=work.record().all_notes,
        files=work.written(),
    )


def _readjusted(
    work: Workspace,
    fan: FanCalibration,
    stripe: StripeSettings | None,
    progress: Progress,
    check: Sequence[PoseFeatures],
) -> FanCalibration:
    """The fan re-adjusted by the check, as rig.toml wants it; as it was where that is refused, and why is said."""
    try:
        return readjust_step(work, stripe, progress, check).fan
    except InputError as error:
        with work.step(READJUST) as log:
            log.notes.append(error.message)
        return fan


def _looking(
    recording_set: RecordingSet, settings: ScanSettings, progress: Progress, beside: SecondProcess | None
) -> Callable[[], SeenScan] | None:
    """Have the pictures of the scan looked at while camera and planes are calibrated."""
    if beside is None:
        return None
    seen = beside.submit(look_at_scan, (recording_set, settings), progress)
    return lambda: beside.wait(seen, progress, "frames")
