"""Work off the GUI thread.

Numerical libraries hold Python's lock for long stretches, so work runs in other processes, *lanes*: one job at a time,
in order. Results, progress and errors arrive as Qt signals in the GUI thread. A job that does not stop within a second
of being cancelled, or a process that dies, is replaced by a new process; files are written beside and renamed, so
nothing is left half written.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, cast

from PySide6.QtCore import QObject, QTimer, Signal

from workbench.work import wire
from workbench.work.jobs import Job
from workbench.work.process import WorkerProcess
from workbench.work.wire import Kind
from workbench.work.worker import ENDED, Failure

STOP_WITHIN_MS = 900
"""A cancelled job that has not stopped by then is ended with its process."""


class Task(QObject):
    """Job that is running or waiting, and the receiver of its answer.

    One of `done`, `failed`, `cancelled` comes at last, then `ended`. All are for the receiver: once it is deleted,
    nothing of the task is told any more, so whatever it connects is safe. The lane tells others of all tasks.
    """

    progressed = Signal(str, int, int)
    reported = Signal(object)
    view = Signal(object)
    done = Signal(object)
    failed = Signal(object)
    cancelled = Signal()
    ended = Signal()

    def __init__(self, lane: Lane, receiver: QObject, number: int, job: Job, label: str) -> None:
        super().__init__(lane)
        self.number, self.job, self.label = number, job, label
        self.cancelling = self.succeeded = False
        self._receiver = id(receiver)  # not kept: it goes when its owner lets it go
        receiver.destroyed.connect(self._receiver_gone)

    @property
    def lane(self) -> Lane:
        """Lane, a queue with one process, in which the task runs or waits.

        Not stored here: a lane that its last task kept alive would end with it, and end it again.
        """
        return cast(Lane, self.parent())

    def cancel(self) -> None:
        """Ask the job to stop, which it does within about a second unless it is done before."""
        self.lane.cancel(self)

    def send(self, command: Any) -> None:
        """Send a command to the running job, if it takes commands."""
        self.lane.post(self, Kind.COMMAND, command)

    def shown(self) -> None:
        """Tell the running job that its last view is on the screen and the next one may come."""
        self.lane.post(self, Kind.SHOWN)

    def answers(self, receiver: QObject, job: Job) -> bool:
        """Whether this task runs the job `job` for the object `receiver`."""
        return (self._receiver, self.job) == (id(receiver), job)

    def conclude(self, kind: Kind, value: Any = None) -> None:
        """Call the receiver's function for the job's end: done, failed or cancelled."""
        self.succeeded = kind is Kind.DONE  # even if Cancel was pressed: what is on the disk now is the new result
        try:
            if self.succeeded:
                self.done.emit(value)
            elif kind is Kind.FAILED:
                self.failed.emit(value)
            else:
                self.cancelled.emit()
        finally:
            self.ended.emit()

    def _receiver_gone(self) -> None:
        self.blockSignals(True)


class Lane(QObject):
    """Process that runs one job after another; started when it is first needed, or by `prepare`."""

    task_started = Signal(object)
    task_progressed = Signal(object, str, int, int)
    task_ended = Signal(object)
    preparing_changed = Signal(bool)
    """Whether the process makes ready, for the first time, what is kept for every later start."""

    def __init__(
        self,
        name: str,
        warm: tuple[Job, ...] = (),
        parent: QObject | None = None,
        ahead: Job | None = None,
    ) -> None:
        super().__init__(parent)
        self.name, self._warm, self._ahead = name, warm, ahead
        self._waiting: deque[tuple[Task, Job, tuple[Any, ...], dict[str, str]]] = deque()
        self._current: Task | None = None
        self._process: WorkerProcess | None = None
        self._numbers = 0
        self.preparing = False
        self._stop_timer = QTimer(self)
        self._stop_timer.setSingleShot(True)
        self._stop_timer.setInterval(STOP_WITHIN_MS)
        self._stop_timer.timeout.connect(self._end_stubborn)

    @property
    def current(self) -> Task | None:
        """Task that runs; None if none does."""
        return self._current

    @property
    def busy(self) -> bool:
        """Whether a task runs or waits."""
        return self._current is not None or bool(self._waiting)

    @property
    def pid(self) -> int:
        """Process id of the lane's process in the operating system; 0 if there is none."""
        return self._process.pid if self._process is not None else 0

    def prepare(self) -> None:
        """Start the lane's process ahead of its first job, so that it imports and compiles while idle."""
        if self._process is not None and self._process.is_over:
            self._end_process()  # its end is told in the next turn: too late for a job that is to begin now
        if self._process is None:
            self._process = process = WorkerProcess(self.name, self._warm, self._ahead, self)
            process.received.connect(self._received)
            process.gone.connect(self._gone)

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
        """Queue a job, `job(*args, **offered)`, for the lane's process, and return its task.

        Parameters
        ----------
        receiver
            Whom the answer is for: once it is deleted, none of the three functions is called any more, nor what else
            was connected to the task. The job itself goes on: what it writes is wanted all the same.
        label
            What the status bar says while it runs.
        on_done, on_failed, on_cancelled
            Called in the GUI thread with the result; with the InputError or `Failure`; with nothing.
        offers
            Keywords the function takes and what it gets for them: "progress" (default), "watch", "channel", or the
            "memory" of the process, in which one job may leave something for the next.
        replace_waiting
            Drop those of this job that wait for the same receiver: only the newest matters.
        """
        self._numbers += 1
        task = Task(self, receiver, self._numbers, job, label)
        task.done.connect(on_done)
        if on_failed:
            task.failed.connect(on_failed)
        if on_cancelled:
            task.cancelled.connect(on_cancelled)
        if replace_waiting:
            for waiting in [one for one, *_ in self._waiting if one.answers(receiver, job)]:
                self.cancel(waiting)
        self._waiting.append((task, job, args, {"progress": "progress"} if offers is None else offers))
        self._next()
        return task

    def cancel(self, task: Task) -> None:
        """Cancel a task of this lane, running or waiting."""
        waiting = next((entry for entry in self._waiting if entry[0] is task), None)
        if waiting is not None:
            self._waiting.remove(waiting)
            self._conclude(task, Kind.CANCELLED, None)
        elif task is self._current and not task.cancelling:
            task.cancelling = True
            self.post(task, Kind.CANCEL)
            self._stop_timer.start()

    def cancel_all(self) -> None:
        """Cancel the running task, and drop all tasks that wait."""
        for task, *_ in list(self._waiting):
            self.cancel(task)
        if self._current is not None:
            self.cancel(self._current)

    def post(self, task: Task, kind: Kind, value: Any = None) -> None:
        """Send a message of a kind to the task's job, if it still runs."""
        if task is self._current and self._process is not None:
            self._process.send(kind, task.number, value)

    def close(self) -> None:
        """Kill the lane's process without waiting for its end; all its tasks are cancelled."""
        for task, *_ in list(self._waiting):
            self.cancel(task)
        running, self._current = self._current, None
        self._stop_timer.stop()
        self._end_process()
        if running is not None:
            self._conclude(running, Kind.CANCELLED, None)

    def wait_until_closed(self) -> None:
        """Wait until killed processes of this lane are gone; for the program's end, when no event comes."""
        for process in self.findChildren(WorkerProcess):
            process.wait()

    def _next(self) -> None:
        if self._current is not None or not self._waiting:
            return
        task, job, args, offers = self._waiting.popleft()
        self._current = task
        self.task_started.emit(task)
        if task is not self._current:
            return  # closed by whoever heard of it
        if task.cancelling:
            self._conclude_soon(task, Kind.CANCELLED, None)
            return
        try:
            self.prepare()
            self.post(task, Kind.RUN, (job, args, offers))
        except Exception as error:  # noqa: BLE001  nothing that can be sent: the job fails, not the lane
            self._conclude_soon(task, Kind.FAILED, Failure.of(error))

    def _conclude_soon(self, task: Task, kind: Kind, value: Any) -> None:
        """A job that could not even begin: told a moment later, when the caller has its task."""

        def conclude() -> None:
            if task is self._current:
                self._finish(task, Kind.CANCELLED if task.cancelling else kind, value)

        QTimer.singleShot(0, self, conclude)

    def _received(self, kind: int, number: int, body: bytes) -> None:
        if kind == Kind.AHEAD:
            self._prepares(wire.value_of(body))
            return
        task = self._current
        if task is None or number != task.number:
            wire.forget(body)
            return
        try:
            value = wire.value_of(body)
        except Exception as error:  # noqa: BLE001  a result that cannot be unpacked ends the job, not the lane
            kind, value = Kind.FAILED, Failure.of(error)
        if kind == Kind.PROGRESS:
            task.progressed.emit(*value)
            self.task_progressed.emit(task, *value)
        elif kind == Kind.EVENT:
            task.reported.emit(value)
        elif kind == Kind.VIEW:
            task.view.emit(value)
        else:
            self._finish(task, Kind(kind), value)

    def _gone(self, why: str) -> None:
        """The process could not be started, or has died; the next job gets another one."""
        self._process = None
        self._prepares(False)
        task = self._current
        if task is not None:
            problem = Failure(ENDED, "", why)
            self._finish(task, Kind.CANCELLED if task.cancelling else Kind.FAILED, problem)

    def _finish(self, task: Task, kind: Kind, value: Any) -> None:
        self._stop_timer.stop()
        self._current = None
        self._conclude(task, kind, value)
        self._next()

    def _conclude(self, task: Task, kind: Kind, value: Any) -> None:
        try:
            task.conclude(kind, value)
        finally:
            self.task_ended.emit(task)
            task.deleteLater()

    def _end_stubborn(self) -> None:
        task = self._current
        if task is not None and task.cancelling:
            self._end_process()
            self._finish(task, Kind.CANCELLED, None)

    def _end_process(self) -> None:
        if self._process is not None:
            self._process.end()
            self._process = None
            self._prepares(False)

    def _prepares(self, preparing: bool) -> None:
        if preparing != self.preparing:
            self.preparing = preparing
            self.preparing_changed.emit(preparing)
