"""The list of all results in a folder, from gauge.json and inspection.json alone."""

from __future__ import annotations

from pathlib import Path

from core.files.results.gauge_file import read_thickness
from core.files.results.inspection_file import read_inspection
from core.files.step_graph import FILES
from core.inspect.result_list import ResultList


def read_results(folder: Path) -> ResultList:
    """Read the thickness and the inspection in a folder, if they are there; InputError if a file is damaged."""
    gauge, inspection = folder / FILES["gauge"], folder / FILES["inspection"]
    thickness = read_thickness(gauge) if gauge.is_file() else None
    if not inspection.is_file():
        return ResultList(thickness)
    file = read_inspection(inspection)
    return ResultList(thickness, file.characteristics, file.unmeasured)
