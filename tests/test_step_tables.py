"""Each step of the command line wants its own tables of rig.toml, and no others."""

import re
import shutil

import pytest
from pypdf import PdfReader

from tests.simulated import copy_of, trisect


def with_tables(tiny_set, folder, *names):
    """A copy of the set whose rig.toml has these tables only."""
    copy_of(tiny_set, folder)
    tables = re.split(r"\n(?=\[)", (folder / "rig.toml").read_text())
    kept = [table for table in tables if table.partition("]")[0].lstrip("[") in names]
    assert len(kept) == len(names)
    (folder / "rig.toml").write_text("\n".join(kept))
    return folder


@pytest.fixture(scope="module")
def calibrated(tiny_set, tmp_path_factory):
    """camera.json and planes.json of the set with all its tables."""
    out = tmp_path_factory.mktemp("calibrated") / "out"
    for step in ("camera", "planes"):
        assert trisect(step, tiny_set, "--out", out).code == 0
    return out


@pytest.mark.parametrize(
    ("step", "tables", "needed"),
    [
        ("camera", ["camera_target"], []),
        ("planes", ["plane_target", "laser_fan"], ["camera.json"]),
        ("scan", ["laser_fan"], ["camera.json", "planes.json"]),
    ],
)
def test_a_step_runs_with_its_own_tables_only(tiny_set, calibrated, tmp_path, step, tables, needed):
    found = with_tables(tiny_set, tmp_path / "set", *tables)
    (out := tmp_path / "out").mkdir()
    for name in needed:
        shutil.copy(calibrated / name, out / name)
    said = trisect(step, found, "--out", out, *(("--sigma-cut", "0.3") if step == "scan" else ()))
    assert said.code == 0, said.err
    if step != "scan":
        assert (out / f"{step}.json").read_bytes() == (calibrated / f"{step}.json").read_bytes()


NO_FAN = "it has no table [laser_fan], which states that the rig has no fan"


@pytest.mark.parametrize(
    ("step", "tables", "missing"),
    [
        ("camera", ["plane_target", "laser_fan"], "camera_target is missing"),
        ("planes", ["camera_target", "laser_fan"], "plane_target is missing"),
        ("planes", ["camera_target", "plane_target"], NO_FAN),
        ("check", ["camera_target", "plane_target"], NO_FAN),
        ("profile", ["camera_target", "plane_target"], NO_FAN),
        ("run", ["camera_target", "plane_target"], "the rig has no fan, as it has no table [laser_fan]"),
        ("run", ["camera_target", "laser_fan"], "plane_target is missing"),
    ],
)
def test_a_table_that_a_step_wants_is_missed_by_name(tiny_set, calibrated, tmp_path, step, tables, missing):
    found = with_tables(tiny_set, tmp_path / "set", *tables)
    (out := tmp_path / "out").mkdir()
    shutil.copy(calibrated / "camera.json", out / "camera.json")
    said = trisect(step, found, "--out", out)
    assert said.code == 2
    assert missing in said.sentence


def test_a_report_names_no_target_that_rig_toml_does_not(simulated, measured, tmp_path):
    """What is not stated is not what the paper's rig would have been."""
    found, out = with_tables(simulated, tmp_path / "set", "camera_target"), copy_of(measured, tmp_path / "out")
    pictures = [word for name in ("surface", "frame", "points", "maps") for word in ("--without", name)]
    assert trisect("report", found, "--out", out, *pictures).code == 0
    text = "".join(page.extract_text() for page in PdfReader(str(out / "report.pdf")).pages)
    assert "Camera target" in text
    assert text.count("Plane target") == 1, "no certificate of it is stated: told once, where results are traced"
    assert "lines, 5° apart" not in text
