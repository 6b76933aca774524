"""What a project's results come to, in short: whether the part is good."""

from __future__ import annotations

from pathlib import Path

from core.files.project.folder import results_in
from core.inspect.result_list import ResultList
from core.pipeline.steps.report_step import results_content
from core.progress import Progress, silent


def listed_results(folder: Path, progress: Progress = silent) -> ResultList:
    """Read all measured values in `folder`, of a project or of results alone, with the verdict on the part.

    Raises
    ------
    InputError
        If there is no scan among the results, or they are damaged.
    """
    progress("results", 0, 1)
    return results_content(results_in(folder)).results
