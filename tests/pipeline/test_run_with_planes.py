"""A whole run with known planes in place of the fan, from rendered pictures to the report."""

from pathlib import Path

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
