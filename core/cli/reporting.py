"""What the commands of reports and hand-overs do: the choices, the report, files for others, cameras of others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

from core.cli import output
from core.cli.measuring import Shown
from core.errors import InputError
from core.files.export_list import EXPORTS
from core.files.recording_set import open_set
from core.files.report_template import read_report_template, section_set
from core.pipeline.handing_over import export_results, import_camera, with_template
from core.pipeline.report_step import report_step
from core.pipeline.reported_inspection import with_studies
from core.pipeline.workspace import Workspace
from core.progress import Progress
from core.report.content import ReportContent
from core.report.template import LANGUAGES, PAPERS, Language, Paper


@dataclass(frozen=True, slots=True)
class ReportOptions:
    """What the command line says of a report; nothing: as the template has it, or as usual."""

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
        """The content with all of it. InputError if a choice is not one, or the template cannot be read."""
        language, paper = _one_of(self.language, LANGUAGES, "--language"), _one_of(self.paper, PAPERS, "--paper")
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
            language=cast(Language, language or content.language),
            paper=cast(Paper, paper or content.paper),
        )


def run_report(folder: Path, out: Path, chosen: ReportOptions, progress: Progress) -> Shown:
    """Report step."""
    work = Workspace.open(open_set(folder), out, chosen.part)
    report_step(work, progress, chosen.said)
    notes = tuple(work.record().notes.get("report", ()))
    return Shown([], {}, notes, {"report": work.path("report")})


def run_export(out: Path, formats: Sequence[str], to: Path | None, chosen: ReportOptions, progress: Progress) -> Shown:
    """Results in the formats of others; InputError if there is no such format, or nothing to write from."""
    kinds = [name.strip() for names in formats for name in names.split(",") if name.strip()]
    if not kinds:
        raise InputError("no format is given", where="--format", todo=f"choose among {', '.join(EXPORTS)}")
    files = export_results(out, kinds, to, chosen.said, progress)
    return Shown([(EXPORTS[name].title, path.name) for name, path in files.items()], {}, (), files)


def run_import(file: Path, out: Path) -> Shown:
    """A camera of another program as camera.json."""
    calibration = import_camera(file, out)
    camera = calibration.camera
    rows = [("picture", " × ".join(map(str, camera.image_size)) + " px"), ("focal length", f"{camera.focal:.2f} px")]
    values = output.camera_json(calibration)
    return Shown(rows, values, calibration.notes, {"camera": out / "camera.json"})


def _one_of(chosen: str, known: Sequence[str], where: str) -> str:
    """One of `known`, in any case of letters; nothing stays nothing."""
    by_lower = {one.lower(): one for one in known}
    if chosen and chosen.lower() not in by_lower:
        raise InputError(f'there is no "{chosen}"', where=where, todo=f"choose among {', '.join(known)}")
    return by_lower.get(chosen.lower(), "")
