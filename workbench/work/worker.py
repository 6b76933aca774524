"""The other end of a lane: a process that runs one job after another. Knows nothing of Qt.

`python -m workbench.work.worker NAME FOLDER`: frames come through standard input, answers go to what was standard
output, arrays beyond 1 MB into FOLDER. One thread reads what the window says, so that a job that computes is told to
stop; what it reads is unpickled and acted upon in the main thread only.
"""

from __future__ import annotations

import os
import shutil
import signal
import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

from core.errors import Cancelled, InputError
from workbench.work import wire
from workbench.work.jobs import Job, resolve
from workbench.work.wire import Kind

if TYPE_CHECKING:
    from core.pipeline.live.commands import LiveRequest
    from core.pipeline.live.events import LiveEnded, LiveEvent

TELL_EVERY_S = 0.05
"""Progress is passed on at most this often."""

SWITCH_S = 0.001
"""A thread that waits for Python's lock is given it after so long, five times as soon as by itself: a picture that a
recording sends while it looks at the next waits for the lock many times."""


ENDED = "ProcessEnded"
"""The kind of failure of a job whose process is gone."""


class WindowClosed(Exception):
    """Exception that the window has ended; raised in the job, so that it ends, too, and keeps its recording."""


@dataclass(frozen=True, slots=True)
class Failure:
    """Unforeseen exception, as text that survives the way between processes."""

    kind: str
    message: str
    details: str

    @classmethod
    def of(cls, error: BaseException) -> Failure:
        """Make the failure, as text, of the exception that is being handled."""
        return cls(type(error).__name__, str(error), traceback.format_exc())

    def __str__(self) -> str:
        return f"{self.kind}: {self.message}" if self.message else self.kind


class Channel:
    """Channel of a running job to the window: progress, events and commands."""

    def __init__(self, number: int, send: Callable[[Kind, int, Any], None]) -> None:
        self.number, self._send = number, send
        self.cancelled = self.gone = False
        self.commands: deque[bytes] = deque()
        self.shown = True
        self._progress: tuple[str, float] = ("", 0.0)

    def progress(self, step: str, done: int, total: int) -> None:
        """Report the progress of the job to the window; raises Cancelled if the window has asked for that."""
        self._check()
        if self.cancelled:
            raise Cancelled
        now = time.perf_counter()
        before, at = self._progress
        if step != before or done >= total or now - at > TELL_EVERY_S:
            self._progress = (step, now)
            self._send(Kind.PROGRESS, self.number, (step, done, total))

    def emit(self, event: Any) -> None:
        """Send an event of the running job to the window."""
        self._send(Kind.EVENT, self.number, event)

    def offer(self, event: Any) -> None:
        """Send a view to the window, unless the last view sent is not shown yet."""
        if self.ready():
            self.shown = False
            self._send(Kind.VIEW, self.number, event)

    def command(self) -> Any | None:
        """Return the next command that the window has sent to the job; None if there is none."""
        self._check()
        return wire.value_of(self.commands.popleft()) if self.commands else None

    def ready(self) -> bool:
        """Whether the window has shown the last view that the job sent."""
        self._check()
        return self.shown

    def _check(self) -> None:
        if self.gone:
            raise WindowClosed


class Worker:
    """Server of the jobs that come through `reading`, until it is closed."""

    def __init__(self, reading: int, writing: int, folder: Path) -> None:
        self._reading, self._writing, self._folder = reading, writing, folder
        self._jobs: SimpleQueue[tuple[Channel, bytes] | None] = SimpleQueue()
        self._channel = Channel(0, self._send)
        self._memory: dict[str, Any] = {}

    def serve(self) -> None:
        """Run the jobs that arrive until the pipe is closed; while none waits, import and compile ahead."""
        _, _, body = wire.read_frame(self._read)
        warm, ahead = wire.value_of(body)
        threading.Thread(target=self._listen, name="window", daemon=True).start()
        for job in warm:
            with suppress(ImportError, AttributeError):  # told when the job is asked for
                resolve(job)
        pieces, is_first = _pieces(ahead)
        if is_first:
            self._send(Kind.AHEAD, 0, True)
        while True:
            if pieces and self._jobs.empty():
                pieces.popleft()()
                if is_first and not pieces:
                    self._send(Kind.AHEAD, 0, False)
            elif (next_job := self._jobs.get()) is None:
                return
            else:
                self._run(*next_job)

    def _read(self, size: int) -> bytes:
        return os.read(self._reading, size)

    def _listen(self) -> None:
        """On its own thread: sort what the window says."""
        with suppress(EOFError, OSError):
            while True:
                kind, number, body = wire.read_frame(self._read)
                channel = self._channel
                if kind is Kind.RUN:
                    self._channel = Channel(number, self._send)
                    self._jobs.put((self._channel, body))
                elif number != channel.number:
                    continue
                elif kind is Kind.CANCEL:
                    channel.cancelled = True
                elif kind is Kind.SHOWN:
                    channel.shown = True
                elif kind is Kind.COMMAND:
                    channel.commands.append(body)
        self._channel.gone = True
        self._jobs.put(None)

    def _send(self, kind: Kind, number: int, value: Any = None) -> None:
        left = memoryview(wire.frame(kind, number, value, self._folder))
        try:
            while left:
                left = left[os.write(self._writing, left) :]
        except OSError as error:
            raise WindowClosed from error

    def _run(self, channel: Channel, body: bytes) -> None:
        offered = {
            "progress": channel.progress,
            "watch": channel.emit,
            "channel": channel,
            "memory": self._memory,
        }
        kind: Kind
        answer: Any
        try:
            job, args, options = wire.value_of(body)
            keywords = {name: offered[what] for name, what in options.items()}
            kind, answer = Kind.DONE, resolve(job)(*args, **keywords)
        except Cancelled:
            kind, answer = Kind.CANCELLED, None
        except InputError as error:
            kind, answer = Kind.FAILED, error
        except WindowClosed:
            raise
        except Exception as error:  # noqa: BLE001  whatever went wrong is told in the window, and the lane goes on
            kind, answer = Kind.FAILED, Failure.of(error)
        try:
            self._send(kind, channel.number, answer)
        except WindowClosed:
            raise
        except Exception as error:  # noqa: BLE001  a result that cannot be sent is a failure like any other
            self._send(Kind.FAILED, channel.number, Failure.of(error))


def run_live_job(request: LiveRequest, channel: Channel) -> LiveEnded:
    """Record as `request` says until the window sends Stop; views are sent as fast as the window shows them."""
    from core.pipeline.live.events import LiveView
    from core.pipeline.live.session import run_live

    def emit(event: LiveEvent) -> None:
        if isinstance(event, LiveView):
            channel.offer(event)
        else:
            channel.emit(event)

    return run_live(request, channel.command, emit, channel.ready)


def main(arguments: Sequence[str]) -> None:
    """Run the worker process for the window that started it."""
    folder = Path(arguments[1])
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the window decides
    sys.setswitchinterval(SWITCH_S)
    try:
        with suppress(WindowClosed, EOFError):
            Worker(*_pipes(), folder).serve()
    finally:
        shutil.rmtree(folder, ignore_errors=True)  # a window that was killed could not


def _pieces(ahead: Job | None) -> tuple[deque[Callable[[], None]], bool]:
    """What is done ahead, and whether for the first time; nothing if it cannot be had: jobs do it when they need it."""
    if ahead is not None:
        with suppress(ImportError, AttributeError):
            pieces, is_first = resolve(ahead)()
            return deque(pieces), is_first
    return deque(), False


def _pipes() -> tuple[int, int]:
    """The pipes to the window; what anybody prints from now on goes to standard error, what anybody reads is empty."""
    if sys.platform == "win32":
        import msvcrt

        for handle in (0, 1):
            msvcrt.setmode(handle, os.O_BINARY)
    pipes = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    try:
        os.dup2(2, 1)
    except OSError:  # a program without a terminal
        os.dup2(nothing, 1)
    return pipes


if __name__ == "__main__":
    from workbench.work import worker  # what is pickled has this module's name, not "__main__"

    worker.main(sys.argv[1:])
    sys.stderr.flush()
    os._exit(0)  # a thread that warms up may be in OpenCV, which aborts when the interpreter is taken away beneath it
