"""Studies kept in a project: of tables and repeats, the same as on the command line, and in the report."""

import json
import shutil
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from core.errors import InputError
from core.files.project.data import ProjectFile, Repeat
from core.files.project.folder import create_project, study_path
from core.findings.proof import Doubt
from core.pipeline.project.report import project_content
from core.translations import language
from core.wings.studies import study_step, studying
from core.wings.studies.files.input import read_repeats
from core.wings.studies.files.results import Measured
from core.wings.studies.files.study_file import study_values, write_study
from core.wings.studies.kinds.study import KINDS
from core.wings.studies.study_step import (
    HEADS,
    export_study,
    keep_study,
    keep_type1,
    look_at_study,
    project_rows,
    read_study_table,
)
from tests.pipeline.conftest import done
from tests.wings.studies.grr_tables import AIAG

__all__ = ["done"]


def crossed(values):
    """Rows of part, operator, value."""
    cells = np.ndenumerate(np.asarray(values, dtype=float))
    rows = [f"{part};{operator};{float(value)!r}" for (part, operator, _), value in cells]
    return "\n".join([HEADS["grr"], *rows]) + "\n"


READINGS = HEADS["acceptance"] + "\nsize;left;25.012;25.0;0.001\nsize;right;25.03;25.0;0.001\nform;left;0.05;;\n"


def test_a_kept_study_has_the_numbers_of_the_command_line_and_its_table_beside_it(tmp_path):
    kept = keep_study(tmp_path, "grr", crossed(AIAG), tmp_path, {"tolerance": 8.0})
    path = study_path(tmp_path, kept.id)
    table = path.with_name("table.csv")
    write_study(tmp_path / "theirs", studying.grr(table, "thickness", 4.0))
    assert json.loads(path.read_text()) == json.loads((tmp_path / "theirs" / "study.json").read_text())
    assert (kept.kind, str(kept.title), kept.included) == ("grr", "10 parts × 3 operators × 3 repeats", True)
    assert study_values(look_at_study(tmp_path, kept.id))["ndc"]["categories"] == 4
    assert keep_study(tmp_path, "grr", crossed(AIAG), tmp_path, {"tolerance": 8.0}) == kept
    assert keep_study(tmp_path, "grr", crossed(AIAG), tmp_path, {"tolerance": 9.0}).id != kept.id


def test_a_studys_title_is_told_in_the_readers_language_and_names_as_they_were_typed(tmp_path):
    told = language("de")
    kept = keep_study(tmp_path, "grr", crossed(AIAG), tmp_path, {"tolerance": 8.0})
    assert told(kept.title) == "10 Teile × 3 Bediener × 3 Wiederholungen"
    table = HEADS["series"] + "\n" + "\n".join(f"{part};{10 + part / 100};" for part in range(3))
    assert told(keep_study(tmp_path, "series", table, tmp_path, {"size": 1}).title) == "3 × Dicke"
    assert told(keep_study(tmp_path, "series", table, tmp_path, {"size": 1}, "top height").title) == "3 × top height"


def test_an_acceptance_check_and_a_type1_study_are_kept_and_handed_over(tmp_path):
    check = keep_study(tmp_path, "acceptance", READINGS, tmp_path, {"size": 0.02})
    assert look_at_study(tmp_path, check.id).verdict == "not conforming"
    repeats = [(f"scan {n}", value, ()) for n, value in enumerate([50.0, 50.01, 49.99, 50.0])]
    type1 = keep_type1(tmp_path, repeats, 50.0, 0.4)
    study = look_at_study(tmp_path, type1.id)
    assert (study.n, study.tolerance, type1.kind) == (4, 0.4, "type1")
    assert export_study(tmp_path, check.id, tmp_path / "readings.csv").read_text() == READINGS
    assert json.loads(export_study(tmp_path, type1.id, tmp_path / "t.json").read_text())["n"] == 4
    assert read_study_table(tmp_path / "readings.csv") == READINGS


@pytest.mark.parametrize(
    ("kind", "text", "limits", "says"),
    [
        ("grr", "part;operator;value\n1;A;x\n1;A;2\n", {}, "table: line 2, column value"),
        ("grr", "part;value\n1;2\n", {}, "the column operator is missing"),
        ("grr", "part;operator;value\n1;A;2\n1;A;2\n2;A;2\n2;A;2\n", {}, "values that differ"),
        ("grr", "", {}, "no rows"),
        ("grr", "result;part;operator\ngone;1;A\n", {}, "no such folder"),
        ("acceptance", READINGS.replace("form", "colour"), {}, 'column quantity is "colour"'),
    ],
)
def test_a_table_that_is_no_study_says_why_and_keeps_nothing(tmp_path, kind, text, limits, says):
    with pytest.raises(InputError) as told:
        keep_study(tmp_path, kind, text, tmp_path, limits)
    assert says in str(told.value)
    assert not (tmp_path / "studies").exists()


def test_rows_come_from_other_projects(done, tmp_path):
    folder = tmp_path / "copy"
    shutil.copytree(done.folder, folder)
    info = replace(done.project.info, part="Block", serial="no; 7", operator="Ada", name="left below")
    create_project(folder, ProjectFile(replace(done.project, info=info)))
    thickness = done.summary.gauge.thickness_mm
    assert project_rows("grr", folder, "plane", 0, 0, 0) == f"part;operator;value\nno 7;Ada;{thickness!r}\n"
    repeats = tuple(Repeat("scan", 50 + 0.25 * n, 0.02, 2.0, "c", datetime(2026, 1, 2, tzinfo=UTC)) for n in range(2))
    create_project(folder, ProjectFile(replace(done.project, info=info, repeats=repeats)))
    head, first, second = project_rows("grr", folder, "plane", 0, 0, 0).splitlines()
    assert (first, second) == ("no 7;Ada;50.0", "no 7;Ada;50.25")
    repeats = (replace(repeats[0], doubts=("moved", "rig_changed")), repeats[1])
    create_project(folder, ProjectFile(replace(done.project, info=info, repeats=repeats)))
    assert project_rows("grr", folder, "plane", 0, 0, 0).splitlines() == [
        f"{head};doubts", f"{first};moved rig_changed", f"{second};",
    ]  # fmt: skip
    part, value, u = project_rows("series", folder, "plane", 0, 0, 0).splitlines()[1].split(";")
    assert (part, float(value)) == ("no 7", thickness) and 0 < float(u) < 0.1
    quantity, position, flatness, _, u = (
        project_rows("acceptance", folder, "plane", 0.0, 0.0002, 0).splitlines()[1].split(";")[:5]
    )
    assert (quantity, position, u) == ("flatness", "left below", "0.0002") and 0 < float(flatness) < 2
    with pytest.raises(InputError, match="no project"):
        project_rows("grr", tmp_path, "plane", 0, 0, 0)
    create_project(folder, ProjectFile(replace(done.project, info=replace(info, operator=""))))
    with pytest.raises(InputError, match="no operator"):
        project_rows("grr", folder, "plane", 0, 0, 0)


def test_the_report_has_the_studies_that_are_included(done, tmp_path):
    folder = tmp_path / "copy"
    shutil.copytree(done.folder, folder)
    kept = keep_study(folder, "grr", crossed(AIAG), folder, {})
    check = keep_study(folder, "acceptance", READINGS, folder, {})
    project = replace(done.project, studies=(kept, replace(check, included=False)))
    assert [study.kind for study in project_content(folder, project).studies] == [KINDS["grr"]]
    shutil.rmtree(folder / "studies")
    with pytest.raises(InputError, match="study"):
        project_content(folder, project)


def test_a_series_is_of_any_length_and_of_no_angle(done, tmp_path, monkeypatch):
    found = {
        "top flatness": Measured(0.031, 0.004, 2.0, (), "mm", doubts=()),
        "top to side": Measured(89.95, 0.02, 2.0, (), "deg", doubts=()),
    }
    monkeypatch.setattr(study_step, "measured_in", lambda _, name: found[name])
    folder = tmp_path / "project"
    folder.mkdir()
    create_project(folder, ProjectFile(done.project))
    rows = project_rows("series", folder, "plane", 0, 0, 0, "top flatness")
    assert rows.splitlines()[1].split(";")[1:] == ["0.031", "0.004"]
    found["top flatness"] = replace(found["top flatness"], doubts=(Doubt.named("moved"),))
    assert project_rows("series", folder, "plane", 0, 0, 0, "top flatness").endswith(";0.031;0.004;moved\n")
    with pytest.raises(InputError, match="top to side is no length"):
        project_rows("series", folder, "plane", 0, 0, 0, "top to side")
    table = "part;value_mm;u_mm\n" + "".join(f"{n};{0.03 + n / 1000};0.004\n" for n in range(5))
    kept = keep_study(tmp_path, "series", table, tmp_path, {"size": 1}, "top flatness")
    assert '"top flatness"' in study_path(tmp_path, kept.id).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("kind", "table", "limits"),
    [
        ("grr", crossed(AIAG), {"tolerance": 50.0}),
        ("series", "part;value_mm\n" + "".join(f"{n};{10 + n % 3 / 100}\n" for n in range(30)), {"upper": 20.0}),
        ("acceptance", READINGS, {"size": 1.0}),
    ],
)
def test_what_was_doubted_of_a_row_is_in_doubt_in_its_study(tmp_path, kind, table, limits):
    head, *rows = table.splitlines()
    study = look_at_study(tmp_path, keep_study(tmp_path, kind, table, tmp_path, limits).id)
    assert study.verdict in ("acceptable", "capable", "conforming")
    none = "\n".join([f"{head};doubts", *(f"{row};" for row in rows)])
    assert (
        keep_study(tmp_path, kind, none, tmp_path, limits).id == keep_study(tmp_path, kind, table, tmp_path, limits).id
    )
    rows[0] += ";moved"
    doubted = "\n".join([f"{head};doubts", rows[0], *(f"{row};" for row in rows[1:])])
    kept = keep_study(tmp_path, kind, doubted, tmp_path, limits)
    study = look_at_study(tmp_path, kept.id)
    assert study.verdict == "not proven"
    assert any("something moved during the scan" in str(note) for note in study.notes)
    assert read_study_table(study_path(tmp_path, kept.id).with_name("table.csv")) == doubted + "\n"


def test_the_doubts_of_repeats_are_in_the_table_of_their_type1_study(tmp_path):
    repeats = [("scan 1", 50.0, (Doubt.named("moved"),)), ("scan 2", 50.01, ()), ("scan 3", 49.99, ())]
    kept = keep_type1(tmp_path, repeats, 50.0, 4.0)
    assert look_at_study(tmp_path, kept.id).verdict == "not proven"
    table = study_path(tmp_path, kept.id).with_name("table.csv")
    assert table.read_text() == "scan;value_mm;doubts\nscan 1;50.0;moved\nscan 2;50.01;\nscan 3;49.99;\n"
    assert [one.label for one in read_repeats([table]).doubted] == ["scan 1"]


def test_the_table_of_a_study_that_is_handed_over_holds_no_formula(tmp_path):
    cells = [
        f"=cmd|'/c calc'!A{part};o{o};{part + o / 10 + r / 100 - 1}"
        for part in range(3)
        for o in (1, 2)
        for r in (1, 2)
    ]
    text = "\n".join(["part;operator;value", "# a;=cmd()", *cells]) + "\n"
    kept = keep_study(tmp_path, "grr", text, tmp_path, {"tolerance": 8.0})
    lines = export_study(tmp_path, kept.id, tmp_path / "t.csv").read_text().splitlines()
    assert not any(cell.startswith(("=", "@")) for line in lines for cell in line.split(";"))
    assert lines[2].startswith("'=cmd|'/c calc'!A0;o1;-0.8")
