"""What a wing adds is there; one that is left out, or cannot be used, takes nothing else with it."""

import io
import sys

import pytest
from openpyxl import load_workbook
from pypdf import PdfReader

from core.door import WITHOUT, by_folders
from core.files.results.export_list import exports
from core.files.results.ply import read_cloud
from core.findings.brought import note_on_unusable
from core.findings.table import FINDINGS as HOUSE
from core.findings.table import all_findings, is_grave, note_of
from core.inspect.plan.kinds import every_kind, unusable_kinds
from core.pipeline.steps.report_step import draw_report, results_content
from core.wing import OUR_COMMANDS, wings
from tests.simulated import trisect
from tests.wings.strangers import install, look_again
from workbench.pages.report.words import export_words
from workbench.wing import window_wings

__all__ = ["install"]

GREETING = """
import typer
from core.wing import Wing

commands = typer.Typer()

@commands.command(rich_help_panel="Before a measurement")
def greet() -> None:
    '''Greet.'''
    typer.echo("hello")

WING = Wing("greeting", "lab_greeting:commands", after="card")
TAKEN = Wing("taken", "lab_taken:commands")
NOWHERE = Wing("nowhere", "lab_greeting:nothing")
LAST = Wing("last", "lab_greeting:commands", after="no such command")
NO_WING = 7
"""
TAKEN = GREETING.replace("def greet", "def card")


def listed(said):
    """The commands of `trisect --help`, in its order."""
    return [line.split()[1] for line in said.out.splitlines() if line.startswith("│ ") and line[2] not in " -"]


def installed(install, *names):
    points = {name.lower(): f"lab_greeting:{name}" for name in names}
    install("lab-greeting", {"lab_greeting": GREETING, "lab_taken": TAKEN}, {"trisect.wings": points})


def test_our_own_wings_can_be_used():
    assert not wings().unusable and not window_wings().unusable
    assert [origin for _, origin in (*wings().wings, *window_wings().wings) if origin is not None] == []


def test_a_command_of_a_wing_is_run_and_stands_in_the_help_where_it_says(install):
    before = listed(trisect("--help"))
    installed(install, "WING")
    assert trisect("greet").out == "hello\n"
    place = before.index("card") + 1
    assert listed(trisect("--help")) == [*before[:place], "greet", *before[place:]]


def test_a_command_behind_none_stands_last_of_its_kind(install):
    before = listed(trisect("--help"))
    installed(install, "LAST")
    after = listed(trisect("--help"))
    assert [name for name in after if name != "greet"] == before
    assert after[after.index("greet") - 1] == "sources"


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("NO_WING", "it is no Wing"),
        ("MISSING", "AttributeError"),
        ("NOWHERE", "AttributeError"),
        ("TAKEN", "there is a command card already"),
    ],
)
def test_a_wing_that_cannot_be_used_is_told_and_every_command_stays(install, name, why):
    before = listed(trisect("--help"))
    installed(install, name)
    said = trisect("--help")
    assert listed(said) == before
    assert f"{name.lower()} of the package lab-greeting 1.2 cannot be used: " in said.err and why in said.err


FINDINGS = """
from core.findings.finding import Effect, Finding, Weight
from core.wing import Wing

GRAVE = Finding("lab.bent", Weight.GRAVE, Effect.NO_RESULT, "It is bent.")
ROWS = (GRAVE,)
NONE = (GRAVE, 7)
TWICE = (GRAVE, GRAVE)
TAKEN = (Finding("scan.moved", Weight.INFORMATION, Effect.NONE, "Ours."), GRAVE)
WING = Wing("bent", findings="lab_bent:{rows}")
"""


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ("ROWS", ""),
        ("NONE", "one of its findings is no Finding"),
        ("TWICE", "the code of its finding lab.bent is taken"),
        ("TAKEN", "the code of its finding scan.moved is taken"),
        ("NOWHERE", "AttributeError: module 'lab_bent' has no attribute 'NOWHERE'"),
    ],
)
def test_findings_that_cannot_be_used_are_told_and_those_of_the_house_stay(install, rows, why):
    install("lab-bent", {"lab_bent": FINDINGS.format(rows=rows)}, {"trisect.wings": {"bent": "lab_bent:WING"}})
    told = f"bent of the package lab-bent 1.2 cannot be used: {why}." if why else ""
    assert trisect("--help").err.strip() == told
    assert all_findings().items() >= HOUSE.items()
    if rows != "NOWHERE":
        assert is_grave(note_of("lab.bent"))


EXPORTS = """
from pathlib import Path
from core.errors import InputError
from core.files.results.export_list import BroughtExport, ExportKind
from core.report.facts.fact import Fact
from core.wing import ReportSection, Wing

def write(results, path, progress):
    path.write_text(f"{len(results.content.cloud)} points")

def fails(results, path, progress):
    raise ZeroDivisionError("by zero")

def told(out, content):
    return [Fact("points counted", len(content.cloud))]

COUNT = BroughtExport(ExportKind("count", "Count", "count.txt", "scan"), "lab_count:write", "cloud", "How many")
LAST = BroughtExport(ExportKind("last", "Last", "last.txt", "scan"), "lab_count:fails")
ROWS = (COUNT, LAST)
NONE = (COUNT, 7)
TWICE = (COUNT, COUNT)
TAKEN = (BroughtExport(ExportKind("pdf", "Ours", "our.pdf", "scan"), "lab_count:write"), COUNT)
WING = Wing("count", sections=(ReportSection("Counted", "lab_count:told", "count"),), exports="lab_count:{rows}")
"""


def counting(install, rows="ROWS"):
    install("lab-count", {"lab_count": EXPORTS.replace("{rows}", rows)}, {"trisect.wings": {"count": "lab_count:WING"}})


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ("ROWS", ""),
        ("NONE", "one of its kinds of export is no BroughtExport"),
        ("TWICE", "the name of its kind of export count is taken"),
        ("TAKEN", "the name of its kind of export pdf is taken"),
        ("NOWHERE", "AttributeError: module 'lab_count' has no attribute 'NOWHERE'"),
    ],
)
def test_exports_that_cannot_be_used_are_told_and_those_of_the_house_stay(install, rows, why):
    before = list(exports())
    counting(install, rows)
    told = f"count of the package lab-count 1.2 cannot be used: {why}." if why else ""
    assert trisect("--help").err.strip() == told
    assert [name for name in exports() if name in before] == before
    if rows != "NOWHERE":
        assert list(exports())[before.index("cloud") + 1] == "count"
        assert export_words("count") == ("Count", "How many", "mdi6.file-export-outline")


def test_an_export_of_a_wing_is_written_and_one_that_fails_costs_no_other(install, measured, tmp_path):
    counting(install)
    said = trisect("export", measured, "--format", "last,count,cloud", "--to", tmp_path)
    assert said.code == 2 and "last of the package lab-count 1.2 failed: ZeroDivisionError: by zero" in said.err
    points = len(read_cloud(measured / "cloud.ply").cloud)
    assert (tmp_path / "count.txt").read_text() == f"{points} points" and (tmp_path / "cloud.ply").exists()


def test_facts_of_a_wing_stand_below_the_results_and_in_the_workbook(install, measured, tmp_path):
    counting(install)
    content = results_content(measured)
    points = len(content.cloud)
    assert [fact.value for fact in content.facts["count"]] == [points]
    page = PdfReader(io.BytesIO(draw_report(content))).pages[0].extract_text().replace("\N{NO-BREAK SPACE}", " ")
    assert "Counted" in page and "From the package lab-count 1.2, which is no part of Trisect." in page
    trisect("export", measured, "--format", "xlsx", "--to", tmp_path)
    rows = [[cell.value for cell in row] for row in load_workbook(tmp_path / "result.xlsx")["facts"].iter_rows()]
    assert any({"count", "points counted", points} <= {*row} for row in rows)


KINDS = """
from core.inspect.plan.feature_kind import FeatureKind
from core.wing import Wing

MINE = FeatureKind("mine", "lab_kinds:measure", "Mine", "Mine", "mdi6.cube-outline")
ROWS = (MINE,)
NONE = (MINE, 7)
TWICE = (MINE, MINE)
TAKEN = (FeatureKind("plane", "lab_kinds:measure", "Ours", "Ours", "mdi6.cube-outline"), MINE)
WING = Wing("kinds", feature_kinds="lab_kinds:{rows}")

def measure(spec, scene):
    raise ZeroDivisionError("by zero")
"""


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ("ROWS", ""),
        ("NONE", "one of its kinds of features is no FeatureKind"),
        ("TWICE", "the name of its kind of feature mine is taken"),
        ("TAKEN", "the name of its kind of feature plane is taken"),
        ("NOWHERE", "AttributeError: module 'lab_kinds' has no attribute 'NOWHERE'"),
    ],
)
def test_kinds_of_features_that_cannot_be_used_are_told_and_those_of_the_house_stay(install, rows, why):
    before = every_kind()
    points = {"trisect.wings": {"kinds": "lab_kinds:WING"}}
    install("lab-kinds", {"lab_kinds": KINDS.replace("{rows}", rows)}, points)
    told = f"kinds of the package lab-kinds 1.2 cannot be used: {why}." if why else ""
    assert " ".join(str(note_on_unusable(one)) for one in unusable_kinds()) == told
    assert every_kind()[: len(before)] == before
    assert [kind.name for kind in every_kind()[len(before) :]] == ([] if rows == "NOWHERE" else ["mine"])


def test_a_wing_is_left_out_by_its_name(install, monkeypatch):
    installed(install, "WING")
    monkeypatch.setenv(WITHOUT, "plan, greeting")
    look_again()
    said, what = trisect("greet"), 'the command "greet" is of the wing greeting, which is not there'
    assert said.code == 2 and f"{what}; take it out of TRISECT_WITHOUT_WINGS." in said.err
    assert "cannot be used" not in said.err
    assert (
        "TRISECT_WITHOUT_WINGS names plan, but the wings are audit, geometry, greeting, rig_planning and studies."
        in said.err
    )


def test_wings_of_the_window_alone_and_broken_ones_are_among_the_names_that_are_listed(install, monkeypatch):
    groups = {"trisect.window_wings": {"gauges": "lab_gauges:WING"}, "trisect.wings": {"broken": "lab_gauges:NONE"}}
    install("lab-gauges", {"lab_gauges": ""}, groups)
    monkeypatch.setenv(WITHOUT, "gouges")
    look_again()
    assert (
        "names gouges, but the wings are audit, broken, gauges, geometry, rig_planning and studies."
        in trisect("--help").err
    )


def test_the_name_of_an_entry_point_is_a_name_of_its_wing(install, monkeypatch):
    installed(install, "WING")
    monkeypatch.setenv(WITHOUT, "wing")
    look_again()
    assert trisect("--help").err == "" and "is of the wing greeting" in trisect("greet").err


def test_a_command_of_ours_whose_folder_is_gone_says_how_it_is_had(monkeypatch):
    monkeypatch.setattr("core.wing.OURS", "core.no_such_folder")
    look_again()
    told = [trisect(command).err for command in OUR_COMMANDS]
    monkeypatch.undo()
    look_again()
    assert all("which is not there; install Trisect with all its folders." in one for one in told)


@pytest.mark.parametrize(
    "text",
    ["import no_such_module\n", "from core.wing import Wing\nWING = Wing('studies', 'no_such_module:commands')\n"],
)
def test_a_command_of_ours_whose_folder_cannot_be_loaded_says_why(tmp_path, monkeypatch, text):
    folder = tmp_path / "broken_wings" / "studies"
    folder.mkdir(parents=True)
    for name, written in (("../__init__.py", ""), ("__init__.py", ""), ("wing.py", text)):
        (folder / name).write_text(written, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr("core.wing.OURS", "broken_wings")
    look_again()
    told = trisect("study").err
    monkeypatch.undo()
    look_again()
    for module in [name for name in sys.modules if name.startswith("broken_wings")]:
        del sys.modules[module]
    why = "ModuleNotFoundError: No module named 'no_such_module'"
    wrong = f'the command "study" is of the wing studies, which cannot be loaded ({why}); install Trisect with all'
    assert wrong in told and "not there" not in told


def test_where_the_folder_of_wings_is_gone_there_are_none():
    assert list(by_folders("core.no_such_folder", "WING")) == []
