"""Surface and thickness of a project's scan: old or new results, never both."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from core.calibrate.results import NO_FAN
from core.errors import InputError
from core.files.atomic import make_inner_folder
from core.files.folder_lock import alone_in
from core.files.json_text import to_json
from core.files.project.calibration_store import FOLDER, StoredCalibration, put_in_place, read_stored
from core.files.project.data import Project
from core.files.project.folder import RESULTS
from core.files.project.results import ScanSummary
from core.files.project.view_file import drop_view_of_another
from core.files.project.witness import Written, witnessed
from core.files.recording.recording_set import RecordingSet, require_scan
from core.files.results.planes_file import planes_id
from core.files.results.run_file import write_run
from core.files.step_graph import FILES
from core.inspect.results import GaugeResult
from core.pipeline.compile_ahead import compile_ahead
from core.pipeline.project.workspace import part_name, project_set, project_workspace
from core.pipeline.steps.camera_step import solved_for
from core.pipeline.steps.gauge_step import gauge_if_possible, gauge_step
from core.pipeline.steps.scan.pictures import SeenScan
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import HAS_FAN, Workspace, staged
from core.progress import Progress, silent
from core.scan.preview.shown import FramePreview
from core.second_process import SecondProcess

_OF_A_SCAN = tuple(name for name in FILES if name != "report")
"""What a new scan replaces. The report stays: it is whole in itself, and says what it is of."""


def measure_scan(
    folder: Path,
    project: Project,
    progress: Progress = silent,
    watch: Callable[[FramePreview], None] | None = None,
    seen: Callable[[], SeenScan] | None = None,
    beside: SecondProcess | None = None,
) -> ScanSummary:
    """Measure the surface of a project's scan and its thickness; a part without two parallel faces is no error.

    New results take the place of the old ones when all is done; until then, and if it is cancelled, the old ones stay.
    Where the scan among them is of the same pictures and another σ cut, method or calibration is to be used, the
    pictures are not looked at again, and there is nothing to watch.

    Parameters
    ----------
    folder, project
        The project.
    progress
        Called with what is being done; may raise Cancelled.
    watch
        Shown each frame with what it gives by itself, in the order of the recording, on this thread.
    seen
        Gives what the pictures show, if they are looked at already; there is nothing to watch then.
    beside
        A second process that takes the surface over.

    Raises
    ------
    InputError
        If no calibration is accepted, there are no usable frames, or no sweep can be located.
    """
    recording_set = project_set(folder, project)
    require_scan(recording_set)
    compile_ahead(progress)
    results = make_inner_folder(folder, RESULTS)
    with witnessed(folder, Written("measured")), alone_in(results), staged(results, "scan", _OF_A_SCAN) as new:
        put_in_place(folder, project.accepted, new, has_fan=project.rig.has_fan)
        work = Workspace.open(recording_set, new, part_name(project), folder / FOLDER)
        record_calibrations(work, folder, project)
        settings, earlier = project.options.for_scan, _earlier(recording_set, results, project)
        measured = scan_step(work, settings, progress, watch, earlier, seen=seen, beside=beside)
        found = gauge_if_possible(work, progress)
        notes, calibration_id = work.record().all_notes, work.calibration().id
    drop_view_of_another(folder, project.sources.scan)
    return ScanSummary(
        frames=measured.scan.frames,
        points=len(measured.scan.cloud),
        triangles=len(measured.mesh.triangles),
        gauge=found.gauge,
        no_gauge=found.note,
        notes=notes,
        calibration_id=calibration_id,
        files=Workspace(recording_set, results).written(),
    )


def measure_gauge(folder: Path, project: Project, progress: Progress = silent) -> GaugeResult:
    """Measure the thickness of the scan among the project's results, in the regions and with the nominal it states.

    Raises
    ------
    InputError
        If there is no scan, or it has no two parallel faces there.
    """
    with witnessed(folder, Written("measured")):
        return gauge_step(project_workspace(folder, project), progress)


def _earlier(recording_set: RecordingSet, results: Path, project: Project) -> Path | None:
    """The scan whose features will do; None where nothing has changed since: then the pictures are to be looked at."""
    before = Workspace(recording_set, results)
    try:
        settings, calibration = before.record().settings.get("scan"), before.calibration().id
    except InputError:
        return None
    now = json.loads(to_json(dict(project.options.for_scan.run_settings("scan"))))
    accepted = project.accepted
    fan = accepted.planes if project.rig.has_fan else planes_id(NO_FAN.fan)
    has_fan = {} if project.rig.has_fan else {HAS_FAN: False}
    same = settings == now | has_fan and calibration == f"{accepted.camera}-{fan}"
    return None if same else before.path("scan")


def record_calibrations(work: Workspace, folder: Path, project: Project) -> None:
    """Write into run.json how the accepted calibrations were made, as if they had been made with the scan."""
    calibration, record = work.calibration(), work.record()
    solved = {"camera": solved_for(calibration.camera)}
    steps = (
        ("camera", read_stored(folder, "camera", project.accepted.camera), calibration.camera.notes),
        ("planes", read_stored(folder, "planes", project.accepted.planes), calibration.fan.all_notes),
    )
    for step, about, notes in steps[: 2 if project.rig.has_fan else 1]:
        made_at = {} if about is None else {step: about.kept_at}
        about = about or StoredCalibration("camera", "", record.measured_at, 0, 0)
        record = replace(
            record,
            settings={**record.settings, step: {**about.settings, **solved.get(step, {})}},
            notes={**record.notes, step: (*about.notes, *notes)},
            inputs={**record.inputs, **about.inputs},
            made_at={**record.made_at, **made_at},
        )
    write_run(work.path("run"), record)
