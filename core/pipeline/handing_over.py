"""Looking at a report before it is made, and copies of results for others."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Literal

from core.errors import InputError
from core.files.atomic import write_bytes
from core.files.csv_file import write_points_csv
from core.files.pictures import read_bytes
from core.files.ply import read_cloud, read_mesh
from core.files.project_data import Project
from core.files.project_rescue import can_be_saved
from core.files.stl import write_stl
from core.pipeline.project_steps import report_bytes, results_folder
from core.pipeline.workspace import FILES
from core.progress import Progress, silent
from core.report.page_pictures import Pages, page_pictures

Kind = Literal["pdf", "cloud", "mesh", "stl", "csv", "json"]
"""What can be handed over: report, cloud and mesh as PLY, mesh as STL, points as CSV, the thickness as JSON."""

_COPIED = {"pdf": "report", "cloud": "cloud", "mesh": "mesh", "json": "gauge"}


def preview_report(folder: Path, project: Project, width_px: int, progress: Progress = silent) -> Pages:
    """The pages of the report as they would be now, each (height, `width_px`, 3); the results stay as they are.

    Raises
    ------
    InputError
        If there is no scan among the results.
    """
    return page_pictures(report_bytes(folder, project, progress), width_px, progress)


def export(folder: Path, project: Project, kind: Kind, path: Path, progress: Progress = silent) -> Path:
    """Write a copy of a result to `path` and return it; the file appears whole or not at all.

    The report of a project that cannot be written to is made on the way: it cannot be among the results.

    Raises
    ------
    InputError
        If the result is not there, or `path` cannot be written.
    """
    progress("writing", 0, 1)
    results = results_folder(folder)
    if kind == "pdf" and not can_be_saved(folder):
        write_bytes(path, report_bytes(folder, project, progress))
    elif kind in _COPIED:
        source = results / FILES[_COPIED[kind]]
        if not source.exists():
            raise InputError("is not there", where=source, todo="do the step that makes it first")
        if source.resolve() != path.resolve():
            write_bytes(path, read_bytes(source))
    else:
        write: dict[str, Callable[[], None]] = {
            "stl": lambda: write_stl(path, read_mesh(results / FILES["mesh"])),
            "csv": lambda: write_points_csv(path, read_cloud(results / FILES["cloud"]).cloud),
        }
        write[kind]()
    progress("writing", 1, 1)
    return path
