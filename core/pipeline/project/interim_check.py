"""The interim check of a project: whether camera and laser are where its accepted calibrations have them."""

from __future__ import annotations

from pathlib import Path

from core.files.project.calibration_store import put_in_place
from core.files.project.data import Project
from core.files.results.check_file import InterimCheck, read_check
from core.files.results.rig_history import RigHistory
from core.pipeline.project.measuring import staged
from core.pipeline.project.workspace import part_name, project_set
from core.pipeline.steps.check_step import check_step
from core.pipeline.steps.validity import history_of
from core.pipeline.steps.workspace import FILES, Workspace
from core.progress import Progress, silent

CHECK = "check"
"""The folder in the project that its result goes to: a scan among the results stays as it is."""


def check_rig(folder: Path, project: Project, progress: Progress = silent) -> InterimCheck:
    """Check the accepted calibrations by the project's pictures of the day.

    The new result takes the place of the old one when all is done; until then, and if it is cancelled, that stays.

    Raises
    ------
    InputError
        If no calibration is accepted, or as `core.pipeline.steps.check_step.check_step`.
    """
    with staged(folder / CHECK, FILES) as beside:
        put_in_place(folder, project.accepted, beside)
        work = Workspace.open(project_set(folder, project), beside, part_name(project))
        return check_step(work, project.options, progress, project.info.air_celsius)


def show_check(folder: Path) -> InterimCheck | None:
    """The result of the project's last check; None if there is none, InputError if it is damaged."""
    path = folder / CHECK / FILES["check"]
    return read_check(path) if path.exists() else None


def check_history(project: Project) -> RigHistory:
    """Every check of the project's rig that is known on this computer; InputError if the file is damaged."""
    return history_of(project.rig, f"{project.accepted.camera}-{project.accepted.fan}")
