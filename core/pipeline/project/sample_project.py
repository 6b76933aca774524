"""The embedded sample as a finished project, to look around in."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

from core.errors import InputError
from core.files.atomic import cannot_write, make_folder, remove_leftovers
from core.files.project.data import Accepted, Done, Project, ProjectFile
from core.files.project.folder import create_project, project_from_set
from core.files.project.keys import finished
from core.messages import Message, label
from core.pipeline.compile_ahead import compile_ahead
from core.pipeline.project.calibration import (
    accept_camera,
    accept_fan,
    find_poses,
    find_views,
    solve_poses,
    solve_views,
)
from core.pipeline.project.measuring import measure_scan
from core.pipeline.project.report import make_report
from core.progress import Progress, silent
from core.simulate.sample import sample_folder, sample_set


def sample_project(folder: Path, progress: Progress = silent) -> Path:
    """Make the sample project in `folder`, every step done, and return the folder.

    It is made beside and put in place whole. The pictures stay in the user's cache, where `trisect demo` keeps them.

    Raises
    ------
    InputError
        If there is something in the folder already, or nothing can be written there.
    """
    if folder.exists():
        raise InputError(
            Message("project.folder_not_empty", "there is something already"),
            where=folder,
            todo=Message("advice.choose_another_name", "choose another name"),
        )
    for place in (folder, sample_folder()):
        remove_leftovers(place)
    compile_ahead(progress)
    pictures = sample_set(progress)
    make_folder(folder.parent)
    try:
        with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=folder.parent) as beside:
            made = make_folder(Path(beside) / "project")
            create_project(made, finished_project(made, _described(project_from_set(pictures, "Sample")), progress))
            made.rename(folder)
    except OSError as error:
        raise cannot_write(folder, error) from error
    return folder


def clear_unfinished(folder: Path) -> None:
    """Remove what is left of a sample project that was being made in `folder` by a process that has been ended."""
    remove_leftovers(folder, quiet_s=0.0)


def finished_project(folder: Path, project: Project, progress: Progress = silent) -> ProjectFile:
    """Do every step of a project, accepting each calibration: what a technician does who presses Next six times.

    Raises
    ------
    InputError
        If the pictures do not suffice for a step.
    """
    results: dict[str, Done] = {}

    def done(step: str) -> None:
        results[step] = finished(step, project, results)

    camera = solve_views(folder, project, find_views(folder, project, progress), progress)
    project = replace(project, accepted=Accepted(camera=accept_camera(folder, project, camera)))
    done("camera")
    poses = find_poses(folder, project, progress)
    fan = solve_poses(folder, project, poses, progress)
    kept = accept_fan(folder, project, fan, poses)
    project = replace(project, accepted=replace(project.accepted, fan=kept))
    done("planes")
    summary = measure_scan(folder, project, progress)
    done("scan")
    if summary.gauge is not None:
        done("inspect")
    make_report(folder, project, progress)
    done("report")
    return ProjectFile(project, results)


def _described(project: Project) -> Project:
    info = replace(
        project.info,
        name="Sample",
        part="Gauge block 50 mm",
        serial="simulated",
        operator="Trisect",
        laboratory="Simulated rig",
        air_celsius=20.0,
        part_celsius=20.0,
        notes=label("Every picture of this project is rendered: camera, lasers, speckle and noise are simulated."),
    )
    return replace(project, info=info)
