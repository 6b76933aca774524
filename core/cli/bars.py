"""Progress bars on a terminal, silence in a pipe; and Ctrl-C, which no job may miss."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.progress import Progress as RichProgress

from core.errors import Cancelled
from core.progress import Progress


@contextmanager
def bars() -> Iterator[Progress]:
    """A `Progress` that draws one bar a step on standard error, if that is a terminal, and cancels after Ctrl-C."""
    with _interruptible() as check:
        if not sys.stderr.isatty():
            yield lambda step, done, total: check()
            return
        columns = (
            TextColumn("{task.description:<28}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
        )
        with RichProgress(*columns, console=Console(stderr=True), transient=True) as drawn:
            tasks: dict[str, TaskID] = {}

            def show(step: str, done: int, total: int) -> None:
                check()
                if step not in tasks:
                    tasks[step] = drawn.add_task(step, total=total)
                drawn.update(tasks[step], completed=done, total=total)

            yield show


@contextmanager
def _interruptible() -> Iterator[Callable[[], None]]:
    """Remember Ctrl-C besides raising KeyboardInterrupt, and give a check that raises Cancelled if it came.

    Python drops an exception that falls into a finaliser or a callback of compiled code, and the job would go on.
    """
    asked = threading.Event()

    def ask(signum: int, frame: FrameType | None) -> None:
        asked.set()
        raise KeyboardInterrupt

    def check() -> None:
        if asked.is_set():
            raise Cancelled

    if threading.current_thread() is not threading.main_thread():
        yield check  # signals reach the main thread only
        return
    before = signal.signal(signal.SIGINT, ask)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)
