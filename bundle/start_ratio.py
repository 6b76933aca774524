"""How long the frozen window takes to be shown, as a ratio to the unfrozen one, both in one run and by turns."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

BUILD = Path(__file__).parents[1] / "build" / "bundle"
TURNS = 3
"""Of each; one more before them, in which files get into the disk's memory, does not count."""
AT_MOST = 1.5
"""The frozen window may take so many times as long."""


def main() -> int:
    """Print both medians and their ratio; 1 if it is too large."""
    script = str(Path(__file__).with_name("try_start.py"))
    frozen = [str(BUILD / "dist" / "trisect" / "trisect-workbench"), "--module", script]
    unfrozen = [str(BUILD / "venv" / "bin" / "python"), script]
    seconds: dict[str, list[float]] = {"frozen": [], "unfrozen": []}
    for turn in range(TURNS + 1):
        for name, command in (("frozen", frozen), ("unfrozen", unfrozen)):
            took = shown_after(command)
            if turn:
                seconds[name].append(took)
    medians = {name: statistics.median(some) for name, some in seconds.items()}
    ratio = medians["frozen"] / medians["unfrozen"]
    told = ", ".join(f"{name} {median:.2f} s" for name, median in medians.items())
    print(f"start to shown window: {told}, ratio {ratio:.2f} (at most {AT_MOST})")
    return 0 if ratio <= AT_MOST else 1


def shown_after(command: list[str]) -> float:
    """Seconds from starting a program to its shown window."""
    environment = os.environ | ({} if os.environ.get("DISPLAY") else {"QT_QPA_PLATFORM": "offscreen"})
    began = time.perf_counter()
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.strip() == "shown":
                took = time.perf_counter() - began
                process.wait(60)
                return took
    raise SystemExit(f"{command[0]} has shown no window (exit code {process.returncode})")


if __name__ == "__main__":
    sys.exit(main())
