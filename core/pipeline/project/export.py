"""Looking at a report before it is made, choosing how it looks, and copies of results for others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from core.calibrate.results import CameraCalibration
from core.errors import InputError
from core.files.atomic import make_folder, write_bytes
from core.files.exchange.opencv_calibration import read_opencv
from core.files.exchange.ros_camera_info import read_camera_info
from core.files.project.calibration_store import IMPORTED, store_camera
from core.files.project.data import Project, ReportChoices
from core.files.project.folder import can_be_saved, results_folder, stored_source
from core.files.project.report_template import read_report_template
from core.files.reading import file_hash, read_bytes, resolved
from core.files.results.camera_file import write_camera
from core.files.step_graph import FILES
from core.messages import Message
from core.pipeline.project.report import project_content, report_bytes
from core.pipeline.steps.export_kinds import Results, export_kind, write_export
from core.pipeline.steps.report_step import results_content
from core.pipeline.steps.workspace import staged
from core.progress import Progress, silent
from core.report.content import ReportContent
from core.report.layout.page_pictures import Pages, page_pictures
from core.report.template import ReportTemplate


def preview_report(folder: Path, project: Project, width_px: int, progress: Progress = silent) -> Pages:
    """Draw the pages of the report from the project as it is now, each (height, `width_px`, 3); nothing is written.

    Raises
    ------
    InputError
        If there is no scan among the results.
    """
    return page_pictures(report_bytes(folder, project, progress), width_px, progress)


def choose_template(folder: Path, choices: ReportChoices, path: Path | None) -> ReportChoices:
    """Set the template in `path` (None: none) in the report's choices, with paper, language and sections it names.

    What it does not name stays as it is, and everything can be chosen otherwise afterwards.

    Raises
    ------
    InputError
        If the template cannot be read.
    """
    if path is None:
        return replace(choices, template="")
    template = read_report_template(path)
    return replace(
        choices,
        hidden=choices.hidden | template.without,
        paper=template.paper or choices.paper,
        language=template.language or choices.language,
        template=stored_source(folder, path),
    )


def with_template(content: ReportContent, template: ReportTemplate) -> ReportContent:
    """Apply a template to a report's content: its words, and the paper, language and sections that it names."""
    return replace(
        content,
        template=template,
        hidden=content.hidden | template.without,
        paper=template.paper or content.paper,
        language=template.language or content.language,
    )


def export(
    folder: Path,
    project: Project,
    kind: str,
    path: Path,
    in_camera_frame: bool = False,
    progress: Progress = silent,
) -> Path:
    """Write one result of a project, a `kind` of EXPORTS, to `path` and return `path`; the file is whole or not there.

    The report is a copy of the one among the results, or made on the way where the project cannot be written to.

    Parameters
    ----------
    in_camera_frame
        Whether geometry is written as the camera sees it, instead of in the part's own frame where that is known.

    Raises
    ------
    InputError
        If the result is not there, or `path` cannot be written.
    """
    progress("writing", 0, 1)
    if kind == "pdf" and not can_be_saved(folder):
        write_bytes(path, report_bytes(folder, project, progress))
    else:
        results = Results(
            results_folder(folder),
            lambda: project_content(folder, project, progress),
            in_camera_frame=in_camera_frame,
        )
        write_export(kind, results, path, progress)
    progress("writing", 1, 1)
    return path


def export_results(
    out: Path,
    kinds: Sequence[str],
    to: Path | None = None,
    said: Callable[[ReportContent], ReportContent] | None = None,
    progress: Progress = silent,
    *,
    in_camera_frame: bool = False,
) -> dict[str, Path]:
    """Write results in the folder `out` as each of `kinds` of EXPORTS, into `to` (None: beside them); return the files.

    One that cannot be had keeps none of the others from being written; it is told when these are.

    Parameters
    ----------
    said
        Adds what people say to what was measured.
    in_camera_frame
        Whether geometry is written as the camera sees it, instead of in the part's own frame where that is known.

    Raises
    ------
    InputError
        If there is no such kind, or some of them cannot be written; says which are.
    """
    chosen = [export_kind(kind) for kind in kinds]
    folder = make_folder(to or out)
    results = Results(
        out,
        lambda: said(results_content(out)) if said else results_content(out),
        in_camera_frame=in_camera_frame,
    )
    written: dict[str, Path] = {}
    failed: dict[str, InputError] = {}
    for done, kind in enumerate(chosen):
        progress("writing", done, len(chosen))
        try:
            write_export(kind.name, results, folder / kind.file, progress)
        except InputError as error:
            failed[kind.name] = error
        else:
            written[kind.name] = folder / kind.file
    progress("writing", len(chosen), len(chosen))
    if failed:
        raise _some_failed(failed, written)
    return written


def _some_failed(failed: Mapping[str, InputError], written: Mapping[str, Path]) -> InputError:
    """The error of the one kind that could not be written, or of several; says which others are written."""
    first = next(iter(failed.values()))
    reasons = tuple(
        Message("export.kind_and_reason", "{kind} ({reason})", kind=kind, reason=error.reason)
        for kind, error in failed.items()
    )
    if written:
        what = Message(
            "export.some_not_written",
            "{names} are written, but not {reasons}",
            names=tuple(path.name for path in written.values()),
            reasons=reasons,
        )
        return InputError(what, todo=first.todo)
    if len(failed) == 1:
        return first
    return InputError(
        Message("export.none_written", "nothing could be written: {reasons}", reasons=reasons), todo=first.todo
    )


def import_camera(path: Path, out: Path) -> CameraCalibration:
    """Read a camera calibrated by OpenCV or ROS, and write it as camera.json in `out`.

    Raises
    ------
    InputError
        If it cannot be read, or is no camera that is modelled here.
    """
    calibration = _read_camera(path)
    with staged(make_folder(out), "camera") as beside:
        write_camera(beside / FILES["camera"], calibration)
    return calibration


def keep_imported_camera(folder: Path, project: Project, path: Path) -> str:
    """Store a camera calibrated by OpenCV or ROS in the project's history and return its id; see `import_camera`.

    The caller makes it the accepted one.
    """
    place = resolved(path)
    return store_camera(folder, _read_camera(path), {IMPORTED: place.as_posix()}, {path.name: file_hash(path)})


def _read_camera(path: Path) -> CameraCalibration:
    return read_opencv(path) if _of_opencv(path) else read_camera_info(path)


def _of_opencv(path: Path) -> bool:
    """Whether OpenCV wrote it, rather than ROS: the two share YAML's endings."""
    data = read_bytes(path)
    return path.suffix.lower() in (".json", ".xml") or data.startswith((b"%YAML", b"<?xml")) or b"!!opencv" in data
