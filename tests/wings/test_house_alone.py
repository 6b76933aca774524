"""With each wing taken away the house works: commands, a measurement, the window."""

import ast
import re

import pytest
from typer.main import get_command

from core.cli.app import app, whole_command
from core.door import WITHOUT
from core.pipeline.steps.report_step import results_content
from core.wing import wings
from tests.code import ROOT, modules, nodes
from tests.simulated import CUT, copy_of, trisect
from tests.wings.strangers import look_again

OURS = tuple(sorted(path.parent.name for path in ROOT.glob("core/wings/*/wing.py")))
NEEDS_A_WING = re.compile(r"\b(core|tests|workbench)\.wings\b")
TABLES = {"tests/accuracy/bounds.py", "tests/workbench/screenshots.py"}
"""What makes all tables of accuracy and all pictures of the manual, of house and wings: no test."""
SAME = ("camera.json", "planes.json", "cloud.ply", "mesh.ply", "scan.npz", "gauge.json")
"""Results that say nothing of when they were made."""


@pytest.fixture
def without(monkeypatch):
    """Takes wings away, by their names."""

    def taken_away(*names):
        monkeypatch.setenv(WITHOUT, ",".join(names))
        look_again()

    yield taken_away
    monkeypatch.undo()
    look_again()


def test_every_folder_of_a_wing_is_found_and_has_a_readme_of_few_lines():
    assert tuple(sorted(wing.name for wing in wings())) == OURS
    for name in OURS:
        assert len((ROOT / "core" / "wings" / name / "README.md").read_text(encoding="utf-8").splitlines()) <= 12


@pytest.mark.parametrize("name", OURS)
def test_without_a_wing_its_commands_are_gone_and_all_others_stand(without, name):
    before = set(whole_command()[0].commands)
    without(name)
    command, unusable = whole_command()
    assert not unusable
    assert set(get_command(app).commands) <= set(command.commands) < before


def test_no_test_of_the_house_needs_a_wing():
    found = {
        path.relative_to(ROOT).as_posix()
        for path in modules("tests")
        if not path.is_relative_to(ROOT / "tests" / "wings") and not path.is_relative_to(ROOT / "tests/workbench/wings")
        for node in nodes(path)
        if isinstance(node, ast.Import | ast.ImportFrom) and NEEDS_A_WING.search(ast.unparse(node))
    }
    assert found == TABLES


def test_a_comparison_stays_and_the_report_tells_that_it_is_not_printed(without, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    for name in ("comparison.json", "comparison.ply"):
        (out / name).write_bytes(b"kept")
    without("geometry")
    content = results_content(out)
    note = "The comparison with another surface is not printed, as the wing geometry is not there."
    assert [str(one) for one in content.notes if one.code == "plugin.comparison_not_printed"] == [note]
    assert "comparison" not in content.facts and (out / "comparison.json").read_bytes() == b"kept"
    said = trisect("export", out, "--format", "compared", "--to", tmp_path / "to")
    what = 'the format "compared" is of the wing geometry, which is not there; take it out of TRISECT_WITHOUT_WINGS.'
    assert said.code == 2 and what in said.err


def test_features_of_a_wing_stay_in_the_plan_and_are_told_as_not_measured(without, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    features = ('name = "a"\nkind = "plane"', 'name = "b"\nkind = "plane"')
    asked = 'name = "c"\nkind = "parallelism"\nof = ["a", "b"]\nlimits.parallelism.upper_mm = 0.1'
    (out / "plan.toml").write_text("".join(f"[[feature]]\n{one}\n" for one in (*features, asked)))
    without("geometry")
    said = trisect("inspect", out, "--plan", out / "plan.toml")
    what = "parallelism is of the wing geometry, which is not there; take it out of TRISECT_WITHOUT_WINGS."
    assert said.code == 1 and f"feature c: {what}" in said.out
    content = results_content(out)
    assert [row.name for row in content.inspected] == ["a flatness", "b flatness"] and content.unmeasured


def test_without_any_wing_a_set_is_measured_to_the_same_bytes(without, simulated, measured, tmp_path):
    without(*OURS)
    assert set(whole_command()[0].commands) == set(get_command(app).commands)
    said = trisect("run", simulated, "--out", tmp_path / "out", *CUT)
    assert said.code in (0, 1), said.err
    assert (tmp_path / "out" / "report.pdf").exists()
    for name in SAME:
        assert (tmp_path / "out" / name).read_bytes() == (measured / name).read_bytes(), name
