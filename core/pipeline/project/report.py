"""The report of a project: its results, with what people say of the job and of the report."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from core.files.project.data import Project
from core.files.project.folder import results_folder, study_path
from core.files.project.report_template import read_report_template
from core.files.project.view_file import read_view
from core.files.project.witness import Written, evidence_of, unwitnessed, witnessed
from core.files.recording.picture_reader import PictureReader
from core.findings.table import note_of
from core.pipeline.project.workspace import part_name, project_set, project_workspace
from core.pipeline.steps.brought_sections import with_studies
from core.pipeline.steps.report_step import report_content, report_step
from core.pipeline.steps.workspace import Workspace
from core.progress import Progress, silent
from core.report.content import RepeatLine, ReportContent
from core.report.pdf import build_report
from core.report.template import ReportTemplate, sections
from core.second_process import SecondProcess
from core.wing import AUDIT, studies_can_be_read


def make_report(
    folder: Path, project: Project, progress: Progress = silent, beside: SecondProcess | None = None
) -> Path:
    """Write report.pdf from the project's results and its data on the job; return its path.

    The process `beside` draws it, if there is one.

    Raises
    ------
    InputError
        If there is no scan among the results.
    """
    work = project_workspace(folder, project)
    with witnessed(folder, Written("reported")):
        return report_step(work, progress, lambda content: with_words(content, folder, project), beside)


def report_bytes(folder: Path, project: Project, progress: Progress = silent) -> bytes:
    """Make the report of the project's results, as the bytes of a PDF, without writing anything."""
    return build_report(project_content(folder, project, progress), progress)


def project_content(folder: Path, project: Project, progress: Progress = silent) -> ReportContent:
    """Collect all that is reported and exported of a project; InputError if there is no scan among the results."""
    work = Workspace(project_set(folder, project), results_folder(folder), part_name(project))  # only read from
    pictures = PictureReader(work.recording_set)
    return report_content(work, pictures, progress, lambda content: with_words(content, folder, project))


def with_words(content: ReportContent, folder: Path, project: Project) -> ReportContent:
    """Add the user's texts about the job, the studies kept and the template to a report's content.

    Raises
    ------
    InputError
        If the project's template of reports, or one of its studies, cannot be read.
    """
    info, choices = project.info, project.report
    template = read_report_template(folder / choices.template) if choices.template else ReportTemplate()
    content = _with_kept_studies(content, folder, project)
    if unwitnessed(folder) is not None:
        content = replace(content, notes=(*content.notes, note_of("plugin.trail_not_printed", name=AUDIT)))
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
            RepeatLine(
                "/".join(Path(one.scan).parts[-2:]),
                one.thickness_mm,
                one.U_mm,
                one.k,
                one.calibration_id,
                one.measured_at,
            )
            for one in project.repeats
        ),
        hidden=choices.hidden & sections().keys(),
        paper=choices.paper,
        language=choices.language or content.language,
        template=template,
        evidence=evidence_of(folder),
        view=read_view(folder),
    )


def _with_kept_studies(content: ReportContent, folder: Path, project: Project) -> ReportContent:
    """The content with the project's studies that are ticked; where no wing reads them, a note tells it."""
    kept = [one for one in project.studies if one.included]
    if kept and not studies_can_be_read():
        note = note_of("plugin.studies_not_printed", names=[one.title for one in kept])
        return replace(content, notes=(*content.notes, note))
    return with_studies(content, [study_path(folder, one.id) for one in kept])
