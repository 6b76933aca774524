"""Somebody plays with the window for a while; `python -m tests.workbench.monkey --seconds 1800` for the long proof."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.accuracy
def test_nothing_goes_wrong_while_somebody_plays_with_the_window(finished_project_folder: Path) -> None:
    command = [sys.executable, "-X", "faulthandler", "-m", "tests.workbench.monkey", "--seconds", "30", "--seed", "1"]
    command += ["--project", str(finished_project_folder)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=240, env=os.environ)
    print(ran.stdout)
    assert ran.returncode == 0, ran.stdout + ran.stderr
