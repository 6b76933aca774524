"""How a long job tells how far it is, and learns that it should stop."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Protocol, TypeVar

T = TypeVar("T")


class Progress(Protocol):
    """What any job that can last a second is given.

    Called with a short name of the step, how much is done and of how much. It may raise
    :class:`core.errors.Cancelled`; the job lets that pass and leaves nothing half done.
    """

    def __call__(self, step: str, done: int, total: int) -> None: ...


def silent(step: str, done: int, total: int) -> None:
    """Say nothing and never cancel: the default."""


class Told:
    """A progress that remembers what it told last.

    `again` is the progress for a part of a step: it moves nothing, but the job can be cancelled there too.
    """

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._last: tuple[str, int, int] | None = None

    def __call__(self, step: str, done: int, total: int) -> None:
        self._last = (step, done, total)
        self._progress(step, done, total)

    def again(self, step: str, done: int, total: int) -> None:
        """Tell once more where the whole step is, whatever a part of it says."""
        self._progress(*(self._last or (step, done, total)))


def steps(items: Iterable[T], progress: Progress, step: str, total: int) -> Iterator[T]:
    """Pass `items` on, reporting each one to `progress` as it is asked for and the end when all are done."""
    for done, item in enumerate(items):
        progress(step, done, total)
        yield item
    progress(step, total, total)
