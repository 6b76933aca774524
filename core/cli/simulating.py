"""What `trisect simulate` and `trisect demo` do: recordings without a rig."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from core.cli import output
from core.pipeline import RunResult
from core.progress import Progress
from core.report.wording import thickness_line
from core.simulate.recording import simulate_set
from core.simulate.sample import sample_scenario, sample_set
from core.simulate.scenario import Scenario

PART = "gauge block of the embedded sample"
QUICK_SCALE, QUICK_FRAMES, QUICK_CUT_MM = 0.25, 24, 0.3


def render(scenario: Scenario, out: Path, progress: Progress) -> None:
    """Write the recording set of a scenario into a new folder; InputError if something is there already."""
    simulate_set(scenario, out, progress)


def show(out: Path, *, as_json: bool) -> None:
    """Say where the set is and what to do with it."""
    if as_json:
        output.print_json({"set": str(out)})
    else:
        sys.stdout.write(f"recording set in {out}; measure it with: trisect run {out} --out DIR\n")


@contextmanager
def sample(progress: Progress, *, quick: bool) -> Iterator[Path]:
    """The embedded sample's folder, rendered on first use; the quick one is smaller and forgotten afterwards."""
    if not quick:
        yield sample_set(progress)
        return
    scenario = replace(sample_scenario(), scale=QUICK_SCALE, frames=QUICK_FRAMES)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sample"
        simulate_set(scenario, path, progress)
        yield path


def show_demo(result: RunResult) -> None:
    """The last line of the demo: the one number, and what to open."""
    if result.gauge is not None:
        line = thickness_line(result.gauge)
        sys.stdout.write(f"\nThe sample block measures {line}; the report is {result.files['report']}.\n")
