"""What a report takes from study.json; without the wing it is told that nobody reads it."""

from dataclasses import replace

import numpy as np
import pytest

from core.door import WITHOUT
from core.errors import InputError
from core.files.project.data import KeptStudy, Project
from core.messages import Message
from core.pipeline.project.report import with_words
from core.pipeline.steps.brought_sections import with_studies
from core.wings.studies.files.study_file import write_study
from core.wings.studies.kinds.type1 import type1_study
from tests.report.report_samples import block_content
from tests.simulated import trisect
from tests.wings.strangers import look_again


@pytest.fixture
def content():
    return block_content()


@pytest.fixture
def away(monkeypatch):
    monkeypatch.setenv(WITHOUT, "studies")
    look_again()
    yield
    monkeypatch.undo()
    look_again()


def test_a_study_is_printed_from_its_file(tmp_path, content):
    values = 50 + np.linspace(-0.01, 0.012, 25)
    write_study(tmp_path, type1_study(values, 50.0, 0.4))
    (study,) = with_studies(content, [tmp_path / "study.json"]).studies
    (by_folder,) = with_studies(content, [tmp_path]).studies
    (mean,), (again,) = ([fact.value for fact in one.facts if fact.label == "mean"] for one in (study, by_folder))
    assert study.kind == "Type-1 study" and mean == again == pytest.approx(50.001)
    with pytest.raises(InputError, match=r"missing\.json"):
        with_studies(content, [tmp_path / "missing.json"])


def test_without_the_wing_a_study_that_is_asked_for_is_refused_with_its_name(away, tmp_path, content):
    with pytest.raises(
        InputError, match="read by the wing studies, which is not there; take it out of TRISECT_WITHOUT_WINGS"
    ):
        with_studies(content, [tmp_path / "study.json"])
    assert with_studies(content, []) is content


def test_without_the_wing_a_projects_report_tells_which_studies_are_not_printed(away, tmp_path, content):
    kept = KeptStudy("ab", "grr", Message("study.title_values", "{n} × {name}", n=3, name="width"))
    project = Project(studies=(kept, replace(kept, id="cd", included=False)))
    told = with_words(content, tmp_path, project)
    assert told.studies == () and told.notes[: len(content.notes)] == content.notes
    (note,) = told.notes[len(content.notes) :]
    assert str(note) == "The project's studies are not printed, as no wing that reads them is there: 3 × width."


def test_without_the_wing_its_command_says_so_and_a_misspelt_wing_is_told(away, monkeypatch):
    said = trisect("study", "grr", "x.csv")
    what = 'trisect: the command "study" is of the wing studies, which is not there'
    assert (said.code, said.sentence) == (2, f"{what}; take it out of TRISECT_WITHOUT_WINGS.")
    monkeypatch.setenv(WITHOUT, "study")
    look_again()
    assert "TRISECT_WITHOUT_WINGS names study, but the wings are " in trisect("study", "--help").err
