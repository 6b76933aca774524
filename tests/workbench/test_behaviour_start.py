"""The window is there soon, on any computer."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
AT_MOST_S = 20.0
"""Of processor time, which other work on the machine hardly changes; usual are 3 to 5 s."""


@pytest.mark.parametrize("opengl", ["", "1"], ids=["as it is", "no OpenGL"])
def test_the_program_starts_soon_imports_nothing_that_can_wait_and_ends_well(tmp_path: Path, opengl: str) -> None:
    environment = os.environ | {
        "HOME": str(tmp_path),
        "XDG_CONFIG_HOME": str(tmp_path / "config"),
        "XDG_STATE_HOME": str(tmp_path / "state"),
        "TRISECT_NO_OPENGL": opengl,
    }
    program = subprocess.run(
        [sys.executable, "-m", "tests.workbench.driven", "start"],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert program.returncode == 0, program.stderr
    said = dict(line.partition(" ")[::2] for line in program.stdout.splitlines())
    assert said["modules"] == ""
    assert float(said["seconds"]) < AT_MOST_S
    assert "Traceback" not in program.stderr
    (log,) = tmp_path.rglob("workbench.log") if list(tmp_path.rglob("workbench.log")) else (None,)
    assert log is None or "ERROR" not in log.read_text(encoding="utf-8")
