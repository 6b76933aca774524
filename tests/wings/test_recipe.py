"""A stranger's wing, built from the manual's recipe alone: a feature, a command and a section of the report."""

import io
import json
from dataclasses import replace

import pytest
from pypdf import PdfReader

from core.door import WITHOUT
from core.errors import InputError
from core.files.project.data import KeptStudy, Project
from core.messages import plain
from core.pipeline.project.report import with_words
from core.pipeline.steps.brought_sections import with_studies
from core.pipeline.steps.report_step import draw_report, results_content
from tests.report.report_samples import block_content
from tests.simulated import copy_of, trisect
from tests.wings.recipe import install_recipe
from tests.wings.strangers import install, look_again

__all__ = ["install"]

PLAN = """
[[feature]]
name = "worn"
kind = "wear"
"""


@pytest.fixture
def inspected(install, measured, tmp_path):
    """Results with the stranger's feature measured."""
    install_recipe(install)
    out = copy_of(measured, tmp_path / "out")
    (out / "plan.toml").write_text(PLAN)
    said = trisect("inspect", out, "--plan", out / "plan.toml", "--json")
    assert said.code == 0, said.err
    return out, json.loads(said.out)


def printed(content):
    return "\n".join(page.extract_text() for page in PdfReader(io.BytesIO(draw_report(content))).pages)


def test_feature_command_and_section_are_there_and_gone_without_the_wing(inspected, monkeypatch):
    out, said = inspected
    (row,) = [row for row in said["characteristics"] if row["name"] == "worn flatness"]
    assert trisect("wear", out).out == f"{row['value']:.3f} mm\n"
    content = results_content(out)
    (section,) = content.brought
    assert [(fact.label, fact.value) for fact in section.facts] == [("worn flatness", pytest.approx(row["value"]))]
    pages = printed(content)
    assert "From the package lab-wear 1.2, which is no part of Trisect." in pages
    assert "\nWear\n" in pages
    pages = printed(replace(content, hidden=frozenset({"wear"})))
    assert "\nWear\n" not in pages and "Left out of this report by choice: Wear." in pages

    monkeypatch.setenv(WITHOUT, "wear")
    look_again()
    assert trisect("wear", out).code == 2
    assert results_content(out).brought == ()


def test_a_section_without_facts_is_not_printed(install, measured):
    before = results_content(measured)
    install_recipe(install)
    after = results_content(measured)
    assert after.brought == () and after.notes == before.notes and after.report_id == before.report_id


@pytest.mark.parametrize(
    ("facts", "why"),
    [
        ("raise KeyError(7)", "KeyError: 7"),
        ("return [3]", "AttributeError"),
        ("return [Fact('wear', {}, 'mm')]", "TypeError"),
    ],
)
def test_a_section_that_fails_is_told_and_the_report_is_made(install, measured, facts, why):
    source = (
        "from core.wing import ReportSection, Wing\nfrom core.report.facts.fact import Fact\n"
        f"def worn(folder, content):\n    {facts}\n"
        "WING = Wing('torn', sections=(ReportSection('Torn', 'lab_torn:worn'),))\n"
    )
    install("lab-torn", {"lab_torn": source}, {"trisect.wings": {"torn": "lab_torn:WING"}})
    content = results_content(measured)
    assert content.brought == ()
    (note,) = [str(one) for one in content.notes if one.code == "plugin.failed"]
    assert note.startswith(f"Torn of the package lab-torn 1.2 failed: {why}")


READER = """
from pathlib import Path
from core.errors import InputError
from core.wing import Wing
def read(path):
    {does}
WING = Wing("studies", reads_study="lab_read:{function}")
"""


def with_reader(install, monkeypatch, does, function="read"):
    """A stranger's wing reads studies, ours does not."""
    monkeypatch.setattr("core.wing.OURS", "core.no_such_folder")
    source = READER.format(does=does, function=function)
    install("lab-read", {"lab_read": source}, {"trisect.wings": {"studies": "lab_read:WING"}})


@pytest.mark.parametrize(
    ("does", "function", "why"),
    [
        ("import no_such_module", "read", "ModuleNotFoundError: No module named 'no_such_module'"),
        ("pass", "nothing", "AttributeError: module 'lab_read' has no attribute 'nothing'"),
        ("return None", "read", "AttributeError"),
    ],
)
def test_a_reader_of_studies_that_fails_is_told_once_and_the_report_is_made(
    install, monkeypatch, tmp_path, does, function, why
):
    with_reader(install, monkeypatch, does, function)
    content = block_content()
    kept = tuple(KeptStudy(name, "grr", plain(name)) for name in ("ab", "cd"))
    told = with_words(content, tmp_path, Project(studies=kept))
    (note,) = told.notes[len(content.notes) :]
    what = "No study can be read from ab and cd: studies of the package lab-read 1.2 failed"
    assert told.studies == () and str(note).startswith(f"{what}: {why}")


def test_a_study_that_its_reader_refuses_is_refused(install, monkeypatch, tmp_path):
    with_reader(install, monkeypatch, "raise InputError('it is torn', where=path)")
    with pytest.raises(InputError, match="it is torn"):
        with_studies(block_content(), [tmp_path / "study.json"])
