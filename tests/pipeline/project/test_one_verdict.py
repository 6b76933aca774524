"""One list of results and one verdict on a part, whoever shows it: report, tables, files for others, exit codes."""

import json
import re
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import pypdfium2
import pytest
from openpyxl import load_workbook

from core.files.csv_text import csv_text
from core.files.exchange.dcc import dcc_document
from core.files.exchange.dfq import dfq_lines
from core.files.exchange.qif import qif_document
from core.files.exchange.records import RESULT_COLUMNS, as_table, result_row
from core.files.exchange.result_json import result_tables
from core.files.exchange.xlsx import write_xlsx
from core.files.plan.plan_file import write_plan
from core.files.project.data import Project
from core.files.project.folder import results_folder
from core.files.results.folder_results import read_results
from core.files.results.gauge_file import read_gauge, write_gauge
from core.inspect.conformity import Limits
from core.inspect.plan.feature_spec import Auto, FeatureSpec, Polygon
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.result_list import ResultList
from core.pipeline.project.inspection import measure_features
from core.pipeline.project.opened import open_project
from core.pipeline.project.report import project_content
from core.pipeline.project.verdict import listed_results
from core.pipeline.steps.report_step import results_content
from core.report.content import ReportContent
from core.report.pdf import build_report
from core.report.template import SECTIONS, ReportTemplate
from core.report.wording import SIGNS
from tests.simulated import trisect

SECOND = FeatureSpec("step", "thickness", limits=(("thickness", Limits(50.0, -0.0015, 0.0015)),))
TOP = FeatureSpec("top", "plane", (Auto(2),))
MISSING = FeatureSpec(
    "ball", "sphere", (Polygon(((0, 0), (9, 0), (9, 9))),), limits=(("diameter", Limits(20.0, -0.1, 0.1)),)
)
ROWS = {
    "second": {"thickness": "conforming", "top flatness": "none", "step thickness": "not proven"},
    "unmeasured": {"thickness": "conforming", "top flatness": "none"},
}
PLANS = {"second": (TOP, SECOND), "unmeasured": (TOP, MISSING)}

Shown = tuple[dict[str, str], str]
"""Verdict of each row by its name, and that on the part; "" from whoever does not state one."""


@pytest.fixture(scope="module", params=list(PLANS))
def case(request, done, tmp_path_factory):
    """A gauge that conforms, beside a second thickness that is not proven, or a feature that could not be measured."""
    folder = tmp_path_factory.mktemp("one") / "block"
    shutil.copytree(done.folder, folder)
    project = replace(done.project, inspection=InspectionPlan(PLANS[request.param]))
    measure_features(folder, project)
    results = results_folder(folder)
    path = results / "gauge.json"
    gauge = read_gauge(path, results_content(results).cloud)
    proven = replace(gauge, nominal_mm=gauge.thickness_mm, tolerance_mm=5.0, notes=(), doubts=())
    write_gauge(path, proven, json.loads(path.read_text())["calibration_id"])
    contents = {"project": project_content(folder, project), "results": results_content(results)}
    return Case(request.param, results, project, contents)


@dataclass(frozen=True)
class Case:
    """Its name, its folder of results, and what is reported of the project and of that folder by itself."""

    name: str
    results: Path
    project: Project
    contents: Mapping[str, ReportContent]


def _rows(content: ReportContent) -> list[str]:
    return [one.name for one in content.characteristics]


def _of_list(found: ResultList) -> Shown:
    return {one.name: one.verdict or "none" for one in found.rows}, found.verdict


def _pdf(content: ReportContent) -> Shown:
    """By the signs on the first page: the part's first, then those of the table's rows."""
    short = replace(content, hidden=frozenset(SECTIONS))
    text = pypdfium2.PdfDocument(build_report(short))[0].get_textpage().get_text_range()
    verdicts = {
        f"{sign} {(verdict or 'no verdict').capitalize()}": verdict or "none" for verdict, sign in SIGNS.items()
    }
    found = [verdicts[one] for one in re.findall("|".join(map(re.escape, verdicts)), re.sub(r"\s+", " ", text))]
    return dict(zip(_rows(content), found[1:], strict=True)), found[0]


def _csv(content: ReportContent) -> Shown:
    lines = csv_text(as_table(RESULT_COLUMNS, [result_row(one) for one in content.characteristics])).splitlines()
    verdict = RESULT_COLUMNS.index("verdict")
    return {line.split(",")[0]: line.split(",")[verdict] for line in lines[1:]}, ""


def _xlsx(content: ReportContent, folder: Path) -> Shown:
    write_xlsx(folder / "result.xlsx", content)
    book = load_workbook(folder / "result.xlsx")
    head, *rows = book["result"].iter_rows(values_only=True)
    settings = dict(book["settings"].iter_rows(values_only=True, max_col=2))
    return {row[0]: row[head.index("verdict")] for row in rows}, settings["verdict"]


def _json(content: ReportContent) -> Shown:
    tables = result_tables(content)
    return {row["name"]: row["verdict"] for row in tables["characteristics"]}, tables["verdict"]


def _qif(content: ReportContent) -> Shown:
    document = qif_document(content)
    words = {"PASS": "conforming", "FAIL": "not conforming", "INDETERMINATE": "not proven", "NOT_ANALYZED": "none"}
    rows = [words[one.text or ""] for one in document.iter("CharacteristicStatusEnum")]
    (status,) = {one.text or "" for one in document.iter("InspectionStatusEnum")}
    return dict(zip(_rows(content), rows, strict=True)), (words | {"UNKNOWN": "not proven"})[status]


def _dfq(content: ReportContent) -> Shown:
    said = "\n".join(line for line in dfq_lines(content) if line.startswith("K2900"))
    return dict(zip(_rows(content), re.findall("verdict: ([a-z ]+)", said), strict=True)), ""


def _dcc(content: ReportContent) -> Shown:
    """DCC has words for two of the four: what it does not state is as the list has it."""
    named = replace(content, laboratory="Laboratory", template=ReportTemplate(country="DE"))
    rows = {}
    for one, result in zip(content.characteristics, dcc_document(named).iter("dcc:result"), strict=True):
        stated = [
            {"pass": "conforming", "fail": "not conforming"}[said.text or ""] for said in result.iter("dcc:conformity")
        ]
        rows[one.name] = stated[0] if stated else one.verdict or "none"
        assert bool(stated) == (one.verdict in ("conforming", "not conforming"))
    return rows, ""


def _opened(folder: Path) -> Shown:
    project = open_project(folder)
    return {one.name: one.verdict or "none" for one in project.characteristics}, project.verdict


CONTENT: dict[str, Callable[..., Shown]] = {
    "list": lambda content, _: _of_list(content.results),
    "pdf": lambda content, _: _pdf(content),
    "csv": lambda content, _: _csv(content),
    "xlsx": _xlsx,
    "json": lambda content, _: _json(content),
    "qif": lambda content, _: _qif(content),
    "dfq": lambda content, _: _dfq(content),
    "dcc": lambda content, _: _dcc(content),
}
"""Whoever shows what a report has."""
FOLDER: dict[str, Callable[[Path], Shown]] = {
    "files of a folder": lambda folder: _of_list(read_results(folder)),
    "operator": lambda folder: _of_list(listed_results(folder)),
    "Python": _opened,
}
"""Whoever reads a folder of results."""


@pytest.mark.parametrize("place", ["project", "results"])
@pytest.mark.parametrize("reader", CONTENT)
def test_report_and_files_for_others_show_the_same_verdicts(case, tmp_path, reader, place):
    rows, verdict = CONTENT[reader](case.contents[place], tmp_path)
    assert rows == ROWS[case.name] and next(iter(rows)) == "thickness"
    assert verdict in ("not proven", "")


@pytest.mark.parametrize("reader", FOLDER)
def test_whoever_reads_the_folder_shows_the_same_verdicts(case, reader):
    rows, verdict = FOLDER[reader](case.results)
    assert rows == ROWS[case.name] and verdict == "not proven"


def test_the_file_of_the_thickness_says_what_its_row_says(case):
    assert json.loads((case.results / "gauge.json").read_text())["verdict"] == "conforming"


def test_the_exit_code_is_that_of_the_part(case, tmp_path):
    """Of a plan that conforms by itself, beside a thickness that does not."""
    results = shutil.copytree(case.results, tmp_path / "results")
    path = results / "gauge.json"
    gauge = read_gauge(path, results_content(results).cloud)
    write_plan(tmp_path / "plan.toml", replace(case.project.inspection, features=(TOP,)))

    def exit_code(nominal_mm):
        changed = replace(gauge, nominal_mm=nominal_mm, tolerance_mm=5.0)
        write_gauge(path, changed, json.loads(path.read_text())["calibration_id"])
        said = trisect("inspect", results, "--plan", tmp_path / "plan.toml", "--json")
        return said.code, json.loads(said.out)["verdict"]

    assert exit_code(gauge.thickness_mm) == (0, "conforming")
    assert exit_code(gauge.thickness_mm + 20.0) == (1, "not conforming")
