"""A progress bar on a terminal, silence in a pipe; and Ctrl-C, which no job may miss."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from rich.console import Console
from rich.progress import Progress as RichProgress
from rich.progress import ProgressColumn, Task, TextColumn, TimeElapsedColumn
from rich.progress_bar import ProgressBar
from rich.text import Text

from core.cli.language import told, tr
from core.errors import Cancelled
from core.progress import Progress
from core.remaining import USUAL_S, Remaining, in_words

_WIDTH = 40
"""Characters: stage and time left have room beside it on a terminal of 80."""


@contextmanager
def bar(job: str = "") -> Iterator[Progress]:
    """A `Progress` that draws one bar for all of a job on standard error, if that is a terminal; Ctrl-C cancels.

    `job` is its name in `USUAL_S`, if it is one of these.
    """
    with _interruptible() as check:
        if not sys.stderr.isatty():
            yield lambda step, done, total: check()
            return
        remaining, telling = Remaining(USUAL_S.get(job, {})), threading.Lock()  # it is drawn by a thread of its own
        columns = (
            TextColumn("{task.description:<28}", markup=False),
            _Whole(remaining, telling),
            TimeElapsedColumn(),
            _Left(remaining, telling),
        )
        with RichProgress(*columns, console=Console(stderr=True), transient=True) as drawn:
            shown = drawn.add_task("", total=None)

            def show(step: str, done: int, total: int) -> None:
                check()
                with telling:
                    remaining.tell(step, done, total)
                said = told(step)
                drawn.update(shown, description=said, refresh=said != drawn.tasks[0].description)

            yield show


class _Column(ProgressColumn):
    """Shows what is known of a job whenever it is drawn: a stage that tells nothing goes on, too."""

    def __init__(self, remaining: Remaining, telling: threading.Lock) -> None:
        super().__init__()
        self._remaining, self._telling = remaining, telling


class _Whole(_Column):
    def render(self, task: Task) -> ProgressBar:
        with self._telling:
            share = self._remaining.share
        return ProgressBar(total=1.0, completed=share or 0.0, width=_WIDTH, pulse=share is None)


class _Left(_Column):
    def render(self, task: Task) -> Text:
        with self._telling:
            left = self._remaining.left
        return Text("" if left is None else tr("about {time} left", time=in_words(left)))


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
