"""What a project's results come to, in short: whether the part is good."""

from __future__ import annotations

from pathlib import Path

from core.files.project.folder import results_in
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import WORST_FIRST, Verdict
from core.pipeline.steps.report_step import results_content
from core.progress import Progress, silent


def project_characteristics(folder: Path, progress: Progress = silent) -> tuple[Characteristic, ...]:
    """Every characteristic among the results of the project in `folder` (or of results), the worst first.

    Raises
    ------
    InputError
        If there is no scan among the results, or they are damaged.
    """
    progress("results", 0, 1)
    found = results_content(results_in(folder)).characteristics
    order = (*WORST_FIRST, Verdict.NONE)
    return tuple(sorted(found, key=lambda one: (order.index(one.verdict), one.room)))
