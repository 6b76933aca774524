"""`trisect study` as a technician calls it: tables and folders in, rows, study.json and an exit code out."""

import json
import math

import numpy as np
import pytest

from core.files.results.gauge_file import write_gauge
from core.files.results.ply import write_cloud
from core.findings.proof import Doubt
from core.inspect.causes import Cause
from core.inspect.results import Contribution, Face, GaugeResult
from core.model import LightPlane
from core.wings.studies.files.study_file import read_study
from core.wings.studies.kinds.grr import GrrStudy
from core.wings.studies.kinds.type1 import Type1Study
from tests.checks.test_repeats import TABLE_1
from tests.inspect.fit.test_round import RADIUS, scan
from tests.scan_facts import NOTHING_WRONG
from tests.simulated import trisect
from tests.wings.studies.grr_tables import AIAG
from tests.wings.studies.test_acceptance_step import with_facts

NO_POINTS = np.arange(0)


def table(folder, text, name="table.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def of_values(folder, values, head="value"):
    return table(folder, "\n".join([head, *map(str, values)]))


def results(folder, thickness, u=0.01, budget=None, doubts=()):
    """A folder as `trisect run` leaves it, as far as a study reads it."""
    folder.mkdir()
    face = Face(LightPlane.from_normal([0, 0, 1.0], 600.0), NO_POINTS, np.empty(0), 0.01, 0.01)
    rows = (Contribution(Cause.CAMERA, u),) if budget is None else budget
    gauge = GaugeResult(thickness, u, 2.0, face, face, 0.0, rows, 50.0, 0.2, doubts=doubts)
    write_gauge(folder / "gauge.json", gauge, "abc")
    return folder


@pytest.mark.parametrize(
    ("nominal", "mean", "rmse", "std"),
    [
        (70, 70.0178, 0.0886, 0.0915),
        (60, 59.9939, 0.0957, 0.1007),
        (50, 50.0275, 0.1039, 0.1056),
        (40, 40.0294, 0.1083, 0.1099),
    ],
)
def test_the_papers_first_table_gives_its_second(tmp_path, nominal, mean, rmse, std):
    path = of_values(tmp_path, TABLE_1[nominal], "thickness_mm")
    said = trisect("study", "repeats", path, "--nominal", nominal, "--json")
    found = json.loads(said.out)
    assert said.code == 0  # no tolerance, no verdict
    assert (found["n"], found["verdict"]) == (10, "")
    assert [found[name] for name in ("mean", "rmse", "std")] == pytest.approx([mean, rmse, std], abs=1e-4)
    assert sum(found["histogram"]["counts"]) == 10


def test_semicolons_with_decimal_commas_give_the_same_numbers(tmp_path):
    ours = of_values(tmp_path, TABLE_1[50])
    text = "scan;value;u_mm\n" + "\n".join(f"{n};{str(v).replace('.', ',')};0,01" for n, v in enumerate(TABLE_1[50]))
    office = table(tmp_path, "\ufeff" + text, "office.csv")
    one, other = (json.loads(trisect("study", "repeats", path, "--json").out) for path in (ours, office))
    assert (one["mean"], one["std"]) == (other["mean"], other["std"])
    assert other["scans"][3]["scan"] == "3"


@pytest.mark.parametrize(
    ("u", "verdict", "code"), [(0.01, "conforming", 0), (0.1, "not proven", 1), (None, "not proven", 1)]
)
def test_the_exit_code_of_repeats_is_that_of_their_verdict(tmp_path, u, verdict, code):
    path = of_values(tmp_path, [50.01, 50.03, 50.02])
    words = () if u is None else ("--u", u)
    said = trisect("study", "repeats", path, "--nominal", 50, "--tolerance", 0.1, "--json", *words)
    assert (json.loads(said.out)["verdict"], said.code) == (verdict, code)


def test_a_repeat_of_a_rig_that_surely_changed_takes_its_proof_from_the_mean(tmp_path):
    sure, doubted = results(tmp_path / "a", 50.001), results(tmp_path / "b", 50.002, doubts=(Doubt.named("moved"),))
    said = json.loads(trisect("study", "repeats", sure, doubted, "--json").out)
    assert (said["verdict"], said["doubted"]) == ("not proven", ["b"])
    assert any("b (something moved during the scan) prove" in note["text"] for note in said["notes"])


def test_a_type_1_study_and_a_gauge_rr_of_a_result_that_proves_nothing_prove_nothing(tmp_path):
    moved = (Doubt.named("moved"),)
    parts = [("a", 50.0), ("a", 50.001), ("b", 50.05), ("b", 50.052)]
    folders = [results(tmp_path / f"{n}", value, doubts=moved if n == 2 else ()) for n, (_, value) in enumerate(parts)]
    table = tmp_path / "table.csv"
    rows = [f"{part},me,{n}" for n, (part, _) in enumerate(parts)]
    table.write_text("\n".join(["part,operator,result", *rows]))
    for asked in (("type1", *folders), ("grr", table, "--tolerance", 5)):
        said = trisect("study", *asked, "--out", tmp_path / "out", "--json")
        found = json.loads(said.out)
        assert (said.code, found["verdict"], found["doubts"]) == (1, "not proven", {"2": ["moved"]})
        assert any("2 (something moved during the scan) prove" in note["text"] for note in found["notes"])
        again = read_study(tmp_path / "out" / "study.json")
        assert isinstance(again, Type1Study | GrrStudy)
        assert (again.verdict, [one.label for one in again.doubted]) == ("not proven", ["2"])


def test_folders_of_results_bring_their_values_their_limits_and_their_budgets(tmp_path):
    budget = (
        Contribution(Cause.CAMERA, 0.006),
        Contribution(Cause.SWEEP_PLANES, 0.008),
    )
    folders = [results(tmp_path / f"scan{n}", value, 0.01, budget) for n, value in enumerate((50.01, 50.02, 50.03))]
    said = trisect("study", "repeats", *folders, "--json")
    found = json.loads(said.out)
    assert (said.code, found["verdict"], found["nominal"]) == (0, "conforming", 50)
    assert [scan["scan"] for scan in found["scans"]] == ["scan0", "scan1", "scan2"]
    rows = {row["source"]["text"]: row["contribution"] for row in found["budget_of_mean"]["rows"]}
    assert rows["camera calibration"] == pytest.approx(0.006)
    assert rows["repeatability of the scans, above their stated noise"] == pytest.approx(0.01 / math.sqrt(3))
    assert rows.keys() == {"camera calibration", "repeatability of the scans, above their stated noise"}
    assert found["decision"]["guard_band"] == pytest.approx(found["budget_of_mean"]["U"])


def test_one_measurement_given_twice_is_no_repeat(tmp_path):
    first, second = (results(tmp_path / name, 50.01234) for name in ("first", "second"))
    assert "second: it holds the same measurement as first" in trisect("study", "repeats", first, second).sentence
    assert "scan the part anew" in trisect("study", "repeats", first, first).sentence


def test_folders_of_one_name_are_told_apart_by_those_above_them(tmp_path):
    for name in ("monday", "tuesday"):
        (tmp_path / name).mkdir()
    folders = [results(tmp_path / name / "results", 50.0 + len(name) / 100) for name in ("monday", "tuesday")]
    found = json.loads(trisect("study", "repeats", *folders, "--json").out)
    assert [scan["scan"] for scan in found["scans"]] == ["monday/results", "tuesday/results"]


def test_a_type_1_study_of_a_table_says_capable_or_not(tmp_path):
    path = of_values(tmp_path, 50 + 0.01 * np.sin(np.arange(50)))
    good = trisect("study", "type1", path, "--nominal", 50, "--tolerance", 0.5, "--resolution", 0.001, "--json")
    bad = trisect("study", "type1", path, "--nominal", 50.04, "--tolerance", 0.2)
    found = json.loads(good.out)
    assert (good.code, found["verdict"], found["tolerance_width"], found["resolution_suffices"]) == (
        0,
        "capable",
        1,
        True,
    )
    assert bad.code == 1
    assert "not capable" in bad.out
    assert "Cgk" in bad.out


def grr_text(values):
    rows = [
        f"{part + 1},{'ABC'[operator]},{values[part, operator, repeat]}"
        for part, operator, repeat in np.ndindex(values.shape)
    ]
    return "part,operator,value\n" + "\n".join(rows)


def test_a_gauge_rr_study_writes_study_json_with_the_published_numbers(tmp_path):
    out = tmp_path / "out"
    said = trisect("study", "grr", table(tmp_path, grr_text(AIAG)), "--tolerance", 4, "--out", out)
    found = json.loads((out / "study.json").read_text())
    assert said.code == 1  # 22.7 % of T: with reservations
    assert "acceptable with reservations" in said.out
    assert found["grr_of_total"]["value"] == pytest.approx(0.2786, abs=5e-5)
    assert found["grr_of_tolerance"]["value"] == pytest.approx(0.2268, abs=5e-5)
    assert found["ndc"]["categories"] == 4
    assert (found["parts"][-1], found["operators"]) == ("10", ["A", "B", "C"])


def test_the_order_of_rows_does_not_matter_to_a_gauge_rr_study(tmp_path):
    head, *rows = grr_text(AIAG).splitlines()
    mixed = "\n".join([head, *(rows[place] for place in np.random.default_rng(0).permutation(len(rows)))])
    one, other = (
        json.loads(trisect("study", "grr", table(tmp_path, text, name), "--json").out)["grr_of_total"]["value"]
        for text, name in ((grr_text(AIAG), "a.csv"), (mixed, "b.csv"))
    )
    assert one == pytest.approx(other, rel=1e-12)


def test_a_gauge_rr_table_may_name_folders_of_results(tmp_path):
    lines, rng = ["part,operator,result"], np.random.default_rng(1)
    for part, operator, repeat in np.ndindex(2, 2, 2):
        name = f"r{part}{operator}{repeat}"
        results(tmp_path / name, 50.0 + part + 0.01 * rng.normal())
        lines.append(f"{part},{operator},{name}")
    found = json.loads(trisect("study", "grr", table(tmp_path, "\n".join(lines)), "--json").out)
    assert np.array(found["values"]).shape == (2, 2, 2)
    assert found["values"][1][0][0] == pytest.approx(51.0, abs=0.05)


ACCEPTANCE = """quantity,position,measured_mm,calibrated_mm,u_mm
size,left,30.011,30.002,0.001
size,right,29.990,30.002,0.001
form,left,0.031,,
flatness,middle,0.022,,
"""


@pytest.mark.parametrize(("limit", "code"), [(0.02, 0), (0.012, 1), (0.005, 1)])
def test_an_acceptance_table_is_judged_by_its_worst_position(tmp_path, limit, code):
    said = trisect("study", "acceptance", table(tmp_path, ACCEPTANCE), "--size", limit, "--json")
    found = json.loads(said.out)
    assert said.code == code
    assert [one["quantity"] for one in found["quantities"]] == ["form", "size", "flatness"]
    assert found["quantities"][1]["largest_error"] == pytest.approx(-0.012)
    assert "not a certificate" in found["notes"][0]["text"]


def test_clouds_of_a_sphere_give_its_probing_errors_position_by_position(tmp_path):
    folders = []
    for seed in range(2):
        cloud, _ = scan(np.random.default_rng(seed), noise=0.01)
        folders.append(tmp_path / f"position{seed}")
        folders[-1].mkdir()
        write_cloud(folders[-1] / "cloud.ply", cloud, "abc")
        with_facts(folders[-1], NOTHING_WRONG)
    said = trisect("study", "acceptance", *folders, "--nominal", 2 * RADIUS, "--u", 0.001, "--size", 0.05, "--json")
    form, size = json.loads(said.out)["quantities"]
    assert said.code == 0, said.err
    assert [reading["position"] for reading in size["readings"]] == ["position0", "position1"]
    assert abs(size["largest_error"]) < 0.02
    assert 0.05 < form["largest_error"] < 0.12  # the range of some thousand points with σ of 0.01 mm
    plane = json.loads(trisect("study", "acceptance", *folders, "--artefact", "plane", "--json").out)["quantities"]
    assert [one["quantity"] for one in plane] == ["flatness"]
    assert 0.05 < plane[0]["largest_error"] < 0.12


GRR, CHECK = "part,operator,value\n1,A,5\n", "quantity,position,measured_mm\n"


@pytest.mark.parametrize(
    ("words", "text", "said"),
    [
        (("repeats",), "value\n50.1\nabc\n", 'line 3, column value is "abc", not a finite number'),
        (("repeats",), "value\n50.1\n\n# said\nnan\n", 'line 5, column value is "nan", not a finite number'),
        (("repeats",), "scan,value\n1\n", "line 2 has 1 cells, but the head has 2"),
        (("repeats",), 'value\n"50\n51"\n', "does not end in the line it begins in; close its quotes"),
        (("repeats",), "valu\n50\n", "the column value is missing (did you mean valu?)"),
        (("repeats",), "value,value_mm\n1,1\n", "the columns value and value_mm say the same; keep one of them"),
        (("repeats",), "value,value\n1,1\n", 'the column "value" is there twice'),
        (("repeats",), "value,u_mm\n50,0.1\n51,\n", "line 3, column u_mm is empty, not a number"),
        (("repeats",), "value,U_mm,k\n50,0.1,0\n", "line 2, column k is 0, not a number above 0"),
        (("repeats",), "value,u_mm\n50,-0.1\n", "line 2, column u_mm is −0.1, not a length of 0 or more"),
        (("repeats",), "value\n", "the table has no rows below its head"),
        (("repeats",), "value\n50\n", "one value alone, with no stated uncertainty, is no study"),
        (("repeats", "--tolerance", 1), "value\n50\n51\n", "a tolerance needs a nominal value; give --nominal as well"),
        (("repeats", "--tolerance", 0), "value\n50\n51\n", "0 is no tolerance; give a value above 0"),
        (("type1",), "value\n50\n51\n", "the tolerance it is measured against; give both"),
        (("grr",), GRR + "1,A,6\n2,A,5\n", "part 2 was measured 1 times by operator A, others 2 times"),
        (("grr",), GRR + ",A,6\n", "line 3, column part is empty; fill it in"),
        (("grr",), GRR + "1,A,6\n", "1 parts and 2 repeats are too few"),
        (("acceptance",), CHECK + "shape,a,1\n", 'line 2, column quantity is "shape", not form, size'),
        (("acceptance",), CHECK + "size,a,1\n", "line 2, column calibrated_mm must be above 0 for size"),
        (("acceptance", "--size", -1), ACCEPTANCE, "−1 mm is no limit; give a length above 0"),
    ],
)
def test_bad_input_is_told_in_one_sentence_with_file_row_and_column(tmp_path, words, text, said):
    path = table(tmp_path, text)
    found = trisect("study", words[0], path, *words[1:])
    assert found.code == 2
    assert said in found.sentence
    assert not found.out


def test_folders_that_are_none_and_names_that_are_not_there_are_told(tmp_path):
    folder = results(tmp_path / "scan", 50.0)
    (tmp_path / "empty").mkdir()
    assert "measure first" in trisect("study", "repeats", tmp_path / "empty").sentence
    missing = trisect("study", "repeats", folder, folder, "--characteristic", "height").sentence
    assert 'no result is called "height"; there are thickness' in missing
    assert "the file is missing" in trisect("study", "repeats", tmp_path / "nowhere.csv").sentence
    assert "give it alone" in trisect("study", "repeats", of_values(tmp_path, [1]), folder).sentence
    assert "no cloud.ply" in trisect("study", "acceptance", folder, folder, "--nominal", 30).sentence
    assert "no calibrated value" in trisect("study", "acceptance", folder, folder).sentence
    bar = trisect("study", "acceptance", folder, "--artefact", "bar", "--nominal", 80)
    assert "the spheres of the bar have no diameter; give it in mm" in bar.sentence


def test_a_series_has_charts_indices_and_the_point_that_breaks_a_rule(tmp_path):
    values = 50 + 0.01 * np.random.default_rng(4).standard_normal(60)
    values[30] += 0.08
    rows = [f"part {n};{value};0.002" for n, value in enumerate(values, start=1)]
    path = table(tmp_path, "\n".join(["part;value;u_mm", *rows]))
    said = trisect("study", "series", path, "--nominal", 50, "--tolerance", 0.1, "--out", tmp_path / "study")
    assert said.code == 1 and "Cpk" in said.out and "(95 %)" in said.out
    assert "Rule 1" in said.out and "part 31" in said.out
    found = json.loads((tmp_path / "study" / "study.json").read_text())
    assert found["verdict"] == "not proven" and {"rule": 1, "place": 30} in found["chart"]["breaks"]
    assert found["share_of_u"][1] == pytest.approx((0.002 / found["s"]) ** 2)


def test_a_series_of_results_and_projects_takes_their_limits_and_budgets(tmp_path):
    rows = (Contribution(Cause.CAMERA, 0.008), Contribution(Cause.SWEEP_PLANES, 0.006))
    values = 50 + 0.02 * np.random.default_rng(4).standard_normal(21)
    folders = []
    for n, value in enumerate(values):
        folder = tmp_path / f"part{n}"
        if n:
            folders.append(results(folder, float(value), 0.01, rows))
        else:
            folder.mkdir()
            (folder / "project.json").write_text("{}")
            results(folder / "results", float(value), 0.01, rows)
            folders.append(folder)
    found = json.loads(trisect("study", "series", *folders, "--json").out)
    assert (found["lower_limit"], found["upper_limit"], found["n"]) == (49.8, 50.2, 21)
    assert (
        found["u"] == pytest.approx({"own": 0.006, "whole": 0.01})
        and found["indices"]["Cpk"]["interval"][0] < found["indices"]["Cpk"]["value"]
    )
    assert trisect("study", "series", *folders, "--subgroup", 30).code == 2


def test_a_short_series_says_so_instead_of_drawing_limits(tmp_path):
    said = trisect("study", "series", of_values(tmp_path, [50.01, 50.03, 50.02]), "--nominal", 50, "--tolerance", 0.1)
    assert said.code == 1 and "none are drawn" in said.out and "Cpk" not in said.out.replace("Cp or Cpk", "")
