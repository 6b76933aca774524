"""Runs many cases in children, begun anew where one ends its process, and gathers what went wrong."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from tests.hostile.child import case_name

ROOT = Path(__file__).parents[2]


def run_cases(good: Path, work: Path, seed: int, first: int, last: int) -> dict[int, str]:
    """What went wrong, by the number of the case."""
    wrong: dict[int, str] = {}
    while first < last:
        words = [sys.executable, "-m", "tests.hostile.child", str(good), str(work), str(seed), str(first), str(last)]
        ended = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
        told = [json.loads(line) for line in ended.stdout.splitlines() if line.startswith("{")]
        wrong |= {one["case"]: f"{case_name(one['case'])}: {one['wrong']}" for one in told if "case" in one}
        begun = [one["begin"] for one in told if "begin" in one]
        if not begun:
            raise RuntimeError(ended.stderr)
        if "done" in told[-1]:
            break
        wrong[begun[-1]] = f"{case_name(begun[-1])}: the process ended ({ended.returncode}) {ended.stderr[-500:]}"
        first = begun[-1] + 1
    return wrong
