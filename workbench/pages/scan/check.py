"""The check of camera and laser on the day: its pictures, its run, its result."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from core.calibrate.results import ProposedReadjustment
from core.files.project.data import Project
from core.files.project.keys import changed, finished, inputs_of
from core.files.results.check_file import InterimCheck
from core.files.results.rig_history import PastCheck, RigHistory
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.sources import folder_of, put_source
from workbench.work import jobs
from workbench.work.tasks import Task


class CheckStage(StrEnum):
    """Stage of the check."""

    NONE = "none"
    CHOSEN = "chosen"
    CHECKING = "checking"
    UNREADABLE = "unreadable"
    CHECKED = "checked"
    OUTDATED = "outdated"


class RigCheck(QObject):
    """Check of the accepted calibrations by pictures of the day; its result is recorded in the project.

    `look` is the last result, whatever it was made from; None if there is none, or until it is read. `history` are the
    checks of the rig so far; None until they are read.
    """

    changed = Signal()
    proposed = Signal(object)
    """What a re-adjustment would do (`ProposedReadjustment`): accept it or not."""

    look: InterimCheck | None
    history: RigHistory | None

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._task: Task | None = None
        self._problem = ("", "")
        self._readjusting: Task | None = None
        self.refusal = ""
        self._forget()

    def _forget(self) -> None:
        self.look, self.history, self._looked, self.refusal = None, None, "", ""

    @property
    def folder(self) -> Path | None:
        """Folder of the check's pictures; None if none is chosen."""
        return folder_of(self._model, "check")

    @property
    def stage(self) -> CheckStage:
        """How far the interim check is: no pictures, chosen, checking, checked, outdated or unreadable."""
        if self._task is not None:
            return CheckStage.CHECKING
        if self.problem:
            return CheckStage.UNREADABLE
        if self.look is not None:
            return CheckStage.OUTDATED if self.changed_since() else CheckStage.CHECKED
        return CheckStage.CHOSEN if self._model.project.sources.check else CheckStage.NONE

    @property
    def valid(self) -> InterimCheck | None:
        """Result of the check, if it is of the present calibrations and pictures; else None."""
        return self.look if self.stage is CheckStage.CHECKED else None

    @property
    def problem(self) -> str:
        """Reason why the last check gave no result; "" if it gave one, or the project has changed since."""
        made_of, problem = self._problem
        return problem if problem and made_of == _key(self._model.project) else ""

    @property
    def cannot_check(self) -> str:
        """Reason why nothing can be checked now; "" if something can."""
        project = self._model.project
        if self._task is not None:
            return tr("Camera and laser are being checked.")
        if self._bench.cannot_write:
            return self._bench.cannot_write
        if not project.accepted.camera:
            return tr("Accept a camera calibration first.")
        if not project.accepted.planes:
            return tr("Accept the laser planes first.")
        if not project.sources.check:
            return tr("Choose the pictures of the check first.")
        return ""

    @property
    def cannot_readjust(self) -> str:
        """Reason why camera and laser cannot be re-adjusted by the check now; "" if they can."""
        if self._readjusting is not None:
            return tr("What a re-adjustment would change is being worked out.")
        if self.valid is None:
            return tr("Check camera and laser first.")
        if self.valid.passed:
            return tr("Camera and laser are where they were calibrated: there is nothing to re-adjust.")
        return ""

    @property
    def past(self) -> PastCheck | None:
        """The check's result as it is recorded in the rig's history; None if it is not."""
        look, history = self.look, self.history
        if look is None or history is None:
            return None
        same = (look.pictures_id, look.calibration_id)
        return next((one for one in history.checks if (one.pictures_id, one.calibration_id) == same), None)

    def changed_since(self) -> tuple[str, ...]:
        """List the inputs of the check's result that have changed since it was made."""
        done = self._model.results.get("check")
        return changed(done.rests_on, inputs_of("check", self._model.project, {})) if done is not None else ()

    def use_folder(self, folder: Path) -> None:
        """Use the pictures in `folder` for the check, undoable, and check if that is possible."""
        self.cancel()
        put_source(self._model, "check", folder, tr("choose the pictures of the check"))
        self.start()

    def start(self) -> None:
        """Check camera and laser by the check's pictures, in the background."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.cannot_check:
            return
        self._problem = ("", "")
        task: Task = self._bench.run_long(
            self,
            jobs.CHECK_RIG,
            folder,
            project,
            label=tr("Check"),
            on_done=lambda look: self._checked(task, folder, project, look),
            on_failed=lambda problem: self._not_checked(task, project, text_of(problem)),
            on_cancelled=lambda: self._not_checked(task, project, ""),
        )
        self._task = task
        self.changed.emit()

    def propose_readjustment(self) -> None:
        """Compute in the background what a re-adjustment by the check would change; `proposed` is emitted with it."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.cannot_readjust:
            return
        self.refusal = ""
        task: Task = self._bench.run_long(
            self,
            jobs.PROPOSE_READJUSTMENT,
            folder,
            project,
            label=tr("Re-adjustment"),
            on_done=lambda proposal: self._worked_out(task, proposal),
            on_failed=lambda problem: self._worked_out(task, None, text_of(problem)),
            on_cancelled=lambda: self._worked_out(task, None),
        )
        self._readjusting = task
        self.changed.emit()

    def accept_readjustment(self, proposal: ProposedReadjustment) -> None:
        """Store and accept camera and laser as the proposal re-adjusts them; undoable."""
        folder, project = self._model.folder, self._model.project
        if folder is None:
            return

        def kept(id_: str) -> None:
            if folder != self._model.folder:
                return
            now = self._model.project
            after = replace(now, accepted=replace(now.accepted, planes=id_), rejected=now.rejected - {id_})
            self._model.edit(tr("re-adjust camera and laser"), after)
            done = self._model.results.get("planes")
            self._model.record("planes", finished("planes", after, self._model.results, done.at if done else None))

        self._bench.run_quick(
            self,
            jobs.ACCEPT_READJUSTMENT,
            folder,
            project,
            proposal,
            label=tr("Keeping the re-adjustment"),
            on_done=kept,
        )

    def _worked_out(self, task: Task, proposal: ProposedReadjustment | None, refusal: str = "") -> None:
        if task is not self._readjusting:
            return
        self._readjusting, self.refusal = None, refusal
        self.changed.emit()
        if proposal is not None:
            self.proposed.emit(proposal)

    def cancel(self) -> None:
        """Stop the check that runs; the earlier result stays."""
        if self._task is not None:
            self._task.cancel()

    def opened(self) -> None:
        """Stop the check that runs, and read the result of the project now open."""
        for task in (self._task, self._readjusting):
            if task is not None:
                task.cancel()
        self._task, self._problem, self._readjusting = None, ("", ""), None
        self._forget()
        self.follow()

    def follow(self) -> None:
        """Read the recorded result of the check again, as the project or its results have changed."""
        folder, done = self._model.folder, self._model.results.get("check")
        wanted = f"{folder}|{done.key}|{done.at}" if folder is not None and done is not None else ""
        if wanted == self._looked:
            return
        self._looked = wanted
        if folder is None or done is None:
            self.look = None
            return

        def read(look: InterimCheck | None) -> None:
            if self._looked == wanted:
                self.look = look
                self._read_history()
                self.changed.emit()

        self._bench.run_quick(self, jobs.SHOW_CHECK, folder, label=tr("Reading the check"), on_done=read, offers={})

    def _checked(self, task: Task, folder: Path, project: Project, look: InterimCheck) -> None:
        if task is not self._task:
            return
        self._task = None
        if folder == self._model.folder:
            done = finished("check", project, self._model.results)
            self.look, self._looked, self.refusal = look, f"{folder}|{done.key}|{done.at}", ""
            self._model.record("check", done)
            self._read_history()
        self.changed.emit()

    def _read_history(self) -> None:
        wanted, folder = self._looked, self._model.folder
        if folder is None:
            return

        def read(history: RigHistory) -> None:
            if self._looked == wanted:
                self.history = history
                self.changed.emit()

        self._bench.run_quick(
            self,
            jobs.CHECK_HISTORY,
            folder,
            self._model.project,
            label=tr("Reading the history of the rig"),
            on_done=read,
            offers={},
        )

    def _not_checked(self, task: Task, project: Project, problem: str) -> None:
        if task is self._task:
            self._task, self._problem = None, (_key(project), problem)
            self.changed.emit()


def _key(project: Project) -> str:
    return repr(sorted(inputs_of("check", project, {}).items()))
