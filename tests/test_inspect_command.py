"""`trisect inspect` on a rendered recording: a table for people, the same numbers for machines, exit codes."""

import json
import shutil
from dataclasses import replace

import pytest

from core.files.plan.plan_file import read_plan
from core.files.recording.rig import default_rig, rig_to_toml
from core.files.results.inspection_file import read_inspection
from core.inspect.uncertainty.part import Part
from core.pipeline.steps.inspect_step import inspect, open_scan
from core.simulate.recording import simulate_set
from tests.simulated import CUT, SMALL, copy_of, trisect

PLAN = """
[[feature]]
name = "block"
kind = "thickness"
limits.thickness = { nominal_mm = 50, tolerance_mm = 2 }
[[feature]]
name = "table"
kind = "plane"
filters = { cell_mm = 4.0 }
[[feature]]
name = "steps"
kind = "steps"
nominal_heights_mm = [50]
limits.height = { lower_mm = -2, upper_mm = 2 }
"""


STEPS = """
[[feature]]
name = "stairs"
kind = "steps"
nominal_heights_mm = [40, 50, 60, 70]
limits.height = { lower_mm = -1, upper_mm = 1 }
"""
SHAFT = """
[[feature]]
name = "table"
kind = "plane"
[[feature]]
name = "shaft"
kind = "cylinder"
limits.diameter = { nominal_mm = 40, tolerance_mm = 3 }
[[feature]]
name = "axis"
kind = "distance"
of = ["shaft", "table"]
limits.distance = { nominal_mm = 20, tolerance_mm = 3 }
"""


@pytest.fixture(scope="module")
def results(measured, tmp_path_factory):
    folder = copy_of(measured, tmp_path_factory.mktemp("inspected") / "out")
    (folder / "plan.toml").write_text(PLAN)
    return folder


def test_a_folder_of_results_is_inspected_and_told_in_a_table(results):
    said = trisect("inspect", results, "--plan", results / "plan.toml")
    assert said.code == 0, said.err
    for word in ("block thickness", "table flatness", "steps height 1", "conforming", "inspection.json"):
        assert word in said.out
    file = read_inspection(results / "inspection.json")
    rows = {row.name: row for row in file.characteristics}
    assert rows["block thickness"].value == pytest.approx(50.0, abs=3 * rows["block thickness"].u)
    assert rows["steps height 1"].value == pytest.approx(50.0, abs=3 * rows["steps height 1"].u)
    assert len(file.points["block"]) > 1000
    assert file.kinds["steps"] == "steps"


def test_machines_files_and_windows_get_the_same_numbers_to_the_last_digit(results):
    said = json.loads(trisect("inspect", results, "--plan", results / "plan.toml", "--json").out)
    again = inspect(open_scan(results), read_plan(results / "plan.toml"), results)
    file = json.loads((results / "inspection.json").read_text())
    told = [(row["name"], row["value"], row["u"], row["verdict"]) for row in said["characteristics"]]
    assert told == [(row.name, row.value, row.u, row.verdict) for row in again.characteristics]
    assert told == [(row["name"], row["value"], row["u"], row["verdict"]) for row in file["characteristics"]]
    assert [feature["name"] for feature in file["plan"]["feature"]] == ["block", "table", "steps"]


def test_what_a_recording_set_states_of_the_part_counts_whatever_stood_in_it_when_the_thickness_was_measured(
    results, tmp_path
):
    rig = tmp_path / "rig.toml"
    rig.write_text(rig_to_toml(default_rig()))
    assert open_scan(tmp_path, results).errors.part == default_rig().part
    rig.write_text(rig_to_toml(replace(default_rig(), part=Part("steel", celsius=22.0, u_celsius=0.5))))
    assert open_scan(tmp_path, results).errors.part == Part("steel", celsius=22.0, u_celsius=0.5)


@pytest.mark.accuracy
@pytest.mark.parametrize(
    ("scenario", "plan", "names"),
    [
        (replace(SMALL, object="steps"), STEPS, [f"stairs height {number}" for number in (1, 2, 3, 4)]),
        (replace(SMALL, object="cylinder", height_mm=40.0, frames=30), SHAFT, ["shaft diameter", "axis distance"]),
    ],
    ids=["the block of 40, 50, 60 and 70 mm", "a lying shaft"],
)
def test_rendered_parts_have_their_true_measures(simulated, measured, tmp_path, scenario, plan, names):
    simulate_set(scenario, tmp_path / "set", calibration_from=simulated)
    for name in ("camera.json", "planes.json", "planes.npz"):
        shutil.copy(measured / name, tmp_path / name)
    assert trisect("scan", tmp_path / "set", "--out", tmp_path, *CUT).code == 0
    (tmp_path / "plan.toml").write_text(plan)
    said = json.loads(trisect("inspect", tmp_path, "--plan", tmp_path / "plan.toml", "--json").out)
    rows = {row["name"]: row for row in said["characteristics"]}
    errors = {name: rows[name]["value"] - rows[name]["limits"]["nominal"] for name in names}
    print({name: (round(error, 4), round(rows[name]["u"], 4)) for name, error in errors.items()})
    assert all(abs(error) < 3 * rows[name]["u"] for name, error in errors.items()), errors
    assert all(rows[name]["u"] < 0.5 for name in names)


def test_a_recording_set_is_inspected_with_its_results(simulated, results):
    said = trisect("inspect", simulated, "--plan", results / "plan.toml", "--out", results, "--json")
    assert said.code == 0
    refused = trisect("inspect", simulated, "--plan", results / "plan.toml")
    assert refused.code == 2
    assert "--out" in refused.sentence


def test_nothing_is_put_among_the_results_of_another_scan(results, tmp_path):
    """A verdict on the part would be given by another part's thickness, and a report would show both as one."""
    other = copy_of(results, tmp_path / "other")
    plan = ("--plan", results / "plan.toml", "--out", other)
    assert trisect("inspect", results, *plan).code == 0, "a copy is the same scan"
    (other / "inspection.json").unlink()
    (other / "cloud.ply").write_bytes((other / "cloud.ply").read_bytes()[:-1] + b"\0")
    for source in (results, results / "cloud.ply"):
        said = trisect("inspect", source, *plan)
        assert said.code == 2
        assert "another scan" in said.sentence and "--out" in said.sentence
    (other / "cloud.ply").unlink()
    assert trisect("inspect", results, *plan).code == 2, "its thickness is there"
    assert not (other / "inspection.json").exists()


def test_a_cloud_alone_is_inspected_and_says_what_is_not_known(results, tmp_path):
    (tmp_path / "lonely.ply").write_bytes((results / "cloud.ply").read_bytes())
    said = json.loads(trisect("inspect", tmp_path / "lonely.ply", "--plan", results / "plan.toml", "--json").out)
    assert any("less than is known" in note["text"] for note in said["notes"])
    assert said["files"] == {}
    assert said["verdict"] == "not proven"
    whole = json.loads(trisect("inspect", results / "cloud.ply", "--plan", results / "plan.toml", "--json").out)
    alone, known = (one["characteristics"][0] for one in (said, whole))
    assert alone["value"] == pytest.approx(known["value"], abs=0.2)
    assert not any("less than is known" in note["text"] for note in whole["notes"])


@pytest.mark.parametrize(
    ("plan", "code", "word"),
    [
        (PLAN.replace("nominal_mm = 50", "nominal_mm = 60"), 1, "not conforming"),
        (
            PLAN + '[[feature]]\nname = "ball"\nkind = "sphere"\nregion = { polygon_px = [[0,0],[9,0],[9,9]] }\n',
            1,
            "ball",
        ),
        ('[[feature]]\nname = "ball"\nkind = "sphere"\nregion = { polygon_px = [[0,0],[9,0],[9,9]] }\n', 2, "nothing"),
        ("[[feature]]\nname = 1\n", 2, "name"),
    ],
)
def test_exit_codes(results, tmp_path, plan, code, word):
    (tmp_path / "plan.toml").write_text(plan)
    said = trisect("inspect", results, "--plan", tmp_path / "plan.toml", "--out", tmp_path / "out")
    assert said.code == code
    assert word in said.out + said.err
