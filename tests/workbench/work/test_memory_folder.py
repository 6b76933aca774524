"""Folders in memory for large arrays: those of killed programs go."""

import os
import subprocess
import sys

from workbench.work import wire


def test_what_a_killed_program_left_in_memory_is_swept_and_nothing_else(tmp_path, monkeypatch):
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    for name in (f"trisect-{ended.pid}-aa", f"trisect-{os.getpid()}-bb", "trisect-monkey-cc", "other"):
        (tmp_path / name).mkdir()
    (tmp_path / f"trisect-{ended.pid}-aa" / "array").write_bytes(b"x")
    wire._sweep(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        (f"trisect-{os.getpid()}-bb", "trisect-monkey-cc", "other")
    )
