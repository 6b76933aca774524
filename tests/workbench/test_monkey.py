"""Somebody plays with the window for a while; `python -m tests.workbench.monkey --seconds 1800` for the long proof."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.workbench.monkey import MARK, mark_processes, marked_processes


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="processes are listed on Linux")
def test_a_process_that_is_left_is_seen_though_what_started_it_has_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(MARK, "")  # put back at the end
    mark = mark_processes()
    sleep = "import subprocess, sys; print(subprocess.Popen([sys.executable, '-c', 'input()'], stdin=0).pid)"
    with subprocess.Popen(
        [sys.executable, "-c", sleep], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as starter:
        assert starter.stdin is not None and starter.stdout is not None
        left = int(starter.stdout.readline())
        starter.wait(20)
        assert [one.partition(":")[0] for one in marked_processes(mark)] == [str(left)]
    deadline = time.monotonic() + 20
    while marked_processes(mark) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert marked_processes(mark) == []


@pytest.mark.accuracy
def test_nothing_goes_wrong_while_somebody_plays_with_the_window(finished_project_folder: Path) -> None:
    command = [sys.executable, "-X", "faulthandler", "-m", "tests.workbench.monkey", "--seconds", "30", "--seed", "1"]
    command += ["--project", str(finished_project_folder)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=240, env=os.environ)
    print(ran.stdout)
    assert ran.returncode == 0, ran.stdout + ran.stderr
