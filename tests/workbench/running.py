"""The real program in a process group of its own, to be killed: it runs what `tests.workbench.driven` does."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

from core.compiled import FOLDER

ROOT = Path(__file__).parents[2]
START_S = 180.0


class Running:
    """The program in a process group of its own, and what it has said."""

    def __init__(self, home: Path, *arguments: str) -> None:
        environment = os.environ | {
            "QT_QPA_PLATFORM": "offscreen",
            "TRISECT_NO_OPENGL": "none",
            "HOME": str(home),
            "NUMBA_CACHE_DIR": str(FOLDER.parents[1]),  # compiled code of the true home
            "XDG_CONFIG_HOME": str(home / "config"),
            "XDG_STATE_HOME": str(home / "state"),
        }
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.workbench.driven", *arguments],
            cwd=ROOT,
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def said(self, wanted: Callable[[str], bool]) -> str:
        """Wait for a line that is wanted."""
        assert self.process.stdout is not None
        patience = threading.Timer(START_S, self.process.kill)  # a program that says nothing more ends, too
        patience.start()
        try:
            for line in self.process.stdout:
                if wanted(line.strip()):
                    return line.strip()
        finally:
            patience.cancel()
        raise AssertionError(f"the program ended with {self.process.wait(5)}, or did not get there in {START_S:.0f} s")

    def kill(self, *, everything: bool) -> None:
        """kill -9: the window's process alone, or all of its processes at once."""
        if everything:
            os.killpg(self.process.pid, signal.SIGKILL)
        else:
            self.process.kill()
        self.process.wait(10)

    def members(self) -> list[int]:
        """Processes of the group that still run."""
        found = []
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                state, _, group = stat.read_text().rpartition(")")[2].split()[:3]
            except OSError:
                continue
            if int(group) == self.process.pid and state != "Z":
                found.append(int(stat.parent.name))
        return found
