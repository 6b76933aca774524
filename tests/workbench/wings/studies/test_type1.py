"""The type-1 study of the repeats, below their statistics."""

from dataclasses import replace

import pytest

from core.wings.studies.kinds.type1 import type1_study
from tests.workbench.pages import inspect_cases as cases
from tests.workbench.pages.inspect.conftest import measuring, quick, show_page
from tests.workbench.tabs import tab_titles
from workbench.pages.inspect.words import repeats_tsv
from workbench.wings.studies.type1 import no_type1, type1_part

__all__ = ["measuring", "quick", "show_page"]


@pytest.fixture
def presenter(hand_bench, quick, tmp_path, qtbot):
    return cases.entered(hand_bench, tmp_path / "project", cases.project(nominal_mm=50.0, tolerance_mm=0.2), qtbot)


def put_repeats(presenter, values):
    repeats = tuple(cases.repeat(number, value) for number, value in enumerate(values, 2))
    presenter.model.edit("repeats", replace(presenter.project, repeats=repeats))


def test_it_has_the_numbers_of_the_command_line(presenter, qtbot):
    part, values = type1_part(presenter), (50.012, 50.018, 50.007, 50.011)
    qtbot.addWidget(part)
    put_repeats(presenter, values[:1])
    assert "needs two repeats" in no_type1(presenter.repeats)
    put_repeats(presenter, values)
    part.type1.make()
    qtbot.waitUntil(lambda: part.type1.study is not None)
    told, wanted = part.type1.study, type1_study(values, 50.0, 0.4)
    assert (told.cg, told.cgk, told.p) == (wanted.cg, wanted.cgk, wanted.p)
    assert f"Cgk\t{wanted.cgk:.6f}" in repeats_tsv(presenter.project.repeats, part.facts())
    presenter.faces.set_number("tolerance_mm", 0.1)
    assert part.type1.study is None and part.facts() == (), "it is of another tolerance"
    presenter.faces.set_number("tolerance_mm", None)
    presenter.faces.set_number("nominal_mm", None)
    assert "needs a reference part" in no_type1(presenter.repeats)


def test_the_repeats_are_studied_beside_their_chart(presenter, show_page, qtbot):
    page = show_page(presenter)
    put_repeats(presenter, [50.0 + 0.01 * number for number in range(2, 6)])
    page.tabs.setCurrentWidget(page.series)
    (part,) = (one.widget for one in page.series.parts)
    qtbot.waitUntil(lambda: part.rows.text_of("Verdict") == "not capable")
    assert part.rows.text_of("Tolerance T") == "0.4 mm"
    assert "4 repeats say little" in part.words.text()
    assert len(page.series.histogram._values) == 4


def test_the_tab_of_the_wing_is_the_last_and_its_study_stands_below_the_repeats(presenter, show_page):
    page = show_page(presenter)
    assert tab_titles(page.tabs)[-1] == "Studies"
    assert [type(part.widget).__name__ for part in page.series.parts] == ["Type1Part"]
