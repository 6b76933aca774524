"""Work off the GUI thread.

Numerical libraries hold Python's lock for long stretches, so work runs in other processes, *lanes*: one job at a time,
in order. Results, progress and errors arrive as Qt signals in the GUI thread. A job that does not stop within a second
of being cancelled, or a process that dies, is replaced by a new process; files are written beside and renamed, so
nothing is left half written.
"""

from __future__ import annotations

import multiprocessing
import threading
import traceback
from collections import deque
from collections.abc import Callable, Mapping
from multiprocessing.connection import Connection
from typing import Any, cast

from PySide6.QtCore import QObject, QTimer, Signal

from workbench.jobs import Job
from workbench.problems import ENDED
from workbench.processes import lean_start
from workbench.worker import Failure, serve

STOP_WITHIN_MS = 900
"""A cancelled job that has not stopped by then is ended with its process."""


class Task(QObject):
    """One job on its way; exactly one of `done`, `failed`, `cancelled` comes at last, then `ended`."""

    progressed = Signal(str, int, int)
    told = Signal(object)
    view = Signal(object)
    done = Signal(object)
    failed = Signal(object)
    cancelled = Signal()
    ended = Signal()

    def __init__(self, lane: Lane, number: int, label: str) -> None:
        super().__init__(lane)
        self.number, self.label = number, label
        self.cancelling = False

    @property
    def lane(self) -> Lane:
        """Whose task it is; not kept here: a lane that its last task kept alive would end with it, and end it again."""
        return cast(Lane, self.parent())

    def cancel(self) -> None:
        """Ask the job to stop; it does within a second."""
        self.lane.cancel(self)

    def send(self, command: Any) -> None:
        """Give a command to a running job that takes any."""
        self.lane.post(self, ("command", command))

    def shown(self) -> None:
        """Tell a running job that the last view has been shown and the next one is welcome."""
        self.lane.post(self, ("shown", None))


class Lane(QObject):
    """A process that runs one job after another; started when first needed or warmed up."""

    task_started = Signal(object)
    task_ended = Signal(object)
    _message = Signal(int, object)

    def __init__(
        self,
        name: str,
        warm: tuple[Job, ...] = (),
        environment: Mapping[str, str] | None = None,
        parent: QObject | None = None,
        ahead: Job | None = None,
    ) -> None:
        super().__init__(parent)
        self.name, self._warm, self._environment, self._ahead = name, warm, dict(environment or {}), ahead
        self._context = multiprocessing.get_context("spawn")
        self._waiting: deque[tuple[Task, Job, tuple[Any, ...], dict[str, str]]] = deque()
        self._current: Task | None = None
        self._process: Any = None
        self._connection: Connection | None = None
        self._reader: threading.Thread | None = None
        self._generation = 0
        self._numbers = 0
        self._stop_timer = QTimer(self)
        self._stop_timer.setSingleShot(True)
        self._stop_timer.timeout.connect(self._end_stubborn)
        self._message.connect(self._on_message)

    @property
    def current(self) -> Task | None:
        """The task that is running."""
        return self._current

    @property
    def busy(self) -> bool:
        """Whether anything runs or waits."""
        return self._current is not None or bool(self._waiting)

    def warm_up(self) -> None:
        """Start the process and let it import, and compile while idle, what it will need."""
        if self._process is None:
            self._start()

    def run(
        self,
        job: Job,
        *args: Any,
        label: str,
        on_done: Callable[[Any], None],
        on_failed: Callable[[Any], None] | None = None,
        on_cancelled: Callable[[], None] | None = None,
        offers: dict[str, str] | None = None,
        replace_waiting: bool = False,
    ) -> Task:
        """Run a job: `job(*args, **offered)`.

        Parameters
        ----------
        label
            What the status bar says while it runs.
        on_done, on_failed, on_cancelled
            Called in the GUI thread with the result; with the InputError or `Failure`; with nothing.
        offers
            Keywords the function takes and what it gets for them: "progress" (default), "watch", "channel", or the
            "memory" of the process, in which one job may leave something for the next.
        replace_waiting
            Drop waiting ones of this job with the same label: only the newest matters.
        """
        self._numbers += 1
        task = Task(self, self._numbers, label)
        task.done.connect(on_done)
        if on_failed:
            task.failed.connect(on_failed)
        if on_cancelled:
            task.cancelled.connect(on_cancelled)
        if replace_waiting:
            for waiting in [one for one, other, *_ in self._waiting if (one.label, other) == (label, job)]:
                self.cancel(waiting)
        self._waiting.append((task, job, args, {"progress": "progress"} if offers is None else offers))
        self._next()
        return task

    def cancel(self, task: Task) -> None:
        """Stop `task`, running or waiting."""
        waiting = next((entry for entry in self._waiting if entry[0] is task), None)
        if waiting is not None:
            self._waiting.remove(waiting)
            self._conclude(task, "cancelled", None)
        elif task is self._current and not task.cancelling:
            task.cancelling = True
            self._cancel_number.value = task.number
            self._stop_timer.start(STOP_WITHIN_MS)

    def cancel_all(self) -> None:
        """Stop what runs, and forget what waits."""
        for task, *_ in list(self._waiting):
            self.cancel(task)
        if self._current is not None:
            self.cancel(self._current)

    def post(self, task: Task, message: tuple[str, Any]) -> None:
        """Send `message` to the job if it is still running."""
        if task is self._current and self._connection is not None:
            try:
                self._connection.send(message)
            except OSError:
                return  # the process died; the reader tells so

    def close(self) -> None:
        """End the process; waiting and running jobs are cancelled."""
        for task, *_ in list(self._waiting):
            self.cancel(task)
        running, self._current = self._current, None
        self._stop_timer.stop()
        self._end_process()
        if running is not None:
            self._conclude(running, "cancelled", None)

    def _next(self) -> None:
        if self._current is not None or not self._waiting:
            return
        task, job, args, offers = self._waiting.popleft()
        self._current = task
        self.task_started.emit(task)
        try:
            self.warm_up()
            assert self._connection is not None
            self._connection.send(("run", (task.number, job, args, offers)))
        except Exception as error:  # noqa: BLE001  no process, or nothing that can be sent: the job fails, not the lane
            if isinstance(error, OSError):
                self._end_process()
            self._fail_soon(task, Failure(type(error).__name__, str(error), traceback.format_exc()))

    def _fail_soon(self, task: Task, problem: Failure) -> None:
        """A job that could not even begin: told a moment later, when whoever asked for it has its task."""

        def fail() -> None:
            if task is self._current:
                self._finish(task, "cancelled" if task.cancelling else "failed", problem)

        QTimer.singleShot(0, self, fail)

    def _start(self) -> None:
        ours, theirs = self._context.Pipe()
        self._generation += 1
        self._cancel_number = self._context.Value("q", 0, lock=False)
        process = self._context.Process(
            target=serve,
            args=(theirs, self._cancel_number, self._warm, self._ahead),
            name=f"trisect-{self.name}",
            daemon=True,
        )
        try:
            with lean_start(self._environment):
                process.start()
        except BaseException:
            ours.close()
            raise
        finally:
            theirs.close()
        self._process = process
        self._connection = ours
        self._reader = threading.Thread(
            target=self._read, args=(ours, self._generation), name=f"lane-{self.name}", daemon=True
        )
        self._reader.start()

    def _read(self, connection: Connection, generation: int) -> None:
        """On its own thread: pass on what the process sends; None when it is gone."""
        while True:
            try:
                message = connection.recv()
            except (EOFError, OSError):
                message = None
            except Exception as error:  # noqa: BLE001  a result that cannot be unpacked ends the job, not the lane
                message = (-1, "failed", Failure(type(error).__name__, str(error), ""))
            try:
                self._message.emit(generation, message)
            except RuntimeError:
                return  # the lane was deleted
            if message is None:
                return

    def _on_message(self, generation: int, message: tuple[int, str, Any] | None) -> None:
        if generation != self._generation:
            return  # from a process that has been replaced
        task = self._current
        if message is None:
            self._end_process()
            if task is not None:
                gone = Failure(ENDED, "the measuring process ended unexpectedly", "")
                self._finish(task, "cancelled" if task.cancelling else "failed", gone)
            return
        number, kind, value = message
        if task is None or number not in (task.number, -1):
            return
        if kind == "progress":
            task.progressed.emit(*value)
        elif kind in ("event", "view"):
            (task.told if kind == "event" else task.view).emit(value)
        else:
            self._finish(task, kind, value)

    def _finish(self, task: Task, kind: str, value: Any) -> None:
        self._stop_timer.stop()
        self._current = None
        self._conclude(task, kind, value)
        self._next()

    def _conclude(self, task: Task, kind: str, value: Any) -> None:
        try:
            if kind == "done" and not task.cancelling:
                task.done.emit(value)
            elif kind in ("done", "cancelled"):
                task.cancelled.emit()
            else:
                task.failed.emit(value)
        finally:
            task.ended.emit()
            self.task_ended.emit(task)
            task.deleteLater()

    def _end_stubborn(self) -> None:
        task = self._current
        if task is not None and task.cancelling:
            self._end_process()
            self._finish(task, "cancelled", None)

    def _end_process(self) -> None:
        process, self._process = self._process, None
        connection, self._connection = self._connection, None
        self._generation += 1
        if process is None:
            return
        if process.is_alive():
            process.terminate()
        process.join(2)
        if process.is_alive():
            process.kill()
            process.join()
        process.close()
        if self._reader is not None:
            self._reader.join(2)  # the process is gone, so it reads to the end; closed before, it might read another's
        if connection is not None:
            connection.close()
