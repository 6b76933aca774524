"""The short form of `python -m tests.soak_kills`."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.soak_kills import KINDS, soak


@pytest.mark.accuracy
@pytest.mark.skipif(sys.platform == "win32", reason="kill -9 is not known there")
@pytest.mark.parametrize("kind", KINDS)
def test_killed_at_any_moment_nothing_acknowledged_is_lost(kind: str, tmp_path: Path) -> None:
    assert soak(kind, 2, 7, tmp_path) > 0
