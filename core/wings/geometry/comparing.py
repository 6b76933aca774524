"""What `trisect compare` does: compare, write, say it."""

from __future__ import annotations

import math
from contextlib import nullcontext
from pathlib import Path

from core.cli import output
from core.cli.measuring import Shown
from core.errors import InputError
from core.files.folder_lock import alone_in
from core.files.project.folder import is_project
from core.messages import Message
from core.progress import Progress
from core.wings.geometry.comparison.compare import ComparisonScales
from core.wings.geometry.comparison.compare_step import compare_step
from core.wings.geometry.comparison.facts import comparison_facts
from core.wings.geometry.comparison.in_project import compare_project


def run_compare(
    results: Path,
    other: Path,
    align: str,
    asked: tuple[float, float, float | None],
    to: Path | None,
    progress: Progress,
) -> Shown:
    """Compare a scan with another surface and write the result; `asked`: diameter, reach, registration in mm."""
    diameter, reach, registration = asked
    for name, value, least in (
        ("--diameter", diameter, 0.0),
        ("--reach", reach, 1e-6),
        ("--registration", registration, 0.0),
    ):
        if value is not None and not least <= value < math.inf:
            raise InputError(Message("comparison.length", "must be a length in mm"), where=name)
    scales = ComparisonScales(diameter, reach, registration)
    if to is None and is_project(results):
        made, written = compare_project(results, other, align, scales, progress)
    else:
        with alone_in(results) if results.is_dir() else nullcontext():
            made, written = compare_step(results, other, align, scales, to, progress)
    return Shown(output.fact_rows(comparison_facts(made.summary)), made.summary.values(), files=written)
