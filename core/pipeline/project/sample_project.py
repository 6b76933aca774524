"""The embedded sample as a finished project, to look around in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from core.errors import InputError
from core.files.atomic import folder_beside, make_folder, remove_leftovers
from core.files.project.data import Project, ProjectFile
from core.files.project.folder import create_project, project_from_set
from core.held_files import rename
from core.messages import Message
from core.pipeline.compile_ahead import compile_ahead
from core.pipeline.project.whole import measure_all
from core.progress import Progress, silent
from core.simulate.sample import sample_folder, sample_set
from core.translations import language


def sample_project(folder: Path, speaks: str = "en", progress: Progress = silent) -> Path:
    """Make the sample project in `folder`, every step done, and return the folder.

    What it says of itself is in the language called `speaks`. It is made beside and put in place whole. The pictures
    stay in the user's cache, where `trisect demo` keeps them.

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
    remove_leftovers(folder)
    unmeasured = sample_to_measure(speaks, progress=progress)
    with folder_beside(folder) as beside:
        made = make_folder(beside / "project")
        create_project(made, finished_project(made, unmeasured, progress))
        rename(made, folder)
    return folder


def sample_to_measure(speaks: str = "en", has_fan: bool = True, progress: Progress = silent) -> Project:
    """Make a project of the sample's pictures with nothing measured; render these pictures if they are not there.

    Without a fan the block is measured by two printed boards.

    Raises
    ------
    InputError
        If the cache folder cannot be written to.
    """
    remove_leftovers(sample_folder(has_fan))
    compile_ahead(progress)
    return _described(project_from_set(sample_set(progress, has_fan), "Sample"), language(speaks).label)


def clear_unfinished(folder: Path) -> None:
    """Remove the remains of a sample project in `folder` whose process has been ended."""
    remove_leftovers(folder, quiet_s=0.0)


def finished_project(folder: Path, project: Project, progress: Progress = silent) -> ProjectFile:
    """Do every step of a project from its pictures to its report, accepting each calibration.

    Raises
    ------
    InputError
        If that stops before the report: the pictures do not suffice, or somebody has to decide something.
    """
    whole = measure_all(folder, ProjectFile(project), progress=progress)
    if whole.stop is not None and whole.stop.page == "inspect":  # a part without a thickness has a report, too
        whole = measure_all(folder, whole.file, progress=progress)
    if whole.stop is not None:
        raise InputError(Message("sample.not_finished", "not every step could be done ({why})", why=whole.stop.why))
    return whole.file


def _described(project: Project, words: Callable[[str], str]) -> Project:
    info = replace(
        project.info,
        name=words("Sample"),
        part=words("Gauge block 50 mm"),
        serial=words("simulated"),
        operator="Trisect",
        laboratory=words("Simulated rig"),
        air_celsius=20.0,
        part_celsius=20.0,
        notes=words("Every picture of this project is rendered: camera, lasers, speckle and noise are simulated."),
    )
    return replace(project, info=info)
