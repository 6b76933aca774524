"""A project's folder: project.json with its last versions, the autosaved state, and the folders of pictures.

Layout::

    PROJECT/project.json            the project
    PROJECT/NAME.trisect            what a double click opens the project by; says nothing itself
    PROJECT/.lock.json              who has the project open
    PROJECT/.autosave.json          changes that are not saved yet; there only while a project is open, or after a crash
    PROJECT/people.json             who may do what, by names with PINs: of a wing; there only if it was set up
    PROJECT/view.json               how the surface was left in 3D, for a figure of the report
    PROJECT/audit.jsonl             who changed what and when, what was measured: of the same wing; only grows
    PROJECT/backups/                the last versions of project.json
    PROJECT/recordings/             raw frames, one folder for each recording
    PROJECT/calibrations/           every calibration that was kept
    PROJECT/results/                what was measured, as `trisect run` writes it
    PROJECT/studies/                studies that were kept, a folder for each; there only once one was
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from itertools import count
from pathlib import Path

from core.errors import InputError
from core.files.atomic import cannot_write, make_folder, remove, vanished, write_bytes, write_text
from core.files.project.data import Project, ProjectFile, ProjectInfo, Sources
from core.files.project.json_form import project_text, read_project_text
from core.files.project.keys import relocated
from core.files.project.witness import Signed, Written, unwitnessed, witnessed
from core.files.reading import resolved
from core.files.recording.recording_set import CHECK, PARTS
from core.files.recording.rig import read_rig
from core.files.results.artefact_register import register_in
from core.messages import Message

PROJECT = "project.json"
AUTOSAVE = ".autosave.json"
BACKUPS = "backups"
RESULTS = "results"
STUDIES, STUDY = "studies", "study.json"
"""The folder of studies in a project, and the file of each: a wing writes and reads it."""
OPENER = ".trisect"
"""How the file ends that a double click opens the project by: systems know what opens a file by the end of its name."""
KEPT = 5
"""So many earlier versions of project.json are kept."""

_BACKUP = re.compile(r"^project-(\d+)-\d{8}-\d{6}\.json$")
_OPENER_SAYS = "This file opens the project in its folder with Trisect; the project itself is in project.json.\n"


def is_project(path: Path) -> bool:
    """Whether `path` is the folder of a project, or the file project.json in one."""
    try:
        return (path / PROJECT).is_file() or (path.name == PROJECT and path.is_file())
    except OSError:  # a place that cannot even be looked at
        return False


def read_project(path: Path) -> ProjectFile:
    """Read the project at `path`, its folder or project.json (or a backup of that); InputError if it cannot be read.

    Raises
    ------
    InputError
        If there is none, it is damaged or of a newer program, or it has an unknown key or a wrong value; names the file
        and the field.
    """
    file = _file_of(path)
    if path.is_dir() and not file.exists():
        raise InputError(
            Message("project.not_here", "there is no {project} here", project=PROJECT),
            where=path,
            todo=Message("advice.choose_project", "choose the folder of a project"),
        )
    return read_project_text(file)


def create_project(folder: Path, file: ProjectFile) -> None:
    """Write a project into `folder`, which is made if it is missing; InputError if it cannot be written."""
    make_folder(folder)
    _write(folder, file, keep_s=0.0)


def write_project(
    folder: Path, file: ProjectFile, *, keep_s: float = 0.0, why: str = "", by: Signed | None = None
) -> None:
    """Write a project as project.json, unless it says the same already; the earlier content goes to backups.

    Parameters
    ----------
    folder
        Where the project is. If nothing of it is there any more, its disk was taken out, or it was moved: nothing is
        made in its place.
    file
        What is to be said. Folders of pictures within the project are named relative to it. `created` is kept from the
        version before, if it does not say; `saved` becomes now.
    keep_s
        Keep the version before only if none was kept within so many seconds.
    why, by
        For those who witness the change: the reason for it, and who has signed in.

    Raises
    ------
    InputError
        If the folder is gone, nothing can be written there, or a value is not what it must be.
    """
    require_project_folder(folder)
    _write(folder, file, keep_s, why, by)


def require_project_folder(folder: Path) -> None:
    """Raise InputError if `folder` has nothing of a project in it, so that no empty project is made there."""
    if not any((folder / name).exists() for name in (PROJECT, AUTOSAVE, BACKUPS)):
        raise vanished(folder)


def _write(folder: Path, file: ProjectFile, keep_s: float, why: str = "", by: Signed | None = None) -> None:
    path = folder / PROJECT
    file = with_own_sources_relative(folder, file)
    before = _readable(path)
    if before == file:
        return
    if (refused := unwitnessed(folder)) is not None:
        raise refused
    now = datetime.now().astimezone()
    created = file.created or (before.created if before else None) or now
    text = project_text(replace(file, created=created, saved=now), path)
    try:
        with witnessed(folder, Written("saved" if path.exists() else "created", before, file, text, why, by)):
            if path.exists():
                _keep(folder / BACKUPS, path, keep_s)
            write_text(path, text)
    except OSError as error:
        raise cannot_write(path, error) from error
    put_opener(folder)


def require_free(to: Path) -> None:
    """Raise InputError if there is something at `to` already, where the folder of a project is to be made."""
    if to.exists():
        raise InputError(
            Message("project.folder_taken", "is there already"),
            where=to,
            todo=Message("advice.choose_another_name", "choose another name"),
        )


def free_folder(base: Path, name: str, fits: Callable[[Path], bool] = lambda path: not path.exists()) -> Path:
    """Find the first of NAME, NAME 2, NAME 3, … in `base` for which `fits` is true; by default, that does not exist."""
    return next(path for n in count(1) if fits(path := base / (name if n == 1 else f"{name} {n}")))


def put_opener(folder: Path) -> None:
    """Write the file NAME.trisect, which opens the project, into its folder, unless there is one or it cannot be."""
    with suppress(InputError, OSError):
        if next(folder.glob(f"*{OPENER}"), None) is None:
            write_text(folder / f"{resolved(folder).name}{OPENER}", _OPENER_SAYS, sync=False)


def backups(folder: Path) -> tuple[Path, ...]:
    """List earlier versions of project.json, the newest first; :func:`read_project` reads them."""
    numbered = _numbered(folder / BACKUPS)
    return tuple(numbered[number] for number in sorted(numbered, reverse=True))


def write_autosave(folder: Path, file: ProjectFile) -> None:
    """Write a project's state beside project.json, whole or not at all; InputError if that fails."""
    require_project_folder(folder)
    path = folder / AUTOSAVE
    text = project_text(replace(file, saved=datetime.now().astimezone()), path)
    write_text(path, text, sync=False)  # outlives the program, if not the power supply; the disk need not be awaited


def remove_autosave(folder: Path) -> None:
    """Remove the autosaved state from a project's folder, if there is one; InputError if it cannot be removed."""
    remove(folder / AUTOSAVE)


def recoverable(folder: Path) -> ProjectFile | None:
    """Read the autosaved state of a project; None unless it differs from project.json and is not older.

    A state that cannot be read counts as none: there is nothing to recover from it. Where project.json itself cannot be
    read, the autosaved state is all there is.
    """
    autosaved, saved = _readable(folder / AUTOSAVE), _readable(folder / PROJECT)
    if autosaved is None or autosaved == saved:
        return None
    if saved is None or saved.saved is None or autosaved.saved is None:
        return autosaved
    return autosaved if autosaved.saved >= saved.saved else None


@dataclass(frozen=True, slots=True)
class Version:
    """Earlier state of a project that can be read; `autosaved` tells it from one of the last saved ones."""

    path: Path
    file: ProjectFile
    autosaved: bool


def rescues(folder: Path) -> tuple[Version, ...]:
    """List the states to rescue a project from: autosaved one and newest readable backup, the newer first."""
    autosaved = _readable(folder / AUTOSAVE)
    found = [] if autosaved is None else [Version(folder / AUTOSAVE, autosaved, autosaved=True)]
    saved = ((path, file) for path in backups(folder) if (file := _readable(path)) is not None)
    if (newest := next(saved, None)) is not None:
        found.append(Version(*newest, autosaved=False))
    return tuple(sorted(found, key=_age, reverse=True))


def can_be_saved(folder: Path) -> bool:
    """Whether the folder of the project can be written to, by its permissions; nothing is written to find out."""
    return os.access(folder, os.W_OK | os.X_OK)


def stored_source(project_folder: Path, pictures: Path) -> str:
    """Make the path by which project.json states a folder of pictures: relative if within the project, else full."""
    full = resolved(pictures)
    own = resolved(project_folder)
    return full.relative_to(own).as_posix() if full.is_relative_to(own) else full.as_posix()


def with_own_sources_relative(project_folder: Path, file: ProjectFile) -> ProjectFile:
    """Make those paths of picture folders in a project relative that lie within the project's folder."""
    named = (stored for stored in asdict(file.project.sources).values() if stored and Path(stored).is_absolute())
    moved = {stored: stored_source(project_folder, Path(stored)) for stored in named}
    return relocated(file, {full: name for full, name in moved.items() if not Path(name).is_absolute()})


def source_folder(project_folder: Path, stored: str) -> Path | None:
    """Return the full path of the folder of pictures that project.json states as `stored`; None for ""."""
    return project_folder / stored if stored else None


def results_folder(project_folder: Path) -> Path:
    """Return the path of the folder in a project that holds its results, there or not."""
    return project_folder / RESULTS


def study_path(project_folder: Path, id_: str) -> Path:
    """Return the path of the file of the study `id_` in a project, there or not."""
    return project_folder / STUDIES / id_ / STUDY


def results_in(path: Path) -> Path:
    """Return the folder of results of the project at `path`; `path` itself if it is no project."""
    if is_project(path) and not path.is_dir():
        path = path.parent
    return results_folder(path) if is_project(path) or results_folder(path).is_dir() else path


def sources_of_set(folder: Path) -> Sources:
    """Return the full paths of the folders of pictures in a recording set, by part; "" for a part that is not there."""
    folders = {part: resolved(folder) / part for part in (*PARTS, CHECK)}
    return Sources(**{part: path.as_posix() if path.is_dir() else "" for part, path in folders.items()})


def project_from_set(folder: Path, name: str) -> Project:
    """Make a project that measures a recording set where it lies; the part is named after the set.

    Raises
    ------
    InputError
        If rig.toml is missing, or it or artefacts.toml is wrong.
    """
    rig = read_rig(folder / "rig.toml")
    stated = replace(rig, unstated=frozenset())  # the window shows the paper's where rig.toml says nothing
    info, artefacts = ProjectInfo(name=name, part=resolved(folder).name), register_in(folder)
    return Project(info, stated, sources_of_set(folder), artefacts=tuple(artefacts.values()))


def _file_of(path: Path) -> Path:
    return path / PROJECT if path.is_dir() else path


def _readable(path: Path) -> ProjectFile | None:
    """What a file says; None if it is not there or cannot be read."""
    try:
        return read_project_text(path)
    except InputError:
        return None


def _age(version: Version) -> float:
    return version.file.saved.timestamp() if version.file.saved is not None else 0.0


def _keep(folder: Path, path: Path, keep_s: float) -> None:
    """Copy project.json into the folder of its versions, and let go of the oldest ones."""
    data = path.read_bytes()
    make_folder(folder)
    numbered = _numbered(folder)
    newest = max(numbered, default=0)
    if newest and 0 <= time.time() - numbered[newest].stat().st_mtime < keep_s:
        return
    if newest and numbered[newest].read_bytes() == data:
        return  # kept by an attempt to save that failed afterwards
    saved = datetime.fromtimestamp(path.stat().st_mtime).astimezone()
    copy = folder / f"project-{newest + 1:05d}-{saved:%Y%m%d-%H%M%S}.json"
    write_bytes(copy, data, sync=False)
    for _, oldest in sorted({**numbered, newest + 1: copy}.items())[:-KEPT]:
        remove(oldest)


def _numbered(folder: Path) -> dict[int, Path]:
    if not folder.is_dir():
        return {}
    found = ((path, _BACKUP.match(path.name)) for path in folder.iterdir())
    return {int(match[1]): path for path, match in found if match}
