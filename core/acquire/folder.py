"""Frames from files: in order, a few decoded ahead of the one that is measured."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TypeVar

from core.threads import cores, ordered_map

T = TypeVar("T")


MOST_THREADS = 8
"""Decoding a PNG takes several times as long as measuring it: one thread for each core, but no more than that."""


def read_ahead(
    paths: Iterable[Path], read: Callable[[Path], T], *, threads: int | None = None
) -> Iterator[tuple[Path, T]]:
    """Yield each path with what `read` returns for it, in the order of `paths`, the next few being read on threads.

    While the caller works on one, the next few are read on `threads` threads, one for each core; how many wait does not
    depend on how many there are, nor does memory. An exception that `read` raises is raised here when that file's turn
    comes.
    """

    def job(path: Path) -> tuple[Path, T]:
        return path, read(path)

    return ordered_map(job, paths, threads or min(MOST_THREADS, cores()))
