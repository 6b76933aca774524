"""A second process of the program that computes beside the first.

Much of a measurement holds Python's lock, so threads alone leave a second core idle. What is handed over are calls of
functions with all they need, and what they return comes back: the second process writes no file, so it can be ended at
any moment. It ends by itself when the first one is gone.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from queue import SimpleQueue
from typing import Any, BinaryIO, Protocol, TypeVar

from core import files_read
from core.code_cache import code_cache
from core.errors import InputError
from core.memory import give_back
from core.messages import Message
from core.processes import module_command
from core.progress import Progress, silent
from core.stage_times import StageTimes
from core.threads import MOST_WORKERS, cores, ordered_map, result_of

Item = TypeVar("Item", contravariant=True)
Result = TypeVar("Result", covariant=True)

_TELL_EVERY_S = 0.1
"""How often in s progress is told to the first process at most."""
_LENGTH = 8
"""Bytes that say how long what follows is."""


class Call(Protocol[Item, Result]):
    """Function that either process can do, identified by its name, with progress as of any job."""

    def __call__(self, item: Item, /, *, progress: Progress = silent) -> Result: ...


class SecondProcess:
    """Second process that runs one call after another, in the order they are submitted; ended with the `with` block.

    It starts at once and imports `modules` before the first call.
    """

    def __init__(self, modules: Sequence[str] = ()) -> None:
        code_cache()  # where none can be written, both use what is found here
        self._process = subprocess.Popen(
            module_command("core.second_process", *modules),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        self._calls = ThreadPoolExecutor(1, "second process")
        self._told: tuple[str, int, int] | None = None

    def __enter__(self) -> SecondProcess:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._calls.shutdown(cancel_futures=True)
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):  # what could not be written any more is of no use
                pipe.close()  # type: ignore[union-attr]
        self._process.wait()

    def submit(self, call: Call[Item, Result], item: Item, progress: Progress = silent) -> Future[Result]:
        """Queue `call(item)`; until it has begun, its future can be cancelled. A StageTimes learns what it cost.

        The future raises what the call raises, and InputError if the process is gone.
        """
        return self._calls.submit(self._done, call, item, progress)

    def wait(self, future: Future[Result], progress: Progress, step: str) -> Result:
        """Wait for a future of `submit` and return its result; `progress` reports on `step` meanwhile, and may cancel.

        `step` is what it hears where the process tells nothing.
        """
        return result_of(future, lambda: progress(*(self._told or (step, 0, 1))))

    def _done(self, call: Call[Item, Result], item: Item, progress: Progress) -> Result:
        assert self._process.stdin is not None and self._process.stdout is not None
        try:
            _send(self._process.stdin, pickle.dumps((call, item), pickle.HIGHEST_PROTOCOL))
            while True:
                kind, value = pickle.loads(_receive(self._process.stdout))
                if kind != "told":
                    break
                self._told = value
        except (OSError, EOFError, ValueError) as gone:
            raise self._ended() from gone
        self._told = None
        result, seconds, read = value
        for path in read:
            files_read.report_read(path)
        if isinstance(progress, StageTimes):
            progress.add(seconds)
        if kind == "raised":
            raise result
        done: Result = result
        return done

    def _ended(self) -> InputError:
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(1.0)
        code = self._process.returncode
        return InputError(
            Message(
                "run.second_process_ended",
                "the second process of the measurement has ended before its work was done (exit code {code}), perhaps "
                "for want of memory",
                code="?" if code is None else code,
            ),
            todo=Message("advice.close_programs_measure_again", "close other programs and measure again"),
        )


@contextmanager
def second_process(modules: Sequence[str] = ()) -> Iterator[SecondProcess | None]:
    """Start a second process for calls, ended on exit; None where no core is left for it, or it cannot be started."""
    try:
        started = SecondProcess(modules) if cores() > 1 else None
    except OSError:
        started = None
    if started is None:
        yield None
        return
    with started:
        yield started


def shared_map(
    call: Call[Item, Result],
    items: Sequence[Item],
    beside: SecondProcess | None,
    idle: Callable[[], object] | None = None,
    progress: Progress = silent,
) -> Iterator[Result]:
    """Apply `call` to `items` in threads and `beside`, which begins at their end; results in the order of the items.

    Raises what a call raises at its item's turn; else as `core.threads.ordered_map`.
    """
    if beside is None:
        return ordered_map(lambda item: call(item, progress=progress), items, idle=idle)
    last_first = [beside.submit(call, item, progress) for item in reversed(items)]

    def here_or_there(job: tuple[Item, Future[Result]]) -> Result:
        item, there = job
        return call(item, progress=progress) if there.cancel() else there.result()

    jobs = zip(items, reversed(last_first), strict=True)
    return ordered_map(here_or_there, jobs, max(1, min(MOST_WORKERS, cores()) - 1), idle)


def _send(pipe: BinaryIO | Any, body: bytes) -> None:
    pipe.write(len(body).to_bytes(_LENGTH, "big"))
    pipe.write(body)
    pipe.flush()


def _receive(pipe: BinaryIO | Any) -> bytes:
    """What was sent; EOFError if the other end is gone."""
    length = int.from_bytes(head := pipe.read(_LENGTH), "big")
    body: bytes = pipe.read(length)
    if len(head) < _LENGTH or len(body) < length:
        raise EOFError
    return body


def _serve(modules: Sequence[str]) -> None:
    """The second process: do one call after another, until the first process has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches both; the first one ends this one
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # a library that prints must not be taken for an answer
    calls: SimpleQueue[bytes] = SimpleQueue()

    def listen() -> None:
        try:
            while True:
                calls.put(_receive(sys.stdin.buffer))
        except (EOFError, OSError):
            os._exit(0)  # at once, whatever is being computed: nobody wants it

    threading.Thread(target=listen, daemon=True).start()
    for module in modules:
        import_module(module)
    while True:
        _send(answers, _answer(calls.get(), _Telling(answers)))
        give_back()  # nothing is kept while the next call is waited for


def _answer(body: bytes, progress: Progress) -> bytes:
    """Do a call; what is to be sent for it."""
    told = StageTimes(progress)
    read: list[Path] = []
    files_read.listen(read.append)
    try:
        call, item = pickle.loads(body)
        del body  # both may be large
        answer = "done", (call(item, progress=told), told.seconds(), read)
        return pickle.dumps(answer, pickle.HIGHEST_PROTOCOL)
    except Exception as error:  # noqa: BLE001  (raised again by who asked for the call)
        return pickle.dumps(("raised", (_movable(error), told.seconds(), read)))


class _Telling:
    """A progress that tells the first process, not too often."""

    def __init__(self, answers: BinaryIO) -> None:
        self._answers, self._at = answers, 0.0

    def __call__(self, step: str, done: int, total: int) -> None:
        if time.monotonic() - self._at > _TELL_EVERY_S:
            self._at = time.monotonic()
            _send(self._answers, pickle.dumps(("told", (step, done, total))))


def _movable(error: Exception) -> Exception:
    """The exception, or what it says if it cannot be sent."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # noqa: BLE001  (whatever a library's own exception does when it is sent)
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


if __name__ == "__main__":
    _serve(sys.argv[1:])
