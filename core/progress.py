"""Progress of long jobs: they report how far they are, and learn that they should stop."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Protocol, TypeVar

T = TypeVar("T")


class Progress(Protocol):
    """Receiver of a job's progress; every job that can last a second takes one.

    Called with a short name of the step, how much is done and of how much. It may raise
    :class:`core.errors.Cancelled`; the job lets that pass and leaves nothing half done.
    """

    def __call__(self, step: str, done: int, total: int) -> None: ...


def silent(step: str, done: int, total: int) -> None:
    """Ignore a report of progress, and never cancel: the default for `progress`."""


class StepProgress:
    """Progress that remembers its last report.

    `within_step` is the progress for a part of a step: it moves nothing, but the job can be cancelled there too.
    """

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._last: tuple[str, int, int] | None = None

    def __call__(self, step: str, done: int, total: int) -> None:
        self._last = (step, done, total)
        self._progress(step, done, total)

    def within_step(self, step: str, done: int, total: int) -> None:
        """Report progress as the position in the whole step, whatever position in its part is given."""
        self._progress(*(self._last or (step, done, total)))


def steps(items: Iterable[T], progress: Progress, step: str, total: int) -> Iterator[T]:
    """Yield `items`, reporting each to `progress` when it is asked for, and the end after the last."""
    for done, item in enumerate(items):
        progress(step, done, total)
        yield item
    progress(step, total, total)
