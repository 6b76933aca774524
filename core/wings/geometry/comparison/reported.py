"""The comparison among the results, as the report has it."""

from __future__ import annotations

from pathlib import Path

from core.files.step_graph import FILES
from core.report.facts.fact import Fact
from core.wings.geometry.comparison.comparison_file import read_comparison
from core.wings.geometry.comparison.facts import comparison_facts


def reported_facts(out: Path, _: object) -> tuple[Fact, ...]:
    """Make the facts on the comparison in the folder of results `out`; nothing where there is none.

    Raises
    ------
    InputError
        If the file is damaged.
    """
    path = out / FILES["comparison"]
    return comparison_facts(read_comparison(path)) if path.exists() else ()
