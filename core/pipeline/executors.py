"""Who measures the sets of a batch: threads, processes, or the workers of a Dask cluster."""

from __future__ import annotations

import importlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import Any

from core.errors import InputError
from core.extras import install
from core.messages import Message
from core.threads import cores

PROCESSES, THREADS, DASK = "processes", "threads", "dask://"
INSTALL = Message(
    "options.install_cluster",
    "A cluster needs Dask's distributed: install it with {command}",
    command=install("cluster"),
)
MOST_WORKERS = 61
"""Sets measured at a time on one machine: Windows waits for no more processes at once."""
CONNECT_S = 10.0
"""How long in s a cluster's scheduler may take to answer."""


@contextmanager
def executor_of(text: str, workers: int | None = None) -> Iterator[Executor]:
    """Make the executor that `text` names, of processes, threads or a Dask cluster; shut it down after the block.

    Parameters
    ----------
    text
        "processes" or "threads" of this machine, or "dask://HOST:PORT", the scheduler of a Dask cluster.
    workers
        How many sets are measured at a time; 61 at most; None: as many as there are cores. A cluster knows its own.

    Raises
    ------
    InputError
        If it is none of them, or the cluster does not answer.
    """
    if workers is not None and workers < 1:
        raise InputError(
            Message("options.no_workers", "{workers} workers cannot measure anything", workers=workers),
            where="--workers",
            todo=Message("advice.give_one_or_more", "give 1 or more"),
        )
    count = min(workers or cores(), MOST_WORKERS)
    if text == THREADS:
        with ThreadPoolExecutor(count) as threads:
            yield threads
    elif text == PROCESSES:
        spawn = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(count, spawn, initializer=_begin_worker) as pool:
            yield pool
    elif text.startswith(DASK):
        if workers is not None:
            raise InputError(
                Message("options.workers_of_cluster", "a cluster has workers of its own"),
                where="--workers",
                todo=Message("advice.leave_option_out", "leave it out"),
            )
        with _cluster(text.removeprefix(DASK)) as cluster:
            yield cluster
    else:
        raise InputError(
            Message(
                "options.no_such_executor",
                "{text!r} is none of {processes}, {threads} and {dask}HOST:PORT",
                text=text,
                processes=PROCESSES,
                threads=THREADS,
                dask=DASK,
            ),
            where="--executor",
        )


@contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as missing:
        raise InputError(INSTALL) from missing
    try:
        client = distributed.Client(f"tcp://{address}", timeout=CONNECT_S)
    except (OSError, ValueError, TimeoutError) as problem:
        todo = Message("advice.check_scheduler", "see that its scheduler runs and the address is right")
        raise InputError(
            Message("options.no_cluster", "the cluster does not answer"), where=f"{DASK}{address}", todo=todo
        ) from problem
    with client, client.get_executor(pure=False) as executor:
        yield executor


_to_end = threading.Event()


def is_to_end() -> bool:
    """Whether this process measures a set for another process, which has asked for it to be cancelled."""
    return _to_end.is_set()


def _begin_worker() -> None:
    """Ctrl-C reaches all processes of a terminal; the one that waits for the others ends them.

    What else asks a process to end may reach one alone: it leaves nothing half written. It ends at once, whatever it
    does, when the one that waits is gone.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), lambda *_: _to_end.set())
    above = multiprocessing.parent_process()
    if above is not None:
        threading.Thread(target=_end_with, args=(above.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)
