"""The whole way in one call: from a recording set to thickness, cloud, mesh and report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import NO_FAN, CameraCalibration, FanCalibration
from core.errors import InputError
from core.files.folder_lock import alone_in
from core.files.reading import file_hash
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import (
    CHECK,
    PARTS,
    open_set,
    require_camera,
    require_planes,
    require_scan,
)
from core.files.results.folder_results import read_results
from core.files.step_graph import READJUST, Step, do_steps
from core.inspect.result_list import ResultList
from core.inspect.results import GaugeResult
from core.messages import Message
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.check_step import check_step, measure_check
from core.pipeline.steps.gauge_step import gauge_if_possible, missing_thickness
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.readjust_step import readjust_step
from core.pipeline.steps.report_step import prepare_report, report_step
from core.pipeline.steps.scan.pictures import begin_looking
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.progress import Progress, silent
from core.scan.results import FrameRecord
from core.second_process import SecondProcess
from core.settings.options import Options


@dataclass(frozen=True, eq=False, slots=True)
class RunResult:
    """Results of measuring a whole recording set, and the folder of their files.

    `gauge` is None where no thickness was asked for and the part has no two parallel faces. `results` are all that are
    in the folder, with the verdict on the part. `files` holds what was
    written, by the names in `core.files.step_graph.FILES`.
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
    *,
    over_simulated: bool = False,
) -> RunResult:
    """Measure a recording set from its pictures to its report; the files of each step are written once it is done.

    Parameters
    ----------
    set_folder
        The recording set.
    out_folder
        Where the results go; made if it is not there. Results of an earlier run of this set in it are replaced.
    options
        Method and cuts.
    progress
        Called with what is being done; may raise Cancelled.
    beside
        A second process that takes part of the work; the results are the same, byte for byte.
    over_simulated
        Whether results of another set are replaced, too, if that one is simulated.

    Raises
    ------
    InputError
        If anything in the set keeps it from being measured, or the folder has the results of another set; what was
        finished before stays, whole.
    """
    options = options or Options()
    recording_set = open_set(set_folder).with_channel(options.channel)
    require_camera(recording_set)
    if recording_set.rig.has_fan:
        require_planes(recording_set)
    require_scan(recording_set)
    work = Workspace.open(recording_set, out_folder, options.part)
    with alone_in(work.out):
        _require_own_results(work, over_simulated=over_simulated)
        work.clear()
        going = _Run(work, options, progress, beside)
        do_steps(going)
        return going.result()


def _require_own_results(work: Workspace, *, over_simulated: bool) -> None:
    """Raise InputError if the results in the folder are of a scan that shares no picture with that of the set."""
    try:
        record = work.record()
    except InputError:
        return  # what cannot be read tells of no set, and is measured anew
    measured = {digest for name, digest in record.inputs.items() if name.startswith("scan/")}
    if not measured or (over_simulated and record.simulated):
        return
    if not any(file_hash(frame) in measured for frame in work.recording_set.frames):
        raise InputError(
            Message(
                "run.of_other_set", "it has the results of other pictures, of the set {name}", name=record.set_name
            ),
            where=work.out,
            todo=Message("advice.other_out", "name another --out, or remove the folder if they are not wanted"),
        )


class _Run:
    """A recording set while it is measured: each step is the method of its name. It has what later ones need."""

    camera_found: CameraCalibration
    fan: FanCalibration
    frames: tuple[FrameRecord, ...]
    points: int
    triangles: int
    thickness: GaugeResult | None

    def __init__(self, work: Workspace, options: Options, progress: Progress, beside: SecondProcess | None) -> None:
        self._work, self._options, self._progress, self._beside = work, options, progress, beside
        recording_set = work.recording_set
        self._there = {*PARTS, CHECK} if recording_set.check else {*PARTS}
        if not recording_set.rig.has_fan:
            self._there -= {"planes", CHECK}
            self.fan = NO_FAN
        self._asked = {"gauge"}
        self._checked: tuple[PoseFeatures, ...] | None = None
        self._seen = begin_looking(recording_set, options.for_scan, progress, beside)

    def is_due(self, step: Step) -> bool:
        """Whether a step is to be done, now that those before it have been done."""
        return step.is_requested(self._there, self._asked)

    def do(self, step: Step) -> None:
        getattr(self, step.name)()

    def camera(self) -> None:
        self.camera_found = camera_step(self._work, self._options.for_camera, self._progress)

    def planes(self) -> None:
        self.fan = planes_step(self._work, self._options.for_planes, self._progress, self._beside)

    def check(self) -> None:
        """The check; where it is not passed, rig.toml may ask for a re-adjustment."""
        work, stripe = self._work, self._options.plane_stripe
        pictures = PictureReader(work.recording_set)
        self._checked = measure_check(pictures, self.camera_found.camera, stripe, self._progress, self._beside)
        passed = check_step(work, stripe, self._progress, poses=self._checked).passed
        if not passed and work.recording_set.rig.readjust:
            self._asked.add(READJUST)

    def readjust(self) -> None:
        """The fan re-adjusted by the check; it stays as it was where that is refused, and why is said."""
        try:
            self.fan = readjust_step(self._work, self._options.plane_stripe, self._progress, self._checked).fan
        except InputError as error:
            with self._work.step(READJUST) as log:
                log.notes.append(error.message)

    def scan(self) -> None:
        if self._beside is not None:
            self._beside.submit(prepare_report, None)
        measured = scan_step(
            self._work,
            self._options.for_scan,
            self._progress,
            check=self._checked,
            seen=self._seen,
            beside=self._beside,
        )
        self._seen = None  # all else of it lies in the files
        self.frames = measured.scan.frames
        self.points, self.triangles = len(measured.scan.cloud), len(measured.mesh.triangles)

    def gauge(self) -> None:
        """A part without two parallel faces is no error where rig.toml does not ask for a thickness."""
        self.thickness, problem = gauge_if_possible(self._work, self._progress)
        missing = missing_thickness(self._work.recording_set.rig, problem)
        if missing is not None:
            raise missing

    def report(self) -> None:
        report_step(self._work, self._progress, beside=self._beside)

    def result(self) -> RunResult:
        """What came of it, once all steps are done."""
        return RunResult(
            camera=self.camera_found,
            fan=self.fan,
            frames=self.frames,
            points=self.points,
            triangles=self.triangles,
            gauge=self.thickness,
            results=read_results(self._work.out),
            notes=self._work.record().all_notes,
            files=self._work.written(),
        )
