"""Processor time that the stages of a long job cost, whichever threads it is spent on."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext

from core.progress import Progress, silent


class StageTimes:
    """Progress that counts processor time for the step reported last, and for stages on other threads.

    Time in which a thread waits for another one does not count, so the sum is what the job costs, and `wall_s` how
    long it has taken.
    """

    def __init__(self, progress: Progress = silent) -> None:
        self._progress = progress
        self._seconds: dict[str, float] = {}
        self._lock = threading.Lock()
        self._step = ""
        self._thread = threading.get_ident()
        self._since = time.thread_time()
        self._started = time.perf_counter()

    def __call__(self, step: str, done: int, total: int) -> None:
        """Report how far the job is; to be called by the thread that has made this object."""
        self._book_own()
        self._step = step
        self._progress(step, done, total)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Add the processor time spent within the `with` block, on any thread, to the stage `name`."""
        own = threading.get_ident() == self._thread
        if own:
            self._book_own()
        began = time.thread_time()
        try:
            yield
        finally:
            now = time.thread_time()
            self._book(name, now - began)
            if own:
                self._since = now

    def add(self, seconds: Mapping[str, float]) -> None:
        """Add processor times in s, by stage, that another process has spent."""
        for name, spent in seconds.items():
            self._book(name, spent)

    def seconds(self) -> Mapping[str, float]:
        """Return the processor time in s of each stage, the longest first."""
        self._book_own()
        with self._lock:
            return dict(sorted(self._seconds.items(), key=lambda item: -item[1]))

    @property
    def wall_s(self) -> float:
        """Time in s since these times were begun, by the clock."""
        return time.perf_counter() - self._started

    def _book_own(self) -> None:
        now = time.thread_time()
        if self._step:
            self._book(self._step, now - self._since)
        self._since = now

    def _book(self, name: str, seconds: float) -> None:
        with self._lock:
            self._seconds[name] = self._seconds.get(name, 0.0) + seconds


def stage(times: Progress | None, name: str) -> AbstractContextManager[None]:
    """Return `times.stage(name)`, or a context that does nothing where `times` is None or no StageTimes."""
    return times.stage(name) if isinstance(times, StageTimes) else nullcontext()
