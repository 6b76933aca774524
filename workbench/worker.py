"""The other end of a lane: a process that runs one job after another. Knows nothing of Qt."""

from __future__ import annotations

import signal
import time
import traceback
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

from core.errors import Cancelled, InputError
from workbench.jobs import Job, resolve
from workbench.processes import share_python_willingly

TELL_EVERY_S = 0.05
"""Progress is passed on at most this often."""


@dataclass(frozen=True, slots=True)
class Failure:
    """An exception that was not foreseen, as text that survives the way between processes."""

    kind: str
    message: str
    details: str

    def __str__(self) -> str:
        return f"{self.kind}: {self.message}" if self.message else self.kind


class Channel:
    """What a running job may do besides returning: report progress, send events, and receive commands."""

    def __init__(self, connection: Connection, cancelled: Callable[[], bool], number: int) -> None:
        self._connection, self._cancelled, self._number = connection, cancelled, number
        self._commands: deque[Any] = deque()
        self._shown = True
        self._told: tuple[str, float] = ("", 0.0)

    def progress(self, step: str, done: int, total: int) -> None:
        """The job's `Progress`: raises Cancelled once the window has asked for it."""
        if self._cancelled():
            raise Cancelled
        now = time.perf_counter()
        before, at = self._told
        if step != before or done >= total or now - at > TELL_EVERY_S:
            self._told = (step, now)
            self._send("progress", (step, done, total))

    def emit(self, event: Any) -> None:
        """Send the window something in the middle of the job."""
        self._send("event", event)

    def offer(self, event: Any) -> None:
        """Send something to show, if the window has shown what was sent before."""
        if self.ready():
            self._shown = False
            self._send("view", event)

    def command(self) -> Any | None:
        """The next command of the window, or None."""
        self._listen()
        return self._commands.popleft() if self._commands else None

    def ready(self) -> bool:
        """Whether the window has shown the last view."""
        self._listen()
        return self._shown

    def _listen(self) -> None:
        while self._connection.poll():
            kind, value = self._connection.recv()
            if kind == "shown":
                self._shown = True
            elif kind == "command":
                self._commands.append(value)

    def _send(self, kind: str, value: Any) -> None:
        self._connection.send((self._number, kind, value))


def serve(connection: Connection, cancel: Any, warm: tuple[Job, ...], ahead: Job | None = None) -> None:
    """Run the jobs that come through `connection` until it closes.

    `cancel` is a shared number: the job of that number is to stop. The functions of `warm` are imported beforehand,
    so that the first job does not wait for it. `ahead` names a function that gives small pieces of work: they are done
    one by one while no job waits.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the window decides
    share_python_willingly()
    try:
        for job in warm:
            with suppress(ImportError, AttributeError):  # told when the job is asked for
                resolve(job)
        pieces = list(_pieces(ahead))
        memory: dict[str, Any] = {}
        while True:
            if pieces and not connection.poll(0):
                pieces.pop(0)()
                continue
            kind, value = connection.recv()
            if kind == "run":
                _run(connection, cancel, memory, *value)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return  # the window is gone


def _pieces(ahead: Job | None) -> tuple[Callable[[], None], ...]:
    """What is done ahead; nothing if it cannot be had: jobs then do it when they need it."""
    if ahead is None:
        return ()
    with suppress(ImportError, AttributeError):
        return tuple(resolve(ahead)())
    return ()


def _run(
    connection: Connection,
    cancel: Any,
    memory: dict[str, Any],
    number: int,
    job: Job,
    args: tuple[Any, ...],
    options: dict[str, str],
) -> None:
    channel = Channel(connection, lambda: cancel.value == number, number)
    offered = {"progress": channel.progress, "watch": channel.emit, "channel": channel, "memory": memory}
    try:
        keywords = {name: offered[what] for name, what in options.items()}
        answer = ("done", resolve(job)(*args, **keywords))
    except Cancelled:
        answer = ("cancelled", None)
    except InputError as error:
        answer = ("refused", error)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        raise
    except Exception as error:  # noqa: BLE001  whatever went wrong is told in the window, and the lane goes on
        answer = ("failed", Failure(type(error).__name__, str(error), traceback.format_exc()))
    try:
        connection.send((number, *answer))
    except (BrokenPipeError, ConnectionResetError):
        raise
    except Exception as error:  # noqa: BLE001  a result that cannot be sent is a failure like any other
        connection.send((number, "failed", Failure(type(error).__name__, str(error), traceback.format_exc())))
