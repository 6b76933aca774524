"""The whole job clicked through from a recorded set: the window gives what the command line's pipeline gives."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from core.files.ply import read_cloud
from core.pipeline import run
from core.pipeline.options import Options
from core.pipeline.workspace import FILES
from tests.workbench.technician import Technician


@pytest.mark.slow
def test_from_new_project_to_report_and_cloud_with_the_numbers_of_the_pipeline(
    technician: Technician, small_recordings: Path, tmp_path: Path
) -> None:
    t = technician
    folder = t.new_project("Block 50")
    t.type_in(t.field("Part"), "Gauge block")
    t.type_in(t.field("Operator"), "Somebody")
    assert t.model.project.info.part == "Gauge block"
    t.next()

    for part in ("camera", "planes"):
        t.will_choose(small_recordings / part)
        t.press("Recorded folder")
        t.press("Choose folder …")
        t.press("Accept")
        t.next()

    t.will_choose(small_recordings / "scan")
    t.press("Recorded folder")
    t.press("Choose folder …")
    t.unfold("Settings")
    t.type_in(t.field("Largest σ"), "0.3")
    t.until(lambda: t.model.project.options.sigma_cut_mm == 0.3, "the cut")
    t.press("Measure")
    t.next(60)

    t.press("Measure again")
    t.until(lambda: not t.bench.measuring.busy, "the thickness measured again")
    t.type_in(t.field("Nominal thickness"), "50")
    t.type_in(t.field("Tolerance ±"), "0.2")
    t.press("Measure again")
    t.press("Add to repeats")
    assert len(t.model.project.repeats) == 1
    t.next()

    t.press("Make the report")
    t.until(lambda: "report" in t.model.results, "the report")
    for name, button in (("report.pdf", "PDF"), ("cloud.ply", "PLY")):
        t.will_choose(tmp_path / name)
        t.press(button)
        t.until(lambda name=name: (tmp_path / name).exists() and not t.bench.measuring.busy, name)
    assert t.errors() == []

    assert [t.window.rail.state_of(step) for step in t.window.pages] == ["done"] * 6
    expected = run(small_recordings, tmp_path / "out", Options(sigma_cut_mm=0.3))
    gauge = json.loads((folder / "results" / FILES["gauge"]).read_text())
    assert expected.gauge is not None
    assert gauge["thickness_mm"] == expected.gauge.thickness_mm
    assert gauge["U_mm"] == expected.gauge.U_mm
    for key in ("cloud", "mesh", "camera", "planes"):
        ours, theirs = folder / "results" / FILES[key], tmp_path / "out" / FILES[key]
        assert ours.read_bytes() == theirs.read_bytes(), key
    assert len(read_cloud(tmp_path / "cloud.ply").cloud) == expected.points
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
