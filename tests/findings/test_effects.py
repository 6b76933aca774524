"""What is known of a measured set reaches its verdict, whatever notes its files hold."""

import json
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest

from core.files.results.scan_file import read_scan, write_scan
from core.findings.proof import OF_SCAN, Doubt
from core.messages import plain
from tests.simulated import CUT, contents, copy_of, trisect

LIMITS = "\n[gauge]\nnominal_mm = 50.0\ntolerance_mm = 20.0\n"
"""So wide that what the tiny set measures conforms."""
TOP = """
[[feature]]
name = "block"
kind = "thickness"
limits.thickness = { nominal_mm = 50, tolerance_mm = 20 }
"""


@pytest.fixture(scope="module")
def wide(tiny_set, tiny_measured, tmp_path_factory):
    """The tiny set with wide limits, its thickness measured by them: folders of the set and of its results."""
    folder = tmp_path_factory.mktemp("wide")
    made, out = copy_of(tiny_set, folder / "set"), copy_of(tiny_measured, folder / "out")
    rig = made / "rig.toml"
    text = rig.read_text(encoding="utf-8")
    if "[gauge]" in text:
        head, _, rest = text.partition("[gauge]")
        _, found, behind = rest.partition("\n[")
        text = head + ("[" + behind if found else "")
    rig.write_text(text + LIMITS, encoding="utf-8")
    assert again(made, out, "gauge") == "conforming"
    return made, out


@pytest.fixture
def out(wide, tmp_path):
    return copy_of(wide[1], tmp_path / "out")


def verdict(out):
    return json.loads((out / "gauge.json").read_text(encoding="utf-8"))["verdict"]


def again(made, out, *steps):
    for step in steps:
        said = trisect(step, made, "--out", out, *(CUT if step == "scan" else ()))
        assert said.code in (0, 1), said.err
    return verdict(out)


def changed(path, **values):
    tables = json.loads(path.read_text(encoding="utf-8"))
    for name, value in values.items():
        tables.pop(name, None)
        if value is not None:
            tables[name] = value
    path.write_text(json.dumps(tables), encoding="utf-8")


def test_with_all_notes_stripped_from_all_files_the_verdict_is_as_before(wide, out):
    made, _ = wide
    assert verdict(out) == "conforming"
    for path in out.glob("*.json"):
        changed(path, notes={} if path.name == "run.json" else [])
    scan = read_scan(out / "scan.npz")
    write_scan(out / "scan.npz", replace(scan, features=replace(scan.features, notes=())))
    assert again(made, out, "gauge") == "conforming"
    changed(out / "planes.json", converged=False, notes=[])
    assert again(made, out, "scan", "gauge") == "not proven"


@pytest.mark.parametrize(
    "facts",
    [
        {"converged": False},
        {"converged": None},
        {"points_off_alike": True},
        {"points_off_alike": None},
        {"scale_assumed": True},
        {"scale_assumed": None},
        {"scale_sd": None},
        {"bends": None},
        {"by_camera": None},
    ],
)
def test_a_fact_of_the_planes_takes_away_the_proof_and_so_does_its_lack(facts, wide, out):
    changed(out / "planes.json", **facts)
    assert again(wide[0], out, "scan", "gauge") == "not proven"


@pytest.mark.parametrize(("facts", "proven"), [
    ({"converged": False}, "not proven"),
    ({"converged": None}, "conforming"),
    ({"converged": None, "views": []}, "not proven"),
])  # fmt: skip
def test_a_camera_that_had_not_settled_proves_nothing_nor_one_whose_views_do_not_show_it(facts, proven, wide, out):
    changed(out / "camera.json", **facts)
    assert again(wide[0], out, "scan", "gauge") == proven


def test_what_u_does_not_contain_takes_away_the_proof_in_every_file(wide, out):
    """A camera of another program without its covariance: U lacks what the camera adds."""
    changed(out / "camera.json", covariance=None)
    assert again(wide[0], out, "scan", "gauge") == "not proven"
    notes = json.loads((out / "gauge.json").read_text(encoding="utf-8"))["notes"]
    assert "inspection.missing_in_u" in [note["code"] for note in notes]
    (out / "plan.toml").write_text(TOP, encoding="utf-8")
    said = trisect("inspect", out, "--plan", out / "plan.toml", "--out", out)
    assert said.code == 1, said.err
    (row,) = json.loads((out / "inspection.json").read_text(encoding="utf-8"))["characteristics"]
    assert (row["verdict"], row["complete"]) == ("not proven", False)


@pytest.mark.parametrize("holds", [True, None])
@pytest.mark.parametrize("fact", OF_SCAN)
def test_a_fact_of_the_scan_takes_away_the_proof_and_so_does_its_lack(fact, holds, wide, out):
    scan = read_scan(out / "scan.npz")
    write_scan(out / "scan.npz", replace(scan, facts=replace(scan.facts, **{fact: holds})))
    assert again(wide[0], out, "gauge") == "not proven"
    doubts = json.loads((out / "gauge.json").read_text(encoding="utf-8"))["doubts"]
    assert doubts == [fact if holds else "scan_unknown"]


def test_a_scan_whose_light_planes_have_collapsed_writes_nothing(wide, out):
    before = contents(out)
    with patch("core.scan.network.adjustment.has_collapsed", return_value=True):
        said = trisect("scan", wide[0], "--out", out, *CUT)
    assert said.code == 2
    assert "fallen together into one" in said.sentence
    assert contents(out) == before


@pytest.mark.parametrize("stripped", ["", "of_the_day", "of_the_day_facts", "of_the_day of_the_day_facts"])
def test_a_fact_of_the_day_takes_away_the_proof_whatever_its_words(stripped, wide, out):
    """Without its note; and, as an earlier version wrote it, without its name."""
    scan, path = read_scan(out / "scan.npz"), out / "scan.npz"
    lapsed = Doubt("check_lapsed", plain("It was too long ago."))
    write_scan(path, replace(scan, facts=replace(scan.facts, of_the_day=(lapsed,))))
    if stripped:
        with np.load(path) as arrays:
            np.savez(path, **{name: array for name, array in arrays.items() if name not in stripped.split()})
    assert again(wide[0], out, "gauge") == "not proven"
    (fact,) = json.loads((out / "gauge.json").read_text(encoding="utf-8"))["doubts"]
    known = {"of_the_day_facts": "of_the_day", "of_the_day of_the_day_facts": "scan_unknown"}
    assert fact == known.get(stripped, "check_lapsed")
