"""A thickness by the fixed lines alone, of a project: beside its scan, never in its place."""

from __future__ import annotations

from pathlib import Path

from core.files.atomic import make_folder
from core.files.folder_lock import alone_in
from core.files.project.calibration_store import FOLDER, put_in_place
from core.files.project.data import Project
from core.files.project.results import ProfilesSummary
from core.files.step_graph import FILES
from core.pipeline.project.measuring import record_calibrations
from core.pipeline.project.report import with_words
from core.pipeline.project.workspace import part_name, project_set
from core.pipeline.steps.profile_step import profile_step
from core.pipeline.steps.report_step import report_step
from core.pipeline.steps.workspace import Workspace, staged
from core.progress import Progress, silent
from core.settings.options import StatedTilt

PROFILES = "profiles"
"""The folder in the project that its results go to."""


def measure_profiles(
    folder: Path, project: Project, tilt: StatedTilt | None = None, progress: Progress = silent
) -> ProfilesSummary:
    """Measure a step by the project's pictures of the fan alone with the accepted calibrations, and report it.

    New results take the place of old ones in PROFILES when all is done; those of the scan stay as they are.

    Raises
    ------
    InputError
        If no calibration is accepted, or as `core.pipeline.steps.profile_step.profile_step`.
    """
    found, results = project_set(folder, project), folder / PROFILES
    with alone_in(make_folder(results)), staged(results, "profile", FILES) as beside:
        put_in_place(folder, project.accepted, beside)
        work = Workspace.open(found, beside, part_name(project), folder / FOLDER)
        record_calibrations(work, folder, project)
        measured = profile_step(work, project.options.for_scan, tilt, progress)
        report_step(work, progress, lambda content: with_words(content, folder, project))
        notes = work.record().all_notes
    return ProfilesSummary(measured.gauge, measured.pictures, notes, results / FILES["report"])
