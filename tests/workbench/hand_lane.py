"""Lanes without processes: jobs run in this one, or wait for the test to say how they end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from PySide6.QtCore import QObject, QTimer, Signal

from core.errors import InputError
from workbench.work.jobs import Job, resolve
from workbench.work.tasks import Lane, Task
from workbench.work.wire import Kind


class HandLane(QObject):
    """Runs jobs a moment later, one after another. `answers` replaces functions; `held` are those that wait."""

    task_started = Signal(object)
    task_progressed = Signal(object, str, int, int)
    task_ended = Signal(object)
    preparing_changed = Signal(bool)

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name
        self.answers: dict[Job, Callable[..., Any]] = {}
        self.held: set[Job] = set()
        self.waiting: list[tuple[Task, Job, tuple[Any, ...], dict[str, str]]] = []
        self.ran: list[Job] = []
        self.sent: list[Any] = []
        self.prepared = self.preparing = False

    @property
    def current(self) -> Task | None:
        return self.waiting[0][0] if self.waiting else None

    @property
    def busy(self) -> bool:
        return bool(self.waiting)

    def prepare(self) -> None:
        self.prepared = True

    def close(self) -> None:
        self.waiting.clear()

    def run(
        self,
        receiver: QObject,
        job: Job,
        *args: Any,
        label: str,
        on_done: Callable[[Any], None],
        on_failed: Callable[[Any], None] | None = None,
        on_cancelled: Callable[[], None] | None = None,
        offers: dict[str, str] | None = None,
        replace_waiting: bool = False,
    ) -> Task:
        task = Task(cast(Lane, self), receiver, len(self.ran), job, label)
        task.done.connect(on_done)
        if on_failed:
            task.failed.connect(on_failed)
        if on_cancelled:
            task.cancelled.connect(on_cancelled)
        if replace_waiting:
            for old in [entry for entry in self.waiting[1:] if entry[0].answers(receiver, job)]:
                self.waiting.remove(old)
                old[0].conclude(Kind.CANCELLED)
        self.waiting.append((task, job, args, {"progress": "progress"} if offers is None else offers))
        self.task_started.emit(task)
        QTimer.singleShot(0, self._work)
        return task

    def cancel(self, task: Task) -> None:
        self._end(task, Kind.CANCELLED)

    def cancel_all(self) -> None:
        for task, *_ in reversed(list(self.waiting)):
            self.cancel(task)

    def post(self, task: Task, kind: Kind, value: Any = None) -> None:
        self.sent.append(value if kind is Kind.COMMAND else kind.name.lower())

    def finish(self, result: Any) -> None:
        """The job that waits is done."""
        task = self.waiting[0][0]
        self._end(task, Kind.DONE, result)

    def fail(self, problem: Any) -> None:
        """The job that waits has failed."""
        task = self.waiting[0][0]
        self._end(task, Kind.FAILED, problem)

    def _work(self) -> None:
        if not self.waiting or self.waiting[0][1] in self.held:
            return
        task, job, args, offers = self.waiting[0]
        self.ran.append(job)
        offered = {"progress": lambda step, done, total: None, "watch": task.reported.emit}
        try:
            keywords = {name: offered[what] for name, what in offers.items() if what in offered}
            answer = self.answers[job](*args) if job in self.answers else resolve(job)(*args, **keywords)
        except InputError as error:
            self._end(task, Kind.FAILED, error)
        else:
            self._end(task, Kind.DONE, answer)

    def _end(self, task: Task, kind: Kind, value: Any = None) -> None:
        entry = next((entry for entry in self.waiting if entry[0] is task), None)
        if entry is None:
            return
        self.waiting.remove(entry)
        task.conclude(kind, value)
        self.task_ended.emit(task)
        QTimer.singleShot(0, self._work)
