"""Proofs that would begin too late are told, not begun."""

import subprocess
import sys
import time

import pytest

from tests.code import ROOT

ONE = "def test_one():\n    pass\n"


@pytest.mark.parametrize(("left_s", "said"), [(-1, "1 skipped"), (600, "1 passed"), (None, "1 passed")])
def test_what_would_begin_too_late_is_left_out_and_said(tmp_path, monkeypatch, left_s, said):
    (tmp_path / "test_one.py").write_text(ONE)
    monkeypatch.setenv("TRISECT_TRY_UNTIL", "" if left_s is None else str(time.time() + left_s))
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    command = [sys.executable, "-m", "pytest", "-p", "tests.time_left", "-rs", "-q", "-c", "/dev/null", tmp_path]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert said in told.stdout and told.returncode == 0, told.stdout + told.stderr
    assert ("NOT TRIED for want of time" in told.stdout) == (said == "1 skipped")
