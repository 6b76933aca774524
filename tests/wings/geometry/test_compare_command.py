"""`trisect compare`: a scan against another, worn where the truth is known; exit codes, files, and the report's row."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

from core.files.results.mesh_export import write_stl
from core.files.results.ply import read_cloud, write_cloud
from core.files.results.ply_format import parse_ply
from core.messages import plain
from core.pipeline.steps.report_step import results_content
from core.scan.surface.fused_surface import Mesh
from core.simulate.scene.objects import gauge_block
from core.wings.geometry.comparison.comparison_file import read_comparison
from tests.simulated import copy_of, trisect
from tests.test_cli_talk import completed
from tests.test_extras import extras_loaded_by

WEAR_MM = 0.4
"""The small set is noisy."""


@pytest.fixture
def results(measured, tmp_path):
    return copy_of(measured, tmp_path / "out")


@pytest.fixture
def before(results, tmp_path):
    """The same scan, its upper part higher by WEAR_MM: what it was before it wore."""
    file = read_cloud(results / "cloud.ply")
    cloud = file.cloud
    worn = cloud.points[:, 2] < np.quantile(cloud.points[:, 2], 0.2)
    towards = cloud.points / np.linalg.norm(cloud.points, axis=1)[:, None]
    points = cloud.points - WEAR_MM * worn[:, None] * towards
    path = tmp_path / "before.ply"
    write_cloud(path, replace(cloud, points=points), file.calibration_id)
    return path


def test_a_scan_compared_with_itself_has_not_changed(results, tmp_path):
    said = trisect("compare", results, results, "--to", tmp_path / "to")
    assert said.code == 0, said.err
    assert said.out.count("nowhere significant") == 2
    assert not (results / "comparison.json").exists()


def test_wear_is_told_written_and_reported(results, before):
    said = trisect("compare", before, results, "--json")
    assert said.code == 0, said.err
    told = json.loads(said.out)
    assert told["other"] == "before.ply"
    assert told["lower"]["mean_mm"] == pytest.approx(-WEAR_MM, abs=0.15)
    assert told["lower"]["share"] > told["higher"]["share"]
    rows = list(csv.DictReader((results / "comparison.csv").read_text().splitlines()))
    points = parse_ply((results / "comparison.ply").read_bytes()).elements["vertex"]
    assert len(rows) == len(points) == told["core_points"]
    significant = np.array([row["significant"] == "1" for row in rows])
    beyond = np.array([abs(float(row["deviation_mm"])) > float(row["lod95_mm"]) for row in rows])
    assert np.array_equal(significant, beyond)
    assert np.array_equal(points["significant"].astype(bool), significant)
    content = results_content(results)
    told = {str(fact.label): fact for fact in content.below_results["comparison"].facts}
    assert told["compared with"].value == plain("before.ply")
    assert told["detectable from"].value == read_comparison(results / "comparison.json").lod95_mm
    assert read_comparison(results / "comparison.json").alignment == "as measured"


def test_a_block_as_it_should_be_differs_from_its_drawing_by_chance_alone(results, tmp_path):
    corners = gauge_block(50.0).triangles
    block, flat = tmp_path / "block.stl", corners.reshape(-1, 3)
    write_stl(block, Mesh(flat, np.zeros_like(flat), np.zeros(len(flat)), np.arange(len(flat)).reshape(-1, 3)))
    said = trisect("compare", block, results, "--align", "best fit", "--json")
    assert said.code == 0, said.err
    told = json.loads(said.out)
    assert told["lower"]["share"] + told["higher"]["share"] < 0.05  # of 95 % none is by chance beyond it
    assert max(abs(told[side]["extreme_mm"] or 0.0) for side in ("lower", "higher")) < 0.5


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--align", "upside down"], "no alignment"),
        (["--align", "frame"], "no part coordinates"),
        (["--diameter", "-1"], "length in mm"),
        (["--reach", "0"], "length in mm"),
    ],
)
def test_what_cannot_be_asked_is_refused_in_one_sentence(results, arguments, said):
    refused = trisect("compare", results, results, *arguments)
    assert refused.code == 2
    assert said in refused.err


def test_a_folder_that_is_not_there_is_refused_in_one_sentence(tmp_path):
    said = trisect("compare", tmp_path / "wrong", tmp_path / "wrong")
    assert (said.code, bool(said.sentence)) == (2, True)


def test_a_damaged_comparison_costs_the_report_nothing_else(results):
    (results / "comparison.json").write_text("{}")
    content = results_content(results)
    assert "comparison" not in content.facts
    assert [note for note in content.notes if note.code == "plugin.failed"]


def test_a_comparison_needs_no_extra_and_a_shell_completes_it_without_numba():
    assert extras_loaded_by("core.wings.geometry.comparing") == []
    assert "compare" in completed("trisect ")
