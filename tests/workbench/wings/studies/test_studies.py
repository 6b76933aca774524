"""Studies in the window: made from a table, from repeats and other projects, listed, ticked for the report, undone."""

import json
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QScrollArea, QStyle

from core.errors import InputError
from core.files.project.folder import study_path
from core.translations import language
from tests.wings.studies.grr_tables import AIAG
from tests.workbench.cells import place, shown
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import inspect_cases as cases
from tests.workbench.pages.inspect.conftest import measuring, quick, show_page
from tests.workbench.tabs import tab_titled
from workbench.language import choose, tr
from workbench.theme import apply_theme
from workbench.views import ask
from workbench.wings.studies import jobs

__all__ = ["measuring", "quick", "show_page"]

RAIL = 186
"""Pixels of the steps at the left."""
STUDIES = 4
"""Place of the tab."""
ROWS = "".join(
    f"{part}\t{'ABC'[operator]}\t{AIAG[part, operator, repeat]:.2f}\n"
    for part in range(10)
    for operator in range(3)
    for repeat in range(3)
)


@pytest.fixture
def presenter(hand_bench, quick, tmp_path, qtbot):
    project = cases.project(nominal_mm=50.0, tolerance_mm=0.2)
    repeats = tuple(cases.repeat(number, 50 + 0.01 * number) for number in range(3))
    return cases.entered(hand_bench, tmp_path / "project", replace(project, repeats=repeats), qtbot)


@pytest.fixture
def studies(tab):
    return tab.studies


@pytest.fixture
def tab(presenter, show_page):
    made = show_page(presenter)
    made.tabs.setCurrentIndex(STUDIES)
    return tab_titled(made.tabs, "Studies")


def undo(presenter):
    presenter.model.undo_stack.undo()


def made(studies, qtbot):
    """Wait until the study is there; the first one of a process imports what makes studies."""
    qtbot.waitUntil(lambda: studies.study is not None and not studies.working, timeout=60_000)
    assert len(studies.all) == 1


def test_a_gauge_rr_study_is_pasted_made_shown_and_undone(tab, studies, presenter, qtbot):
    tab.window().refreshing.at_once()
    tab.buttons["grr"].click()
    tab.window().refreshing.at_once()
    assert tab.editor.isVisible() and tab.editor.text.toPlainText() == "part;operator;value\n"
    assert tab.editor.forms["grr"].values()["tolerance_mm"] == 0.2
    tab.editor.text.appendPlainText(ROWS)
    studies.set_value("tolerance_mm", None)
    tab.window().refreshing.at_once()
    tab.editor.make.click()
    made(studies, qtbot)
    tab.window().refreshing.at_once()
    assert tab.table.table.verticalScrollBar().maximum() == 0, "no scrolling within what scrolls"
    assert tab.list.height() < 120, "one study takes no room of many"
    assert tab.stack.currentIndex() == 0 and shown(tab.list, 0, 1) == "10 parts × 3 operators × 3 repeats"
    words = tab.list.fontMetrics().horizontalAdvance(shown(tab.list, 0))
    assert tab.list.columnWidth(0) > words + tab.list.style().pixelMetric(QStyle.PixelMetric.PM_IndicatorWidth) + 8
    assert tab.rows.text_of("Categories (ndc)") == "4"
    assert tab.rows.text_of("%GRR of the total (95 %)").startswith("27.9 % (")
    assert len(tab.table.rows()) == 7 and "gauge R&R" in tab.table.copied()
    undo(presenter)
    tab.window().refreshing.at_once()
    assert studies.all == () and not tab.table.isVisible()


def test_a_table_with_something_wrong_stays_with_a_sentence(tab, studies, qtbot):
    tab.window().refreshing.at_once()
    tab.buttons["grr"].click()
    tab.window().refreshing.at_once()
    tab.editor.text.setPlainText("part;operator;value\n1;A;2.0\n1;A;two\n")
    tab.window().refreshing.at_once()
    tab.editor.make.click()
    tab.window().refreshing.at_once()
    qtbot.waitUntil(lambda: not studies.working, timeout=60_000)
    tab.window().refreshing.at_once()
    assert "line 3" in tab.editor.problem.text() and tab.editor.problem.isVisible()
    assert studies.all == () and "two" in tab.editor.text.toPlainText()
    tab.editor.cancel.click()
    tab.window().refreshing.at_once()
    assert tab.stack.currentIndex() == 0 and studies.draft is None


def test_an_acceptance_check_has_its_limits(tab, studies, qtbot):
    tab.window().refreshing.at_once()
    tab.buttons["acceptance"].click()
    tab.window().refreshing.at_once()
    tab.editor.text.appendPlainText("size;left;25.012;25.0;0.001\nsize;right;25.03;25.0;0.001")
    studies.set_value("size", 0.02)
    tab.window().refreshing.at_once()
    tab.editor.make.click()
    made(studies, qtbot)
    tab.window().refreshing.at_once()
    assert tab.rows.text_of("Verdict") == "not conforming" and "not a certificate" in tab.notes.text()
    assert tab.table.copied().split("\n")[1].split("\t")[1:4] == ["2", "+0.0300", "right"]


def test_a_series_has_its_charts_its_indices_and_the_points_that_break_a_rule(tab, studies, qtbot):
    tab.window().refreshing.at_once()
    tab.buttons["series"].click()
    tab.window().refreshing.at_once()
    assert tab.editor.forms["series"].values() == {
        "name": "thickness",
        "nominal_mm": 50.0,
        "tolerance_mm": 0.2,
        "size": 1,
    }
    values = 50 + 0.01 * np.random.default_rng(5).standard_normal(40)
    values[25] += 0.08
    tab.editor.text.appendPlainText("".join(f"part {n}\t{value}\t0.002\n" for n, value in enumerate(values, start=1)))
    tab.window().refreshing.at_once()
    tab.editor.make.click()
    made(studies, qtbot)
    tab.window().refreshing.at_once()
    assert all(chart.isVisible() for chart in tab.charts)
    assert tab.charts[1].axis_text("left") == "moving range [mm]"
    assert tab.rows.text_of("Verdict") == "not proven" and "(" in tab.rows.text_of("Cpk (95 %)")
    assert tab.table.copied().split("\n")[26].split("\t")[0::2] == ["part 26", "1"]
    assert "part 26" in tab.notes.text()


def test_the_head_over_the_ticks_has_room_beside_a_short_kind(tab, studies, qtbot):
    studies.begin("series")
    studies.write("value\n" + "\n".join(f"{50 + 0.001 * (k % 7):.3f}" for k in range(25)))
    studies.finish()
    qtbot.waitUntil(lambda: bool(studies.all))
    qtbot.waitUntil(lambda: tab.list.model().rowCount() == 1)
    header = tab.list.header()
    assert header.sectionSize(0) >= header.sectionSizeHint(0)


def test_a_short_series_draws_no_limits_and_says_why(tab, studies, qtbot):
    tab.window().refreshing.at_once()
    tab.buttons["series"].click()
    tab.window().refreshing.at_once()
    tab.editor.text.appendPlainText("a;50.01;\nb;50.02;\n")
    tab.window().refreshing.at_once()
    tab.editor.make.click()
    made(studies, qtbot)
    tab.window().refreshing.at_once()
    assert not any(chart.isVisible() for chart in tab.charts)
    assert "20 or more" in tab.notes.text() and tab.rows.text_of("Verdict") == "not proven"


def test_rows_of_other_projects_and_of_a_file_go_into_the_table(tab, studies, presenter, qtbot, monkeypatch, tmp_path):
    lane = cast(HandLane, presenter.bench.measuring)
    asked = []
    lane.answers[jobs.PROJECT_ROWS] = lambda *what: asked.append(what) or "part;operator;value\n7;Ada;50.01\n"
    (tmp_path / "other.csv").write_text("part;operator;result\n1;A;run1\n")
    tab.buttons["grr"].click()
    monkeypatch.setattr(ask, "choose_folder", lambda *_: tmp_path)
    tab.editor.add.click()
    qtbot.waitUntil(lambda: "Ada" in tab.editor.text.toPlainText())
    assert tab.editor.text.toPlainText() == "part;operator;value\n7;Ada;50.01\n" and asked[0][:2] == ("grr", tmp_path)
    monkeypatch.setattr(ask, "choose_file_to_open", lambda *_: tmp_path / "other.csv")
    tab.editor.open.click()
    qtbot.waitUntil(lambda: "run1" in tab.editor.text.toPlainText())
    assert studies.draft.base == tmp_path
    lane.answers[jobs.PROJECT_ROWS] = lambda *_: (_ for _ in ()).throw(InputError("the project names no operator"))
    tab.editor.add.click()
    qtbot.waitUntil(lambda: "no operator" in tab.editor.problem.text())


def test_the_type1_study_of_the_repeats_is_kept_ticked_unticked_removed_and_exported(
    tab, studies, presenter, qtbot, monkeypatch, tmp_path
):
    tab.window().refreshing.at_once()
    tab.buttons["type1"].click()
    made(studies, qtbot)
    kept = studies.all[0]
    tab.window().refreshing.at_once()
    assert (kept.kind, kept.included) == ("type1", True)
    row, ticks = place(tab.list, 0), Qt.ItemDataRole.CheckStateRole
    tab.list.model().setData(row, Qt.CheckState.Unchecked, ticks)
    tab.window().refreshing.at_once()
    assert shown(tab.list, 0, role=ticks) is Qt.CheckState.Unchecked
    assert not studies.all[0].included
    undo(presenter)
    tab.window().refreshing.at_once()
    assert studies.all[0].included and shown(tab.list, 0, role=ticks) is Qt.CheckState.Checked
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: tmp_path / "mine.json")
    tab.window().refreshing.at_once()
    tab.buttons["export"].click()
    tab.window().refreshing.at_once()
    qtbot.waitUntil(lambda: (tmp_path / "mine.json").exists() and not studies.working)
    tab.window().refreshing.at_once()
    assert json.loads((tmp_path / "mine.json").read_text())["n"] == 3
    tab.buttons["remove"].click()
    tab.window().refreshing.at_once()
    assert studies.all == () and study_path(presenter.model.folder, kept.id).exists()
    undo(presenter)
    tab.window().refreshing.at_once()
    assert [one.id for one in studies.all] == [kept.id]


@pytest.mark.parametrize("kind", ["grr", "acceptance", "series"])
def test_the_names_of_the_columns_stay_in_one_line(tab, studies, kind, qtbot):
    studies.begin(kind)
    tab.window().refreshing.at_once()
    editor = tab.editor.text
    head = editor.document().firstBlock()
    assert editor.blockBoundingGeometry(head).height() < 1.5 * editor.fontMetrics().lineSpacing()
    assert kind == "acceptance" or editor.horizontalScrollBar().maximum() == 0, "all of it is seen"


def test_every_button_says_what_it_does_or_why_it_cannot(tab, studies, presenter, qtbot):
    presenter.model.edit("no repeats", replace(presenter.project, repeats=()))
    tab.window().refreshing.at_once()
    assert not tab.buttons["type1"].isEnabled() and "two repeats" in tab.buttons["type1"].toolTip()
    assert all(button.toolTip() for button in tab.buttons.values())
    studies.begin("acceptance")
    buttons = [tab.editor.open, tab.editor.add, tab.editor.make, tab.editor.cancel]
    tab.window().refreshing.at_once()
    assert all(button.toolTip() for button in buttons) and "certificate" in tab.editor.help.text()


def test_the_buttons_of_the_studies_follow_the_tab_from_state_to_state(tab, studies, presenter, hand_bench, qtbot):
    quick, editor = cast(HandLane, hand_bench.quick), tab.editor

    def follow():
        tab.window().refreshing.at_once()
        can = studies.buttons
        making = ((editor.open, can.read), (editor.add, can.read), (editor.make, can.make))
        kept = (
            (tab.buttons["grr"], can.begin), (tab.buttons["acceptance"], can.begin), (tab.buttons["type1"], can.type1),
            (tab.buttons["remove"], can.remove), (tab.buttons["export"], can.export),
        )  # fmt: skip
        for button, why_not in kept if studies.draft is None else making:
            assert button.isEnabled() if not why_not else not button.isEnabled() and button.toolTip() == why_not
        return can

    assert follow()[:3] == ("", "", "Choose a study in the list first.")
    tab.buttons["grr"].click()
    assert follow().make == "Enter or paste measurements into the table first."
    editor.text.appendPlainText(ROWS)
    assert editor.make.isEnabled(), "as soon as it is typed"
    assert follow()[4:] == ("", "")
    quick.held = {jobs.KEEP_STUDY}
    editor.make.click()
    assert follow().read == "Wait for what is under way: Making the study."


def test_a_study_that_is_given_up_while_it_is_made_is_not_kept(tab, studies, presenter, hand_bench, qtbot):
    quick = cast(HandLane, hand_bench.quick)
    quick.held = {jobs.KEEP_STUDY}
    tab.buttons["grr"].click()
    tab.window().refreshing.at_once()
    tab.editor.text.appendPlainText(ROWS)
    tab.editor.make.click()
    tab.window().refreshing.at_once()
    tab.editor.cancel.click()
    quick.held = set()
    qtbot.waitUntil(lambda: not studies.working)
    tab.window().refreshing.at_once()
    assert studies.all == () and studies.draft is None and tab.buttons["grr"].isEnabled()


def test_no_study_is_begun_in_a_project_that_is_read_only(tab, studies, presenter, monkeypatch):
    monkeypatch.setattr(type(presenter.model), "is_read_only", property(lambda _: True))
    tab.refresh()
    for name in ("grr", "acceptance", "type1"):
        assert not tab.buttons[name].isEnabled()
        assert tab.buttons[name].toolTip().startswith("The project is read-only: go on in a copy")


def test_the_characteristic_of_a_series_is_asked_of_the_projects_that_are_added(
    tab, studies, presenter, qtbot, monkeypatch, tmp_path
):
    asked = []
    lane = cast(HandLane, presenter.bench.measuring)
    lane.answers[jobs.PROJECT_ROWS] = lambda *what: asked.append(what) or "part;value_mm;u_mm\n7;0.03;0.004\n"
    tab.buttons["series"].click()
    assert studies.draft.values["name"] == "thickness"
    studies.set_value("name", "top flatness")
    monkeypatch.setattr(ask, "choose_folder", lambda *_: tmp_path)
    tab.editor.add.click()
    qtbot.waitUntil(lambda: "0.03" in tab.editor.text.toPlainText())
    assert asked[0][0] == "series" and asked[0][6] == "top flatness"


def page_with_study(presenter, show_page, qtbot):
    """A page of a window 1280 pixels wide that shows a gauge R&R study."""
    page = show_page(presenter, 1280 - RAIL, 700)
    page.tabs.setCurrentIndex(STUDIES)
    studies = tab_titled(page.tabs, "Studies").studies
    studies.begin("grr")
    studies.write("part;operator;value\n" + ROWS)
    studies.finish()
    made(studies, qtbot)
    page.refreshing.at_once()
    return page


def test_the_table_of_a_gauge_rr_study_is_seen_whole_in_german(presenter, show_page, qapp, qtbot):
    sheet = qapp.styleSheet()
    choose(language("de"), qapp)
    try:
        apply_theme(qapp, "light")
        page = page_with_study(presenter, show_page, qtbot)
        table = tab_titled(page.tabs, "Studies").table
        qtbot.waitUntil(lambda: table.isVisible() and len(table.rows()) == 7)
        assert len(table._model.titles) == 5 and table.table.horizontalScrollBar().maximum() == 0
        tab_titled(page.tabs, "Studies").rows.set_rows(
            [("Entscheidung", "bedingt geeignet, mit Vorbehalt", "", "warn")]
        )
        value = tab_titled(page.tabs, "Studies").rows._labels[0][1]
        qtbot.waitUntil(lambda: value.width() >= value.sizeHint().width())
        tip = table._model.headerData(3, Qt.Orientation.Horizontal, Qt.ItemDataRole.ToolTipRole)
        assert tip == tr("σ over that of the whole scatter")
    finally:
        choose(language("en"), qapp)
        qapp.setStyleSheet(sheet)


def test_the_table_of_a_study_is_cut_for_no_numbers_beside_it_but_for_the_edge_of_the_tab(
    presenter, show_page, qapp, qtbot
):
    sheet = qapp.styleSheet()
    try:
        apply_theme(qapp, "light")
        page = page_with_study(presenter, show_page, qtbot)
        tab = tab_titled(page.tabs, "Studies")
        bar, outer = tab.table.table.horizontalScrollBar(), tab.findChild(QScrollArea).horizontalScrollBar()
        qtbot.waitUntil(lambda: tab.table.isVisible() and len(tab.table.rows()) == 7)
        tab.table.set_headers([("a column of some width", "")] * 3)
        tab.table.set_rows([("1", "2", "3")])
        tab.rows.setMinimumWidth(320)
        page.resize(1070, 700)
        qtbot.waitUntil(lambda: page.width() == 1070 and bar.maximum() == 0 and outer.maximum() == 0)
        tab.table.set_headers([("a column of a title that is wider than the tab by a word " * 2, ""), ("s", "mm")])
        tab.table.set_rows([("1", "2")])
        page.resize(990, 700)
        qtbot.waitUntil(lambda: page.width() == 990 and bar.maximum() > 0 and outer.maximum() == 0)
    finally:
        qapp.setStyleSheet(sheet)


def test_the_fields_of_a_study_want_their_height_however_wide_the_place_below_its_table_is(tab, studies, qtbot):
    for kind, form in tab.editor.forms.items():
        studies.begin(kind)
        tab.refresh()
        assert len({form.parentWidget().heightForWidth(width) for width in (310, 460, 800)}) == 1, kind
        studies.give_up()
