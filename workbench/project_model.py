"""The only state of the window: one open project, its undo history, and how it is kept on disk."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from enum import StrEnum
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtGui import QUndoCommand, QUndoStack

from core.errors import InputError
from core.files.project.data import Done, Project, ProjectFile, new_project
from core.files.project.folder import (
    can_be_saved,
    create_project,
    read_project,
    recoverable,
    remove_autosave,
    with_own_sources_relative,
    write_autosave,
    write_project,
)
from core.files.project.lock import ProjectLock, lock_owner, take_lock
from core.files.project.witness import PEOPLE, Signed, Written, unwitnessed, witnessed
from core.files.step_graph import CALIBRATED
from core.messages import Message
from core.wing import AUDIT, INSTALL_ALL
from workbench.language import language_name
from workbench.step_state import StepState, step_states

AUTOSAVE_MS = 1000
"""An edit is on disk at most so long after it was made."""
SAVE_MS = 10_000
"""It is saved, as by hand, at most so long after it was made; what was measured is saved at once."""
KEEP_S = 600.0
"""What is saved by itself leaves a version in backups no more often than this."""


class Access(StrEnum):
    """Access to an opened project: to change it alone; the same, taken over from another; or read only."""

    ALONE = "alone"
    TAKE_OVER = "take over"
    READ_ONLY = "read only"


class Edit(QUndoCommand):
    """Change of the project by the user: the whole project is replaced, so nothing can be half undone.

    Edits with the same `merge_key` in a row become one.

    Parameters
    ----------
    label
        What the Undo menu calls it: "leave out view03".
    before, after
        The whole project before and after.
    show
        Called with the project to be in force.
    """

    def __init__(
        self, label: str, before: Project, after: Project, show: Callable[[Project], None], merge_key: str = ""
    ) -> None:
        super().__init__(label)
        self.before, self.after, self.merge_key = before, after, merge_key
        self._show = show

    def redo(self) -> None:
        self._show(self.after)

    def undo(self) -> None:
        self._show(self.before)

    def id(self) -> int:
        return hash(self.merge_key) & 0x3FFFFFFF if self.merge_key else -1

    def mergeWith(self, other: QUndoCommand) -> bool:
        if not isinstance(other, Edit) or not self.merge_key or other.merge_key != self.merge_key:
            return False
        self.after = other.after
        if self.after == self.before:
            self.setObsolete(True)
        return True


class EditGuard:
    """Guard of changes in the window: what may be changed, and by whom. This one lets everything pass, by nobody."""

    keeps_people = False
    """Whether it asks for people's roles: without such a guard a project that names people is read-only."""
    signed_in: Signed | None = None
    """Who has signed in, and changes the project."""

    def read(self, folder: Path | None) -> Callable[[], None]:
        """Read what holds in the project in `folder`, and return what puts it in force; None: no project.

        Raises
        ------
        InputError
            If it cannot be read: the project is not opened then.
        """
        return lambda: None

    def reason(self, label: str, before: ProjectFile, after: Project) -> str | None:
        """Return the reason for the edit called `label`, "" where it needs none; None: it is not to be made."""
        return ""

    def stay_signed_in(self, person: Signed | None) -> None:
        """Keep `person`, who was at the last project, signed in where that person may."""

    def may_leave_operator_mode(self) -> bool:
        """Whether all pages may be shown again; asks who wants that where not everybody may."""
        return True


class ProjectModel(QObject):
    """State of the program: project (choices of the user; undoable) and results (facts, never undone)."""

    opened = Signal()
    leaving = Signal()
    """The project is about to be saved and closed: stop what records. It is closed once `recordings_over` has come."""

    recordings_over = Signal()
    """The last of the recordings that were going on is over, and in the project."""

    changed = Signal(object, object)
    results_changed = Signal()
    modified = Signal(bool)
    failed = Signal(object)
    """The InputError that kept an autosave from being written."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.folder: Path | None = None
        self._file = ProjectFile(new_project(""))
        self._saved: ProjectFile | None = None
        self._complaint = ""
        self._why = ""
        self.guard = EditGuard()
        """A wing may put another one in its place."""
        self._lock: ProjectLock | None = None
        self._access = Access.ALONE
        self._states_of: tuple[ProjectFile | None, str] = None, ""
        self._states: Mapping[str, StepState] = {}
        self._accepted: dict[tuple[str, str], Done] = {}
        self._recording: set[QObject] = set()
        self.undo_stack = QUndoStack(self)
        self._autosave = QTimer(self)
        self._autosave.setSingleShot(True)
        self._autosave.setInterval(AUTOSAVE_MS)
        self._autosave.timeout.connect(self.autosave)
        self._save = QTimer(self)
        self._save.setSingleShot(True)
        self._save.setInterval(SAVE_MS)
        self._save.timeout.connect(self.save_by_itself)

    @property
    def project(self) -> Project:
        """Project that is open, as it is now; an empty one if none is open."""
        return self._file.project

    @property
    def results(self) -> Mapping[str, Done]:
        """Result of each step that was done, by the step's name."""
        return self._file.results

    @property
    def file(self) -> ProjectFile:
        """Project and results together, as they would be saved now."""
        return self._file

    @property
    def states(self) -> Mapping[str, StepState]:
        """State of each step on the rail, by the step's name."""
        file, language = self._states_of
        if file is not self._file or language != language_name():
            self._states, self._states_of = step_states(self.project, self.results), (self._file, language_name())
        return self._states

    @property
    def is_open(self) -> bool:
        """Whether a project is open."""
        return self.folder is not None

    @property
    def is_recording(self) -> bool:
        """Whether a live recording for the project is running."""
        return bool(self._recording)

    @property
    def is_modified(self) -> bool:
        """Whether the project differs from its project.json, so that it has to be saved."""
        return self.is_open and self._file != self._saved

    @property
    def is_read_only(self) -> bool:
        """Whether the open project cannot be changed on the disk: open elsewhere, gone, or write-protected."""
        return self.folder is not None and (not can_be_saved(self.folder) or self.why_read_only() is not None)

    def why_read_only(self) -> InputError | None:
        """Return the error that says why the open project cannot be changed on the disk; None if it can."""
        if self.folder is None:
            return None
        if (refused := self.why_wing_missing(self.folder)) is not None:
            return refused
        if self._access is Access.READ_ONLY:
            return InputError(
                Message("project.opened_read_only", "is open read only: nothing here is saved"),
                where=self.folder,
                todo=Message("advice.go_on_in_copy", "go on in a copy (File, Save a copy)"),
            )
        try:
            if self._lock is not None:
                self._lock.check()
        except InputError as error:
            return error
        return None

    def why_wing_missing(self, folder: Path) -> InputError | None:
        """Return the error that a wing is missing without which a project is changed in no copy either; else None."""
        if (refused := unwitnessed(folder)) is not None:
            return refused
        if self.guard.keeps_people or not (folder / PEOPLE).exists():
            return None
        what = Message(
            "project.unguarded",
            "nothing of it can be changed in the window, as {people} says who may change what, and the window's wing "
            "{name}, which asks who has signed in, is not there or has failed",
            people=PEOPLE,
            name=AUDIT,
        )
        return InputError(what, where=folder, todo=INSTALL_ALL)

    def create(self, folder: Path, project: Project) -> None:
        """Make a new project in `folder` and open it.

        Raises
        ------
        InputError
            If there is a project already, or nothing can be written there.
        """
        if (folder / "project.json").exists():
            raise InputError(
                Message("project.there_already", "there is a project already"),
                where=folder,
                todo=Message("project.choose_name", "choose another name, or open it"),
            )
        file = with_own_sources_relative(folder, ProjectFile(project))
        create_project(folder, file)
        self._take(folder, file, saved=file, access=Access.ALONE)

    def open(
        self,
        path: Path,
        *,
        recover: bool = False,
        version: ProjectFile | None = None,
        access: Access = Access.ALONE,
    ) -> None:
        """Open the project in a folder as saved, or, with `recover`, as autosaved, or as in `version`.

        Raises
        ------
        ProjectInUse
            If somebody has it open, unless `access` says that it is to be taken over, or only looked at.
        InputError
            If there is none, or it is damaged or of a newer program; neither matters with a `version`.
        """
        folder = path.parent if path.name == "project.json" else path
        access = Access.READ_ONLY if self.why_wing_missing(folder) is not None else access
        saved = None
        if version is None:
            version = saved = read_project(folder)
        if saved is None:
            self._take(folder, version, saved=None, access=access)
            self._autosave.start()
            return
        rescued = recoverable(folder) if recover else None
        self._take(folder, rescued or version, saved=saved, access=access)
        if access is not Access.READ_ONLY and not recover:
            remove_autosave(folder)

    def close(self) -> None:
        """Close the project, which is not saved."""
        self._autosave.stop()
        self._save.stop()
        self._take(None, ProjectFile(new_project("")), saved=None, access=Access.READ_ONLY)

    def edit(self, label: str, after: Project, merge_key: str = "") -> None:
        """Replace the project by `after` as one undoable edit called `label`; an equal project is no edit.

        Nor if the guard does not let it pass, who says why.
        """
        if after == self.project:
            return
        why = self.guard.reason(label, self._file, after)
        if why is None:
            self.changed.emit(self.project, self.project)  # editors show again what is in force
            return
        self.undo_stack.push(Edit(label, self.project, after, self._show, merge_key))
        if why:
            self._why = why
            self.save_by_itself()  # the reason is nowhere else

    def record(self, step: str, done: Done | None) -> None:
        """Record the result of a step; None records that there is none any more."""
        self.record_all({step: done})

    def record_all(self, done: Mapping[str, Done | None]) -> None:
        """Record the results of several steps at once; None for each that has none any more."""
        kept = {name: result for name, result in self.results.items() if name not in done}
        new = {name: result for name, result in done.items() if result is not None}
        self._file = replace(self._file, results={**kept, **new})
        for step, result in new.items():
            self._remember(step, result)
        self._touched()
        self.save_by_itself()
        self.results_changed.emit()

    def recording_begins(self, who: QObject) -> None:
        """Register the object `who` as recording for the project, until `recording_ends`."""
        self._recording.add(who)

    def recording_ends(self, who: QObject) -> None:
        """Unregister the object `who`, as its recording is in the project now."""
        self._recording.discard(who)
        if not self._recording:
            self.recordings_over.emit()

    def save(self) -> None:
        """Write project.json, and keep the five versions before it as backups.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        self._write(keep_s=0.0)
        self.undo_stack.setClean()

    def save_by_itself(self) -> None:
        """Save the project automatically; an error is shown once, not at each attempt."""
        if self.is_modified:
            self._tell_once(lambda: self._write(keep_s=KEEP_S))

    def autosave(self) -> None:
        """Write the unsaved project beside project.json, for recovery after a crash."""
        self._autosave.stop()
        self._tell_once(self._write_autosave)

    def _write(self, keep_s: float) -> None:
        if self.folder is None:
            return
        self._autosave.stop()
        self._save.stop()
        if (refused := self.why_read_only()) is not None:
            raise refused
        write_project(self.folder, self._file, keep_s=keep_s, why=self._why, by=self.guard.signed_in)
        self._why = ""
        remove_autosave(self.folder)
        self._saved = self._file
        self.modified.emit(False)

    def _write_autosave(self) -> None:
        if self.folder is None:
            return
        if (refused := self.why_read_only()) is not None:
            if self.is_modified:
                raise refused
        elif self.is_modified:
            write_autosave(self.folder, self._file)
        else:
            remove_autosave(self.folder)

    def _tell_once(self, write: Callable[[], None]) -> None:
        try:
            write()
            self._complaint = ""
        except InputError as error:
            if str(error) != self._complaint:  # said once, not at every edit
                self._complaint = str(error)
                self.failed.emit(error)

    def _show(self, project: Project) -> None:
        before = self.project
        self._file = replace(self._file, project=project, results=self._results_for(before, project))
        self._touched()
        self.changed.emit(before, project)

    def _results_for(self, before: Project, after: Project) -> Mapping[str, Done]:
        """What was measured, where the accepted calibrations are others: how each of them came about is a fact, too."""
        results = dict(self.results)
        for step in CALIBRATED:
            id_ = getattr(after.accepted, step)
            if id_ != getattr(before.accepted, step) and (step, id_) in self._accepted:
                results[step] = self._accepted[step, id_]
        return results

    def _remember(self, step: str, done: Done) -> None:
        """How the accepted calibration of a step came about, for when it is accepted again by undo or redo."""
        if step in CALIBRATED and (id_ := getattr(self.project.accepted, step)):
            self._accepted[step, id_] = done

    def _touched(self) -> None:
        if self.is_open:
            self._autosave.start()
            if not self._save.isActive():  # not begun anew by each edit: it would wait for a pause
                self._save.start()
            self.modified.emit(self.is_modified)

    def _take(self, folder: Path | None, file: ProjectFile, saved: ProjectFile | None, access: Access) -> None:
        lock, put_in_force = None, self.guard.read(folder)
        if folder is not None and access is not Access.READ_ONLY and can_be_saved(folder):
            if self._lock is not None and self._lock.folder == folder and access is not Access.TAKE_OVER:
                lock = self._lock  # the project that is open is opened once more
            else:
                lock = _locked(folder, take_over=access is Access.TAKE_OVER)
        if self._lock is not None and self._lock is not lock:
            self._lock.release()
        self._lock, self._access = lock, access
        self.folder, self._file, self._saved, self._complaint = folder, file, saved, ""
        self._why = ""
        put_in_force()
        self.undo_stack.clear()
        self._accepted.clear()
        for step, done in file.results.items():
            self._remember(step, done)
        self.opened.emit()
        self.modified.emit(self.is_modified)


def _locked(folder: Path, *, take_over: bool) -> ProjectLock:
    """Lock a project for this program; taking it over from another is a change that witnesses see."""
    before = lock_owner(folder)
    if before is None:
        return take_lock(folder, take_over=take_over)
    with witnessed(folder, Written("taken over", why=f"{before.owner}@{before.host}")):
        return take_lock(folder, take_over=take_over)
