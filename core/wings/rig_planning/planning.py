"""What `trisect plan` does."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from core.cli.language import current_language
from core.cli.measuring import Shown
from core.errors import InputError
from core.messages import Message
from core.progress import Progress
from core.report.wording import Words
from core.settings.options import Options
from core.wings.rig_planning.plan_step import plan, plan_values, write_plan
from core.wings.rig_planning.plan_words import plan_rows


def run_plan(
    rig: Path,
    out: Path | None,
    *,
    scans: int,
    changes: bool,
    options: Options,
    bounds: bool = False,
    progress: Progress,
) -> Shown:
    """Predict what a planned rig will measure, write the files to `out` if given, and return what is to be printed."""
    if scans < 1:
        raise InputError(
            Message("design.too_few_scans", "{scans} scans cannot be drawn", scans=scans),
            where="--scans",
            todo=Message("advice.give_one_or_more", "give 1 or more"),
        )
    result = plan(rig, scans=scans, changes=changes, options=options, bounds=bounds, progress=progress)
    files: Mapping[str, Path] = {} if out is None else write_plan(result, out)
    return Shown(plan_rows(result, Words(current_language())), plan_values(result), files=files)
