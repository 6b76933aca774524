"""What tests share: pictures of others beside this checkout, and what is slow to make and so is made once."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TypeVar

import pytest

REAL_SETS = Path(__file__).resolve().parents[2] / "shared" / "real"
"""Photographs of others with published results; tests that need them are skipped where they are not."""
CASES = REAL_SETS.parent / "cases"
"""Small inputs that others filed, a `make.sh` each; the same holds of them."""

GIVE_UP_S = 240.0

MADE = "TRISECT_MADE_ONCE"
"""Environment variable: the folder of what is made once, for all parts of `make test`; else each makes its own."""

SAID_ALOUD = pytest.StashKey[int]()
"""Where a test process that ends at once says why: standard error while a test runs is pytest's, and would be lost."""


ENOUGH = 5
"""Sets in a row that hold a claim: of a claim that every second set breaks, that many hold once in 32."""

K = TypeVar("K")


def each_once(kinds: Iterable[K], seeds: Iterable[int], least: int = ENOUGH) -> list[tuple[K, int]]:
    """Pairs of a kind and a seed by which a claim on all of both is certain: each kind once, `least` sets or more.

    How often it holds over many seeds is for the campaigns of `make accuracy`, with its figures.
    """
    each, some = [*kinds], [*seeds]
    count = max(least, len(each))
    return [(each[i % len(each)], some[(i % len(each) + i // len(each)) % len(some)]) for i in range(count)]


def made_once(tmp_path_factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """The folder `name`, filled by `make` in whichever test process comes first; the others wait for it."""
    base: Path = tmp_path_factory.getbasetemp()
    of_all_processes = base.parent if base.name.startswith("popen-") else base  # of pytest-xdist
    common = Path(os.environ.get(MADE) or of_all_processes)
    folder, lock, end = common / name, common / f"{name}.lock", time.monotonic() + GIVE_UP_S
    while not folder.exists():
        try:
            lock.mkdir()
        except FileExistsError:
            if time.monotonic() > end:
                raise TimeoutError(f"another test process does not finish {name}") from None
            time.sleep(0.1)
            continue
        try:
            if not folder.exists():
                beside = common / f"{name}.part"
                shutil.rmtree(beside, ignore_errors=True)
                make(beside)
                beside.rename(folder)
        finally:
            lock.rmdir()
    return folder
