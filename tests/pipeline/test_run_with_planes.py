"""A whole run with known planes in place of the fan, from rendered pictures to the report."""

import shutil
from pathlib import Path

import pytest

from core.files.results.run_file import read_run
from core.files.results.scan_file import read_scan
from core.files.step_graph import FILES
from core.inspect.causes import Cause
from core.pipeline.run import run
from core.settings.options import Options
from core.simulate.effects.boards import BoardsBeside
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario

CORNER = Scenario(
    scale=0.25, frames=24, camera_views=10, plane_poses=8, seed=5, fan_lines=0,
    boards=BoardsBeside(corner=True, kind="rectangle"),
)  # fmt: skip
OF_PLANES = {Cause.KNOWN_POSE, Cause.KNOWN_FLATNESS, Cause.KNOWN_FLATNESS_ASSUMED}
"""Of these there are rows in a budget where planes count."""


def measured(scenario: Scenario, folder: Path):
    simulate_set(scenario, folder / "set")
    result = run(folder / "set", folder / "out", Options(sigma_cut_mm=0.5))
    codes = {note.code for notes in read_run(folder / "out" / FILES["run"]).notes.values() for note in notes}
    return result, read_scan(folder / "out" / FILES["scan"]), codes


def test_a_corner_of_printed_rectangles_measures_without_a_fan(tmp_path):
    result, scan, codes = measured(CORNER, tmp_path)
    assert sorted(one.name for one in scan.planes) == ["far", "near"]
    assert scan.plane_check is None and "scan.planes_alone" in codes
    assert not (tmp_path / "out" / FILES["planes"]).exists()
    assert abs(result.gauge.thickness_mm - 50.0) < result.gauge.U_mm
    assert OF_PLANES & {row.source for row in result.gauge.budget}
    assert (tmp_path / "out" / FILES["report"]).exists()


@pytest.mark.accuracy
def test_a_plate_beside_the_fan_moves_no_value_and_is_no_cause_for_alarm(tmp_path: Path) -> None:
    """Tied as surely as it is known, the plate was told as moved: the fan's calibration errs by more."""
    simulate_set(Scenario(scale=0.25, frames=24, seed=5, boards=BoardsBeside(plate=True)), tmp_path / "set")
    beside = run(tmp_path / "set", tmp_path / "beside").gauge
    codes = {note.code for note in read_run(tmp_path / "beside" / "run.json").notes["scan"]}
    shutil.rmtree(tmp_path / "set" / "scan" / "planes")
    rig = (tmp_path / "set" / "rig.toml").read_text()
    before, _, table = rig.partition("[known_planes")
    (tmp_path / "set" / "rig.toml").write_text(before + ("[" + table.partition("\n[")[2] if table else ""))
    alone = run(tmp_path / "set", tmp_path / "alone").gauge
    assert beside is not None and alone is not None
    assert beside.thickness_mm == pytest.approx(alone.thickness_mm, abs=0.1 * alone.U_mm)
    assert abs(beside.thickness_mm - 50.0) < beside.U_mm and not beside.doubts
    assert "scan.planes_see_little" in codes or "scan.checked_by_planes" in codes


@pytest.mark.accuracy
def test_a_corner_of_chessboards_beside_the_fan_leaves_the_scan_to_be_measured(tmp_path: Path) -> None:
    """Its strips were taken for a hundred lines of the fan, and made all light as unsure as they are."""
    simulate_set(Scenario(scale=0.25, frames=24, seed=7, boards=BoardsBeside(corner=True)), tmp_path / "set")
    gauge = run(tmp_path / "set", tmp_path / "beside", Options(sigma_cut_mm=0.2)).gauge  # the table is far behind
    assert gauge is not None
    assert abs(gauge.thickness_mm - 50.0) < gauge.U_mm < 0.12
    scan = read_scan(tmp_path / "beside" / FILES["scan"])
    assert set(scan.fan_line) >= {0, 1, 2} and scan.plane_check is not None and scan.plane_check.agrees
