"""What is done with results: inspection, surface, report, files for other programs, cameras of others."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

from rich.table import Table

from core.cli import output
from core.cli.language import text_of, tr
from core.cli.measuring import Shown, alone_with, exit_code, print_cache_note
from core.cli.options import ExitCode, one_of
from core.errors import InputError
from core.files.atomic import make_folder
from core.files.folder_lock import alone_in
from core.files.plan.plan_file import read_plan
from core.files.project.report_template import read_report_template, section_set
from core.files.results.export_list import exports
from core.files.results.folder_results import read_results
from core.files.results.inspection_file import inspection_values
from core.inspect.conformity import Verdict
from core.inspect.evaluate import Inspection
from core.messages import Message, label, visible
from core.pipeline.project.export import export_results, import_camera, with_template
from core.pipeline.steps.brought_sections import with_studies
from core.pipeline.steps.inspect_step import inspect_step
from core.pipeline.steps.mesh_step import MeshOptions, mesh_step
from core.pipeline.steps.report_step import report_step
from core.progress import Progress
from core.report.content import ReportContent
from core.report.facts.of_features import HEADS, characteristic_cells
from core.report.template import LANGUAGES, PAPERS, Paper
from core.report.wording import grouped, shown_name
from core.states import VERDICT


def run_inspect(source: Path, plan: Path, out: Path | None, progress: Progress) -> tuple[Inspection, Path | None]:
    """Measure the features of a plan on a scan; return the inspection and the file written, or None."""
    asked, folder = read_plan(plan), out or source
    if out is not None:
        make_folder(out)
    print_cache_note()
    with alone_in(folder) if folder.is_dir() else nullcontext():
        return inspect_step(source, asked, plan.parent, out, progress)


def inspection_exit_code(inspection: Inspection, written: Path | None) -> ExitCode:
    """Return the exit code of the verdict on the part; "not proven" if a feature could not be measured."""
    return ExitCode.NOT_PROVEN if inspection.problems else exit_code(_verdict_on_part(inspection, written))


def _verdict_on_part(inspection: Inspection, written: Path | None) -> Verdict:
    """Of all results in the folder it was written to."""
    return inspection.verdict if written is None else read_results(written.parent).verdict


def show_inspection(inspection: Inspection, written: Path | None, *, as_json: bool) -> None:
    """Print an inspection, and the file written if there is one; with `as_json`, as one JSON object."""
    files = {} if written is None else {"inspection": written}
    if as_json:
        values = inspection_values(inspection) | {"verdict": _verdict_on_part(inspection, written)}
        output.print_json({**values, "files": output.files_json(files)})
        return
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for name in (label("characteristic"), *HEADS):
        table.add_column(
            text_of(name), justify="left" if name in ("characteristic", VERDICT) else "right", overflow="fold"
        )
    words = output.words()
    for row in inspection.characteristics:
        table.add_row(*map(visible, (shown_name(row, words), *characteristic_cells(row, words))))
    output.console().print(table)
    output.print_rows([], (*inspection.problems, *inspection.notes), files)


def run_mesh(
    results: Path,
    formats: Sequence[str],
    options: MeshOptions,
    to: Path | None,
    progress: Progress,
    *,
    in_camera_frame: bool,
) -> Shown:
    """Prepare the mesh of a scan and write it in `formats`, of which one may name several, joined by commas."""
    names = [name.strip() for one in formats for name in one.split(",") if name.strip()]
    made, written = mesh_step(results, names, options, to or results, progress, in_camera_frame=in_camera_frame)
    filled = int(made.mesh.filled.sum())
    rows = [(tr("triangles"), grouped(len(made.mesh.triangles)))]
    if options.fill_mm:
        rows.append((tr("of them filled"), tr("{n:,}, marked where the format can", n=filled)))
    if options.triangles or options.error_mm:
        rows.append(
            (
                tr("error"),
                tr(
                    "{largest:.3f} mm at most, {most:.3f} mm for 95 % of the vertices",
                    largest=made.largest_mm,
                    most=made.most_mm,
                ),
            )
        )
        rows.append((tr("outer edge"), tr("moved by up to {edge:.3f} mm", edge=made.edge_mm)))
    values = {
        "triangles": len(made.mesh.triangles),
        "filled": filled,
        "largest_error_mm": made.largest_mm,
        "error_95_mm": made.most_mm,
        "edge_error_mm": made.edge_mm,
    }
    return Shown(rows, values, files=written)


@dataclass(frozen=True, slots=True)
class ReportOptions:
    """Options of a report on the command line; "": as the template has it, or the default."""

    part: str = ""
    template: Path | None = None
    language: str = ""
    paper: str = ""
    without: Sequence[str] = ()
    serial: str = ""
    customer: str = ""
    operator: str = ""
    studies: Sequence[Path] = ()

    def said(self, content: ReportContent) -> ReportContent:
        """Return the report's content with these options applied; InputError if one is not possible."""
        language, paper = (
            one_of(self.language, LANGUAGES, "--language"),
            one_of(self.paper, PAPERS, "--paper"),
        )
        if self.template is not None:
            content = with_template(content, read_report_template(self.template))
        content = with_studies(content, self.studies)
        return replace(
            content,
            part=self.part or content.part,
            serial=self.serial,
            customer=self.customer,
            operator=self.operator,
            hidden=content.hidden | section_set(list(self.without), where="--without"),
            language=language or content.language,
            paper=cast(Paper, paper or content.paper),
        )


def run_report(folder: Path, out: Path, chosen: ReportOptions, progress: Progress) -> Shown:
    """Write report.pdf of a set's results, and return what is to be printed."""
    with alone_with(folder, out, chosen.part) as work:
        report_step(work, progress, chosen.said)
        notes = tuple(work.record().notes.get("report", ()))
    return Shown([], {}, notes, {"report": work.path("report")})


def run_export(
    out: Path,
    formats: Sequence[str],
    to: Path | None,
    chosen: ReportOptions,
    progress: Progress,
    *,
    in_camera_frame: bool,
) -> Shown:
    """Write the results in `out` in the `formats` of other programs, and return what is to be printed.

    InputError if there is no such format, or nothing to write from.
    """
    kinds = [name.strip() for names in formats for name in names.split(",") if name.strip()]
    if not kinds:
        raise InputError(
            Message("export.no_format_given", "no format is given"),
            where="--format",
            todo=Message("advice.choose_among", "choose among {choices}", choices=tuple(exports())),
        )
    files = export_results(out, kinds, to, chosen.said, progress, in_camera_frame=in_camera_frame)
    return Shown([(text_of(exports()[name].title), path.name) for name, path in files.items()], {}, (), files)


def run_import(file: Path, out: Path) -> Shown:
    """Write the camera that another program calibrated as camera.json, and return what is to be printed."""
    calibration = import_camera(file, out)
    camera = calibration.camera
    rows = [
        (tr("picture"), " × ".join(map(str, camera.image_size)) + " px"),
        (tr("focal length"), tr("{focal:.2f} px", focal=camera.focal)),
    ]
    values = output.camera_json(calibration)
    return Shown(rows, values, calibration.notes, {"camera": out / "camera.json"})
