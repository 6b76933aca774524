"""The whole job in one go: started by one button, what it did put into the project, and where it stopped shown."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.files.project.data import ProjectFile
from core.files.project.keys import STEPS, left_to_do
from core.messages import label
from workbench.bench import Bench
from workbench.language import printed, text_of, tr
from workbench.reasons import first, why
from workbench.work import jobs
from workbench.work.tasks import Task

EVERYTHING = label("Do every step that is not done yet or out of date, to the report; stops where you have to decide")
"""What *Measure everything* does."""
EDIT = "whole job"
"""What it accepts is one edit, undone as a whole."""


def why_not_measure_all(
    *, running: bool, live: bool, left: frozenset[str], scan_chosen: bool, cannot_write: str
) -> str:
    """Return the reason why all steps cannot be done now; "" if they can. `left`: steps not up to date.

    `running`: it is being done, or waits for its turn. `live`: a live source is on, or what it recorded is still being
    put into the project. `scan_chosen`: pictures of a scan are. `cannot_write`: why nothing can be written into it.
    """
    return first(
        why(running, tr("Everything is being measured.")),
        why(live, tr("Stop the live source first.")),
        why(not left, tr("Everything is done.")),
        cannot_write,
        why(
            "scan" in left and not scan_chosen,
            tr("Choose or record the pictures first: of the camera target, of the plane target, of the scan."),
        ),
    )


class MeasuringAll(QObject):
    """Job that does every step that is not up to date, to the report, and stops where the user has to decide.

    Each step is in the project as soon as it is done: what was done before a cancel stays.
    """

    changed = Signal()
    ended = Signal(str)
    """The job has ended, and this page is to be looked at: that of a decision, or the report."""

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._task: Task | None = None
        self.why_stopped = ""
        """Why the last one ended before the report, or ""."""

    @property
    def running(self) -> bool:
        """Whether the job that does all steps runs, or waits for the process."""
        return self._task is not None

    @property
    def cannot_start(self) -> str:
        """Reason why the job that does all steps cannot be started now; "" if it can."""
        model = self._model
        return why_not_measure_all(
            running=self.running,
            live=self._bench.live.busy or model.is_recording,
            left=frozenset(left_to_do(model.project, model.results)),
            scan_chosen=bool(model.project.sources.scan),
            cannot_write=self._bench.cannot_write,
        )

    def start(self) -> None:
        """Start to do every step that is not up to date, to the report, in the background."""
        folder = self._model.folder
        if folder is None or self.cannot_start:
            return
        task: Task = self._bench.run_long(
            self,
            jobs.MEASURE_ALL,
            folder,
            self._model.file,
            printed(),
            label=tr("Measure everything"),
            on_done=lambda whole: self._over(task, folder, whole),
            on_failed=lambda problem: self._over(task, folder, None, text_of(problem)),
            on_cancelled=lambda: self._over(task, folder, None, tr("Stopped. What was finished stays.")),
            offers={"progress": "progress", "watch": "watch"},
        )
        self._task, self.why_stopped = task, ""
        task.reported.connect(lambda file: self._step_done(task, folder, file))
        self.changed.emit()

    def opened(self) -> None:
        """Stop the job that does all steps, as another project is open."""
        self.why_stopped = ""
        if self._task is not None:
            self._task.cancel()
            self._task = None

    def _step_done(self, task: Task, folder: Path, file: ProjectFile) -> None:
        """Put what was done into the project; end the job where the person signed in may not change that."""
        if task is not self._task or folder != self._model.folder:
            return
        now, accepted = self._model.project, file.project.accepted
        after = replace(now, accepted=accepted, rejected=now.rejected - {accepted.camera, accepted.planes})
        self._model.edit(tr("measure everything"), after, EDIT)
        if self._model.project.accepted != accepted:
            task.cancel()
            return
        known = self._model.results
        new = {step: file.results.get(step) for step in STEPS if file.results.get(step) != known.get(step)}
        if new:
            self._model.record_all(new)

    def _over(self, task: Task, folder: Path, whole: Any, why: str = "") -> None:
        if task is not self._task:
            return
        self._task, self.why_stopped = None, why
        if whole is not None and whole.stop is not None:
            self.why_stopped = text_of(whole.stop.why)
        self.changed.emit()
        if whole is None or folder != self._model.folder:
            return
        if whole.stop is None:
            self.ended.emit("report")
            return
        self._bench.notices.warning(text_of(whole.stop.why))
        self.ended.emit(whole.stop.page)
