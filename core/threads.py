"""Parallel work in threads with bounded memory and results in order."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import suppress
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

IDLE_EVERY_S = 0.2
"""Time in s between calls of `idle` while a result is waited for: a job is cancelled within this."""
MOST_WORKERS = 4
"""Threads that are used unless more are asked for: decoding and filtering gain little by more."""
READ_AHEAD = 1
"""Items for each worker that are begun before their turn: each may hold a picture."""


def cores() -> int:
    """Count the processor cores that this process may use."""
    with suppress(AttributeError):
        return len(os.sched_getaffinity(0))  # where an administrator or `taskset` leaves it some of them only
    return os.cpu_count() or 1


def ordered_map(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    workers: int | None = None,
    idle: Callable[[], object] | None = None,
) -> Iterator[Result]:
    """Apply `function` to `items` in threads, yielding results in the order of the items.

    At most one item per worker is read ahead, so memory does not grow with their number. Pictures are decoded and
    filtered outside Python's lock; so threads help. An exception is raised at its item's turn.
    While a result is waited for, `idle` is called now and then, on the caller's thread; when it raises, what is under
    way is left to end by itself.
    """
    workers = workers or min(MOST_WORKERS, cores())
    pool = ThreadPoolExecutor(workers)
    waiting: deque[Future[Result]] = deque()
    try:
        for item in items:
            waiting.append(pool.submit(function, item))
            if len(waiting) > READ_AHEAD * workers:
                yield result_of(waiting.popleft(), idle)
        while waiting:
            yield result_of(waiting.popleft(), idle)
        pool.shutdown()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def result_of(future: Future[Result], idle: Callable[[], object] | None) -> Result:
    """Wait for a future and return its result, calling `idle` now and then meanwhile."""
    while idle is not None and not wait([future], IDLE_EVERY_S).done:
        idle()
    return future.result()
