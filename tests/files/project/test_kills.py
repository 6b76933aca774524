"""The short form of `python -m tests.soak_kills`, which runs in a process of its own: it forks."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.soak_kills import KINDS

ROOT = Path(__file__).parents[3]
FILES = ("saving", "autosave", "recording")


@pytest.mark.accuracy
@pytest.mark.skipif(sys.platform == "win32", reason="kill -9 is not known there")
@pytest.mark.parametrize(
    "kinds",
    [
        pytest.param(FILES, id="files"),
        *(pytest.param((kind,), id=kind, marks=pytest.mark.accuracy) for kind in KINDS if kind not in FILES),
    ],
)
def test_killed_at_any_moment_nothing_acknowledged_is_lost(kinds: tuple[str, ...]) -> None:
    words = [sys.executable, "-m", "tests.soak_kills", "--kills", "3", "--seed", "7", "--kinds", *kinds]
    ended = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.count("acknowledged was there each time") == len(kinds)
