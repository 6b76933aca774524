"""The next part is measured with the calibrations of the one before, to the same figure."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from core.files.project.data import ProjectFile
from core.files.project.folder import read_project
from core.files.project.next_part import next_part
from core.files.step_graph import FILES
from core.pipeline.project.whole import measure_all


@pytest.mark.accuracy
def test_the_same_scan_gives_the_same_thickness_and_nothing_is_calibrated_anew(
    finished_small_project_folder: Path, simulated: Path, tmp_path: Path
) -> None:
    first = Path(shutil.copytree(finished_small_project_folder, tmp_path / "Block 1"))
    to = next_part(first, tmp_path / "Block 2", "2", "Ada")
    file = read_project(to)
    project = replace(file.project, sources=replace(file.project.sources, scan=str(simulated / "scan")))
    whole = measure_all(to, ProjectFile(project, file.results))
    assert whole.stop is None or whole.stop.page == "inspect", whole.stop
    thickness = [
        json.loads((folder / "results" / FILES["gauge"]).read_text())["thickness_mm"] for folder in (first, to)
    ]
    assert thickness[0] == thickness[1]
    assert whole.file.results["camera"] == file.results["camera"]
    assert whole.file.results["planes"] == file.results["planes"]
    assert (to / "results" / FILES["report"]).read_bytes().startswith(b"%PDF")
