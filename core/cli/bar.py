"""How far a job is, on standard error: a bar on a terminal, else a line a stage."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager

from rich.console import Console
from rich.progress import Progress as RichProgress
from rich.progress import ProgressColumn, Task, TextColumn, TimeElapsedColumn
from rich.progress_bar import ProgressBar
from rich.text import Text

from core.cli.interrupts import interruptible
from core.cli.language import text_of, tr
from core.cli.talk import is_quiet, is_verbose, print_line
from core.progress import Progress
from core.remaining import USUAL_S, Remaining, in_words

_WIDTH = 40
"""Characters: stage and time left have room beside it on a terminal of 80."""
_LONG_S = 1.0
"""From so many seconds on it is worth a line how long a stage took."""


@contextmanager
def bar(job: str = "") -> Iterator[Progress]:
    """Make a context whose `Progress` shows a job on standard error, and raises Cancelled after Ctrl-C or SIGTERM.

    `job` is its name in `USUAL_S`, if it is one of these.
    """
    telling = _lines(_LONG_S) if prints_lines() else _quiet() if is_quiet() else _drawn(job)
    with interruptible() as interrupts, telling as show:

        def progress(step: str, done: int, total: int) -> None:
            interrupts.check()
            show(step, done, total)

        yield progress


def prints_lines() -> bool:
    """Whether progress is shown as lines instead of a bar: off a terminal, unless `--quiet`."""
    return not is_quiet() and not sys.stderr.isatty()


def lines_of(name: str) -> AbstractContextManager[Progress]:
    """Make a context whose `Progress` prints a line, beginning with `name`, for each stage that ends."""
    return _lines(0.0, begun=False, of=name)


@contextmanager
def _quiet() -> Iterator[Progress]:
    yield lambda step, done, total: None


@contextmanager
def _lines(long_s: float, *, begun: bool = True, of: str = "") -> Iterator[Progress]:
    """A line when a stage begins, if that is wanted, and how long it took if it was long; `of` stands before it."""
    stage, since = "", time.monotonic()

    def end() -> None:
        took = time.monotonic() - since
        if stage and (is_verbose() or took >= long_s):
            said = f"{of}, {text_of(stage)}" if of else text_of(stage)
            print_line(tr("{stage}: {seconds:.1f} s", stage=said, seconds=took))

    def show(step: str, done: int, total: int) -> None:
        nonlocal stage, since
        if step == stage:
            return
        end()
        stage, since = step, time.monotonic()
        if begun:
            print_line(tr("{stage} …", stage=text_of(stage)))

    yield show
    end()


@contextmanager
def _drawn(job: str) -> Iterator[Progress]:
    """One bar for all of the job; with ``--verbose`` the times of its stages stay above it."""
    remaining, telling = Remaining(USUAL_S.get(job, {})), threading.Lock()  # it is drawn by a thread of its own
    columns = (
        TextColumn("{task.description:<28}", markup=False),
        _Whole(remaining, telling),
        TimeElapsedColumn(),
        _Left(remaining, telling),
    )
    with (
        RichProgress(*columns, console=Console(stderr=True), transient=True) as drawn,
        _lines(float("inf"), begun=False) as tell,
    ):
        shown = drawn.add_task("", total=None)

        def show(step: str, done: int, total: int) -> None:
            with telling:
                remaining.report(step, done, total)
            tell(step, done, total)
            said = text_of(step)
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
