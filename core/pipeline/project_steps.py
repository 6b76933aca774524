"""The steps of a project, as a window or a script calls them.

All of them can be called in another process: their arguments and results can be pickled. What takes long takes a
`progress` last.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from core.calibrate.pose_features import PoseFeatures
from core.calibrate.results import CameraCalibration, FanCalibration
from core.calibrate.seen_views import SeenViews
from core.errors import InputError
from core.files.calibration_store import (
    StoredCalibration,
    keep_camera,
    keep_fan,
    put_in_place,
    read_stored,
    read_stored_camera,
)
from core.files.fan_file import fan_id
from core.files.json_text import to_json
from core.files.pictures import read_bytes
from core.files.project_data import Project
from core.files.project_folder import source_folder
from core.files.project_results import ScanSummary
from core.files.recording_set import RecordingSet, gather_set, require_scan
from core.files.report_template import read_report_template
from core.files.run_file import write_run
from core.files.study_file import study_path
from core.inspect.results import GaugeResult
from core.model import Camera
from core.pipeline.camera_step import see_views, solve_camera
from core.pipeline.found_features import keep_poses, keep_views, kept_poses, kept_views
from core.pipeline.gauge_complaints import in_a_project
from core.pipeline.gauge_step import gauge_if_possible, gauge_step
from core.pipeline.planes_step import measure_poses, planes_settings, solve_planes
from core.pipeline.project_results import load_results
from core.pipeline.report_step import report_content, report_step
from core.pipeline.reported_inspection import with_studies
from core.pipeline.scan_step import scan_step
from core.pipeline.staging import staged
from core.pipeline.workspace import FILES, Workspace
from core.progress import Progress, silent
from core.report.content import RepeatLine, ReportContent
from core.report.pdf import build_report
from core.report.section_names import SECTIONS
from core.report.template import ReportTemplate
from core.scan.frame_preview import FramePreview

__all__ = [
    "RESULTS",
    "accept_camera",
    "accept_fan",
    "accepted_camera",
    "find_poses",
    "find_views",
    "found_poses",
    "found_views",
    "load_results",
    "make_report",
    "measure_gauge",
    "measure_scan",
    "project_set",
    "report_bytes",
    "results_folder",
    "solve_poses",
    "solve_views",
]

RESULTS = "results"
"""The folder of results in a project."""

_OF_A_SCAN = tuple(name for key, name in FILES.items() if key != "report")
"""What a new scan replaces. The report stays: it is whole in itself, and says what it is of."""


def results_folder(folder: Path) -> Path:
    """Where the results of the project in `folder` lie."""
    return folder / RESULTS


def project_set(folder: Path, project: Project) -> RecordingSet:
    """The pictures of a project as one recording set, with the names they would have in one.

    Raises
    ------
    InputError
        If pictures of one part are not all of one size, or one folder is to be two parts.
    """
    sources = project.sources
    camera, planes, scan = (source_folder(folder, name) for name in (sources.camera, sources.planes, sources.scan))
    return gather_set(project.rig, camera, planes, scan, project.info.name)


def accepted_camera(folder: Path, project: Project) -> Camera:
    """The accepted camera; InputError if there is none, or it is damaged."""
    return _accepted(folder, project).camera


def _accepted(folder: Path, project: Project) -> CameraCalibration:
    if not project.accepted.camera:
        raise InputError("no calibration of the camera is accepted yet", todo="calibrate it, and accept the result")
    return read_stored_camera(folder, project.accepted.camera)


def find_views(folder: Path, project: Project, progress: Progress = silent) -> SeenViews:
    """Look for the camera target in every picture; InputError if there are none, or they differ.

    What is found is kept in the project.
    """
    found = project_set(folder, project)
    seen = see_views(found, progress)
    keep_views(folder, project, found, seen)
    return seen


def found_views(folder: Path, project: Project, progress: Progress = silent) -> SeenViews | None:
    """What `find_views` found in these very pictures the last time, if nothing else has been looked at since."""
    return kept_views(folder, project, project_set(folder, project), progress)


def solve_views(folder: Path, project: Project, seen: SeenViews, progress: Progress = silent) -> CameraCalibration:
    """The camera from what the pictures show, without the views left out; InputError if they do not determine it."""
    return solve_camera(seen, project.options, progress, project.rig.camera_board)


def accept_camera(folder: Path, project: Project, calibration: CameraCalibration, progress: Progress = silent) -> str:
    """Keep a camera's calibration in the project and return its id: the caller makes it the accepted one.

    Raises
    ------
    InputError
        If nothing can be written.
    """
    progress("keeping the calibration", 0, 1)
    found = project_set(folder, project)
    names = {view.view.name for view in calibration.views}
    inputs = _hashes(found, (path for path in found.camera if found.name_of(path) in names))
    return keep_camera(folder, calibration, project.options, inputs)


def find_poses(folder: Path, project: Project, progress: Progress = silent) -> tuple[PoseFeatures, ...]:
    """Target and stripes in the pictures of every pose; InputError without an accepted camera or without pictures.

    What is found is kept in the project.
    """
    found = project_set(folder, project)
    poses = measure_poses(found, accepted_camera(folder, project), progress)
    keep_poses(folder, project, found, poses)
    return poses


def found_poses(folder: Path, project: Project, progress: Progress = silent) -> tuple[PoseFeatures, ...]:
    """What `find_poses` found in these very pictures the last time, seen by the accepted camera; else nothing."""
    return kept_poses(folder, project, project_set(folder, project), progress)


def solve_poses(
    folder: Path, project: Project, poses: Sequence[PoseFeatures], progress: Progress = silent
) -> FanCalibration:
    """The fan, seen through the accepted camera, without the poses left out.

    Raises
    ------
    InputError
        If no camera is accepted, or the poses do not determine the fan.
    """
    camera = _accepted(folder, project)
    return solve_planes(poses, camera.camera, project.rig, project.options, progress, camera.covariance)


def accept_fan(
    folder: Path,
    project: Project,
    calibration: FanCalibration,
    poses: Sequence[PoseFeatures],
    progress: Progress = silent,
) -> str:
    """Keep a fan's calibration in the project and return its id: the caller makes it the accepted one.

    Raises
    ------
    InputError
        If the accepted camera is not the one it was solved with, or nothing can be written.
    """
    if fan_id(solve_poses(folder, project, poses, progress).fan) != fan_id(calibration.fan):
        raise InputError(
            "this is not what the poses give with the accepted camera and the settings as they are",
            where="laser planes",
            todo="solve the laser planes again, then accept them",
        )
    found = project_set(folder, project)
    names = {pose.name for pose in poses}
    pictures = (path for pair in found.planes if pair.name in names for path in (pair.on, pair.off) if path is not None)
    settings = planes_settings(project.rig, project.options)
    return keep_fan(folder, calibration, accepted_camera(folder, project), poses, settings, _hashes(found, pictures))


def measure_scan(
    folder: Path,
    project: Project,
    progress: Progress = silent,
    watch: Callable[[FramePreview], None] | None = None,
) -> ScanSummary:
    """Measure surface and thickness with the accepted calibrations; a part without two parallel faces is no error.

    New results take the place of the old ones when all is done; until then, and if it is cancelled, the old ones stay.
    Where the scan among them is of the same pictures and another σ cut, method or calibration is to be used, the
    pictures are not looked at again, and there is nothing to watch.

    Parameters
    ----------
    folder, project
        The project.
    progress
        Told what is being done; may cancel.
    watch
        Shown each frame with what it gives by itself, in the order of the recording, on this thread.

    Raises
    ------
    InputError
        If no calibration is accepted, there are no usable frames, or no sweep can be located.
    """
    found = project_set(folder, project)
    require_scan(found)
    results = results_folder(folder)
    with staged(results, _OF_A_SCAN) as beside:
        put_in_place(folder, project.accepted, beside)
        work = Workspace.open(found, beside, _part(project))
        _record_calibrations(work, folder, project)
        measured = scan_step(work, project.options, progress, watch, earlier=_earlier(found, results, project))
        gauge, no_gauge = gauge_if_possible(work, progress)
        notes, calibration_id = work.record().all_notes, work.calibration().id
    return ScanSummary(
        frames=measured.scan.frames,
        points=len(measured.scan.cloud),
        triangles=len(measured.mesh.triangles),
        gauge=gauge,
        no_gauge=no_gauge,
        notes=notes,
        calibration_id=calibration_id,
        files=Workspace(found, results).written(),
    )


def measure_gauge(folder: Path, project: Project, progress: Progress = silent) -> GaugeResult:
    """Measure the thickness of the scan among the results, with the project's regions and nominal value.

    Raises
    ------
    InputError
        If there is no scan, or it has no two parallel faces there.
    """
    try:
        return gauge_step(_work(folder, project), progress)
    except InputError as error:
        raise in_a_project(error) from error


def make_report(folder: Path, project: Project, progress: Progress = silent) -> Path:
    """Put the results into report.pdf, with what the project says of the job; returns its path.

    Raises
    ------
    InputError
        If there is no scan among the results.
    """
    return report_step(_work(folder, project), progress, lambda content: with_words(content, folder, project))


def report_bytes(folder: Path, project: Project, progress: Progress = silent) -> bytes:
    """The report as `make_report` would write it, as the bytes of a PDF; nothing is written."""
    return build_report(project_content(folder, project, progress), progress)


def project_content(folder: Path, project: Project, progress: Progress = silent) -> ReportContent:
    """All that is reported and handed over of a project; InputError if there is no scan among the results."""
    work = Workspace(project_set(folder, project), results_folder(folder), _part(project))  # only read from
    return report_content(work, progress, lambda content: with_words(content, folder, project))


def _part(project: Project) -> str:
    """The part's name: what the project is of, if nobody says more."""
    return project.info.part or project.options.part or project.info.name


def _work(folder: Path, project: Project) -> Workspace:
    return Workspace.open(project_set(folder, project), results_folder(folder), _part(project))


def _earlier(found: RecordingSet, results: Path, project: Project) -> Path | None:
    """The scan whose features will do; None where nothing has changed since: then the pictures are to be looked at."""
    before = Workspace(found, results)
    try:
        settings, calibration = before.record().settings.get("scan"), before.calibration().id
    except InputError:
        return None
    now = json.loads(to_json(dict(project.options.scan_settings)))
    same = settings == now and calibration == f"{project.accepted.camera}-{project.accepted.fan}"
    return None if same else before.path("scan")


def _hashes(found: RecordingSet, paths: Iterable[Path]) -> dict[str, str]:
    """SHA-256 of pictures by their names within the set."""
    return {found.name_of(path): hashlib.sha256(read_bytes(path)).hexdigest() for path in paths}


def _record_calibrations(work: Workspace, folder: Path, project: Project) -> None:
    """Write into run.json how the calibrations came about, as if they had been made with the scan."""
    calibration, record = work.calibration(), work.record()
    steps = (
        ("camera", read_stored(folder, "camera", project.accepted.camera), calibration.camera.notes),
        ("planes", read_stored(folder, "fan", project.accepted.fan), calibration.fan.notes),
    )
    for step, about, notes in steps:
        made_at = {} if about is None else {step: about.kept_at}
        about = about or StoredCalibration("camera", "", record.measured_at, 0, 0)
        record = replace(
            record,
            settings={**record.settings, step: about.settings},
            notes={**record.notes, step: (*about.notes, *notes)},
            inputs={**record.inputs, **about.inputs},
            made_at={**record.made_at, **made_at},
        )
    write_run(work.path("run"), record)


def with_words(content: ReportContent, folder: Path, project: Project) -> ReportContent:
    """The report's content with what people say of the job and of the report.

    Raises
    ------
    InputError
        If the project's template of reports, or one of its studies, cannot be read.
    """
    info, choices = project.info, project.report
    template = read_report_template(folder / choices.template) if choices.template else ReportTemplate()
    content = with_studies(content, [study_path(folder, one.id) for one in project.studies if one.included])
    return replace(
        content,
        serial=info.serial,
        laboratory=info.laboratory,
        operator=info.operator,
        customer=info.customer,
        air_celsius=info.air_celsius,
        part_celsius=info.part_celsius,
        remarks=info.notes,
        repeats=tuple(
            RepeatLine(one.scan, one.thickness_mm, one.U_mm, one.k, one.calibration_id, one.measured_at)
            for one in project.repeats
        ),
        hidden=choices.hidden & SECTIONS.keys(),
        paper=choices.paper,
        language=choices.language,
        template=template,
    )
