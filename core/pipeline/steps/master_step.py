"""A master block as it was measured: taken from the results of a project, or from a folder of results."""

from __future__ import annotations

from pathlib import Path

from core.errors import InputError
from core.files.project.folder import is_project, read_project, results_folder, results_in
from core.files.results.folder_results import read_results
from core.inspect.causes import Cause
from core.inspect.plan.conditions import Master
from core.inspect.plan.kinds import expands
from core.messages import Message
from core.pipeline.steps.workspace import read_calibration
from core.progress import Progress, silent


def measured_master(
    folder: Path, certified_mm: float | None, project: Path | None = None, progress: Progress = silent
) -> Master:
    """Read a master's measured length nearest to the certified one, with its budget and what keeps it from proof.

    Parameters
    ----------
    folder
        A project's, or one of results.
    certified_mm
        Its length by the certificate; None: the first length there is.
    project
        Whose part is to be compared with it: whether both were measured with one calibration is looked up there.
    progress
        Called with what is being done; may raise Cancelled.

    Raises
    ------
    InputError
        If there is no length among the results, or they are damaged.
    """
    progress("results", 0, 1)
    results = results_in(folder)
    found = read_results(results)
    rows = found.inspected if found.thickness is None else (*found.inspected, found.thickness)
    lengths = [one for one in rows if expands(one)]
    if not lengths:
        raise InputError(
            Message("inspection.no_length_measured", "no length was measured in it"),
            where=folder,
            todo=Message("advice.choose_masters_project", "choose the project in which the master was measured"),
        )
    certified = lengths[0].value if certified_mm is None else certified_mm
    row = min(lengths, key=lambda one: abs(one.value - certified))
    name = folder.name
    if is_project(folder):
        info = read_project(folder).project.info
        name = " ".join(part for part in (info.part or info.name, info.serial) if part) or name
    same = project is None or read_calibration(results).id == read_calibration(results_folder(project)).id
    budget = tuple((one.source, one.u_mm) for one in row.budget)
    known = budget or ((Cause.MASTER_MEASURED, row.u),)
    return Master(name, certified, 0.0, row.value, known, (), same, row.doubts)
