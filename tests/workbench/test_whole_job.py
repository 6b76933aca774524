"""The whole job clicked through from a recorded set: the window gives what the command line's pipeline gives."""

from __future__ import annotations

import json
import shutil
from functools import partial
from pathlib import Path

import pytest

from core.files.results.ply import read_cloud
from core.files.step_graph import FILES
from core.pipeline.run import run
from core.settings.options import Options
from tests.workbench.technician import Technician
from tests.workbench.watchdog import Watchdog, slowness, too_long

UNSTATED = ("scale_sd", "flatness_mm", "celsius", "u_celsius")
"""What a new project does not state of its targets."""

watched: list[Watchdog] = []
"""The GUI thread during the whole job, for the test after it."""


def do_the_whole_job(t: Technician, recordings: Path, exports: Path) -> Path:
    """From the welcome page to the exported report; gives the project's folder."""
    folder = t.new_project("Block 50")
    t.type_in(t.field("Part"), "Gauge block")
    t.type_in(t.field("Operator"), "Somebody")
    assert t.model.project.info.part == "Gauge block"
    t.next()

    for part in ("camera", "planes"):
        t.will_choose(recordings / part)
        t.press("Recorded folder")
        t.press("Choose folder …")
        t.press("Accept")
        t.next()

    t.will_choose(recordings / "scan")
    t.press("Recorded folder")
    t.press("Choose folder …")
    t.unfold("Settings")
    t.type_in(t.field("Largest σ"), "0.3")
    t.until(lambda: t.model.project.options.sigma_cut_mm == 0.3, "the cut")
    t.press("Measure")
    t.next(90)

    t.type_in(t.field("Nominal thickness"), "50")
    t.type_in(t.field("Tolerance ±"), "0.2")
    t.press("Measure again")
    t.press("Add to repeats")
    assert len(t.model.project.repeats) == 1
    t.next()

    def written(file: Path) -> bool:
        return file.exists() and not t.bench.measuring.busy

    t.press("Make the report")
    t.until(lambda: "report" in t.model.results, "the report", 60)
    for name, button in (("report.pdf", "Report (PDF)"), ("cloud.ply", "Points (PLY)")):
        t.will_choose(exports / name)
        t.press(button)
        t.until(partial(written, exports / name), name)
    return folder


@pytest.mark.slow
def test_from_new_project_to_report_and_cloud_with_the_numbers_of_the_pipeline(
    technician: Technician, tiny_set: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    t = technician
    with Watchdog(t.doing) as dog:
        folder = do_the_whole_job(t, tiny_set, tmp_path)
    watched.append(dog)
    assert t.errors() == []
    assert [t.window.rail.state_of(step) for step in t.window.pages] == ["done"] * 6

    unstated = Path(shutil.copytree(tiny_set, tmp_path / tiny_set.name))
    rig = unstated / "rig.toml"
    stated = rig.read_text().split("[stability]")[0].splitlines()  # a new project states nothing of it, nor of targets
    rig.write_text("\n".join(line for line in stated if not line.startswith(UNSTATED)))
    monkeypatch.setattr("core.pipeline.run.report_step", lambda *_, **__: None)  # it has the same numbers, drawn
    expected = run(unstated, tmp_path / "out", Options(sigma_cut_mm=0.3))
    gauge = json.loads((folder / "results" / FILES["gauge"]).read_text())
    assert expected.gauge is not None
    assert gauge["thickness_mm"] == expected.gauge.thickness_mm
    assert gauge["U_mm"] == expected.gauge.U_mm
    assert gauge["verdict"] == expected.gauge.verdict
    for key in ("camera", "planes", "cloud", "mesh"):
        ours, theirs = folder / "results" / FILES[key], tmp_path / "out" / FILES[key]
        assert ours.read_bytes() == theirs.read_bytes(), key
    assert len(read_cloud(tmp_path / "cloud.ply").cloud) == expected.points
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.slow
def test_the_window_was_never_kept_waiting_meanwhile() -> None:
    if not watched:
        pytest.skip("the whole job was not done in this process")
    print(*watched[0].worst(10), sep="\n")
    assert len(watched[0].absences) > 500
    assert too_long(watched[0], slowness()) == []
