"""Which state of a project is opened, where there is more than one: the one question that is asked then."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from PySide6.QtWidgets import QWidget

from core.errors import InputError
from core.files.project.changes import Change, differences
from core.files.project.data import ProjectFile
from core.files.project.folder import Version, read_project, recoverable, rescues
from core.files.project.json_form import NewerProject
from core.files.project.lock import lock_owner
from core.files.project.witness import unwitnessed
from core.messages import visible
from workbench.language import named, time_of, tr
from workbench.project_model import Access
from workbench.views import ask

SHOWN, LONGEST = 8, 40
"""Changes that are shown before one is asked to choose, and characters of a value."""


@dataclass(frozen=True, slots=True)
class StateChoice:
    """Choice of the state that `ProjectModel.open` opens: autosaved, an earlier `version`, or neither: saved."""

    recover: bool = False
    version: ProjectFile | None = None


def choose_access(parent: QWidget, folder: Path) -> Access | None:
    """Ask how to open a project if it is open elsewhere; None if they cancel. READ_ONLY where it has no witness."""
    if unwitnessed(folder) is not None:
        return Access.READ_ONLY
    holder = lock_owner(folder)
    if holder is None:
        return Access.ALONE
    text = tr(
        "{name} is open elsewhere: by {owner} on {host} since {time}. Whoever takes it over has it alone: what is "
        "changed over there from then on is not saved.",
        name=folder.name,
        owner=holder.owner,
        host=holder.host,
        time=time_of(holder.since),
    )
    answers = [tr("Open read only"), tr("Take over"), tr("Do not open")]
    chosen = ask.ask(parent, tr("Project in use"), text, answers, harmless=True)
    return (Access.READ_ONLY, Access.TAKE_OVER, None)[chosen]


def choose_state(parent: QWidget, folder: Path) -> StateChoice | None:
    """Ask whether to open a project as saved, as autosaved, or as a backup; None if the user cancels.

    Asks where there are changes autosaved before a crash, or where project.json is damaged and something else is not.

    Raises
    ------
    InputError
        If there is no state that can be read, or the project is of a newer program.
    """
    try:
        saved = read_project(folder)
    except NewerProject:
        raise
    except InputError as error:
        versions = rescues(folder)
        if not versions:
            raise
        return _ask_for_version(parent, folder, error, versions)
    recovered = recoverable(folder)
    if recovered is None or recovered == saved:
        return StateChoice()
    return _ask_for_recovery(parent, folder, saved, recovered)


def _ask_for_version(
    parent: QWidget, folder: Path, error: InputError, versions: tuple[Version, ...]
) -> StateChoice | None:
    text = tr(
        "{path} cannot be read: {why}. There are earlier states of the project; the damaged file is kept in backups.",
        path=folder / "project.json",
        why=error.what,
    )
    answers = [_in_words(version) for version in versions]
    chosen = ask.ask(parent, tr("Damaged project"), text, [*answers, tr("Do not open")])
    return StateChoice(version=versions[chosen].file) if chosen < len(versions) else None


def _ask_for_recovery(parent: QWidget, folder: Path, saved: ProjectFile, recovered: ProjectFile) -> StateChoice | None:
    text = tr(
        "{name} was not closed properly: there are unsaved changes of {time}. "
        "What was saved at {saved} differs in:\n{changes}",
        name=folder.name,
        time=_time(recovered),
        saved=_time(saved),
        changes=_changes(differences(saved, recovered)),
    )
    answers = [tr("Recover the changes"), tr("Open the saved state"), tr("Do not open")]
    chosen = ask.ask(parent, tr("Recover the project"), text, answers, harmless=True)
    return StateChoice(recover=chosen == 0) if chosen < 2 else None


def _changes(changes: tuple[Change, ...]) -> str:
    """The first few, a line each: the field, and what it was and is; of a result only which one."""
    lines = [
        one.field if one.field.startswith("results.") else named(one.field, f"{_short(one.old)} → {_short(one.new)}")
        for one in changes[:SHOWN]
    ]
    if len(changes) > SHOWN:
        lines.append(tr("and {n} more", n=len(changes) - SHOWN))
    return "\n".join(lines)


def _short(value: str) -> str:
    return visible(value if len(value) <= LONGEST else f"{value[: LONGEST - 1]}…") or "–"


def _in_words(version: Version) -> str:
    time = _time(version.file)
    return tr("Unsaved changes of {time}", time=time) if version.autosaved else tr("Backup of {time}", time=time)


def _time(file: ProjectFile) -> str:
    return time_of(file.saved) if file.saved else tr("an unknown time")
