"""Starting the process of a lane lean: without the window's own modules, and with the environment it should see."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import ModuleType

ONE_THREAD: Mapping[str, str] = {name: "1" for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}
"""Linear algebra on one core: for many small problems beside other work, more threads are slower."""


SWITCH_S = 0.001
"""A thread that waits for Python's lock is given it after so long, five times as soon as by itself: a picture that the
window receives piece by piece, or that a recording sends while it looks at the next, waits for the lock many times."""


def share_python_willingly() -> None:
    """Have the threads of this process take turns often."""
    sys.setswitchinterval(SWITCH_S)


@contextmanager
def lean_start(environment: Mapping[str, str]) -> Iterator[None]:
    """While a process is spawned: give it `environment`, and keep it from importing the program that spawns it.

    A spawned process runs the main module again to have its functions; here that would be the window with all of Qt,
    in every process. A lane's functions are imported by name instead, so an empty main module stands in.
    """
    main, before = sys.modules["__main__"], {name: os.environ.get(name) for name in environment}
    sys.modules["__main__"] = ModuleType("__main__")
    os.environ.update(environment)
    try:
        yield
    finally:
        sys.modules["__main__"] = main
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
