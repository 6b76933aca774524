"""Frames from files: in order, decoded a few ahead of whoever measures them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")


def read_ahead(
    paths: Iterable[Path], read: Callable[[Path], T], *, ahead: int = 4, threads: int = 2
) -> Iterator[tuple[Path, T]]:
    """Yield each path with what `read` makes of it, in the order of `paths`.

    While the caller works on one, the next ones are already being read on `threads` threads (decoders release
    Python's lock). At most `ahead` results wait, so memory does not grow with the number of paths.

    Parameters
    ----------
    paths
        The files.
    read
        Called on a worker thread. An exception it raises is raised here when that file's turn comes.
    ahead
        How many may be read before they are asked for.
    threads
        How many are read at once.
    """
    waiting: deque[tuple[Path, Future[T]]] = deque()
    pool = ThreadPoolExecutor(threads, thread_name_prefix="read-ahead")
    try:
        for path in paths:
            waiting.append((path, pool.submit(read, path)))
            if len(waiting) > ahead:
                first, result = waiting.popleft()
                yield first, result.result()
        while waiting:
            first, result = waiting.popleft()
            yield first, result.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
