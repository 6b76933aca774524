"""Operator mode: four buttons in big type, a plan that cannot be changed, one part after the other."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QPoint
from PySide6.QtWidgets import QApplication

from core.inspect.conformity import Verdict
from core.inspect.result_list import ResultList
from tests.workbench.clipped import clipped
from tests.workbench.test_fit import window_in
from workbench.bench import Bench
from workbench.main_window import SMALLEST, MainWindow
from workbench.pages.project.operator import OperatorFacts, Stage, operator_buttons, stage_of
from workbench.theme import shades
from workbench.views import ask
from workbench.views.lists.value_rows import VERDICT_ICONS

LEFT = (frozenset[str](), frozenset({"report"}), frozenset({"scan", "gauge", "report"}))
STATES = [
    OperatorFacts(pictures, left, running, busy, stopped, report, cannot, read_only)
    for pictures, left, running, busy, stopped, report, cannot, read_only in product(
        (False, True), LEFT, (False, True), (False, True), ("", "why"), (False, True), ("", "cannot"), ("", "read-only")
    )
]


def test_in_every_state_a_grey_button_says_why_and_measuring_can_be_stopped() -> None:
    for facts in STATES:
        can, stage = operator_buttons(facts), stage_of(facts)
        assert bool(can.next_part) == (facts.running or facts.busy), facts
        assert bool(can.stop) == (not facts.running and not facts.busy), facts
        assert bool(can.report) == (facts.running or not facts.report), facts
        reason = facts.read_only if stage is Stage.PICTURES else facts.cannot_measure
        assert bool(can.measure) == bool(facts.running or facts.busy or reason), facts
        assert (stage is Stage.MEASURING) == facts.running, facts
        assert stage is not Stage.DONE or not facts.left, facts


@pytest.fixture
def operator(window: MainWindow, measured_project: Path, qtbot: Any) -> MainWindow:
    """The window with a finished project, in operator mode."""
    window.model.open(measured_project)
    window.menus.actions["operator mode"].trigger()
    qtbot.waitUntil(lambda: bool(window.operator_mode.found), timeout=60_000)
    window.operator.refresh()
    return window


def test_the_worst_result_is_told_large_and_nothing_else_can_be_done(operator: MainWindow, qtbot: Any) -> None:
    page, entries = operator.operator, operator.menus.actions
    found = operator.operator_mode.found
    assert found is not None
    assert page.isVisible() and not operator.menuBar().isVisible() and not operator.rail.isVisible()
    assert page.headline.text().lower() == (str(found.verdict) or "no verdict")
    assert "\u00a0mm\u00a0±\u00a0" in page.detail.text(), "a line break parts no value from its U"
    assert page.tolerance.isVisible() and page.tolerance.accessibleName().startswith("deviation ")
    ink = {page.tolerance.grab().toImage().pixelColor(x, page.tolerance.height() // 2).name() for x in range(600)}
    _, colour = VERDICT_ICONS[found.verdict]
    assert getattr(shades(), colour).lower() in ink, "the interval is drawn in the verdict's colour"
    assert page.buttons["report"].isEnabled() and page.buttons["next_part"].isEnabled()
    assert page.buttons["measure"].toolTip() == "Everything is done."
    assert page.buttons["stop"].toolTip() == "Nothing is running."
    for name in ("step inspect", "save", "open", "new", "run", "whole", "language de"):
        assert entries[name].toolTip() == "Leave operator mode first.", name
    assert not entries["undo"].isVisible()
    assert entries["next part"].isEnabled() and entries["full"].isEnabled()


def test_whoever_leaves_it_is_where_he_was(operator: MainWindow, qtbot: Any) -> None:
    operator.operator.leaving.click()
    assert operator.pages["project"].isVisible() and operator.menuBar().isVisible()
    assert operator.menus.actions["step inspect"].isEnabled() and operator.menus.actions["undo"].isVisible()


def test_where_the_part_goes_is_shown_with_its_outline_until_it_is_measured_under_another_rig(
    operator: MainWindow, qtbot: Any
) -> None:
    page, mode = operator.operator, operator.operator_mode
    qtbot.waitUntil(lambda: mode.placing is not None, timeout=60_000)
    page.refresh()
    assert page.place.isVisible() and page.place.has_picture and page.place.layer_names() == ("part",)
    project = operator.model.project
    rested = replace(project, accepted=replace(project.accepted, planes="another"))
    operator.model.edit("another rig", rested)
    mode.look()
    page.refresh()
    assert mode.placing is None and not page.place.isVisible()


@pytest.mark.accuracy
def test_the_next_part_is_measured_without_leaving_it(
    operator: MainWindow, qtbot: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    page, before = operator.operator, operator.operator_mode.found
    assert before is not None

    def stage() -> Stage:
        return operator.operator_mode.stage

    pictures = operator.model.folder / "recordings" / "scan" if operator.model.folder else tmp_path
    monkeypatch.setattr(ask, "ask_next_part", lambda *_: ("2", "Bo", tmp_path / "Block 2"))
    monkeypatch.setattr(ask, "choose_folder", lambda *_: pictures)
    page.buttons["next_part"].click()
    qtbot.waitUntil(lambda: operator.model.folder == tmp_path / "Block 2", timeout=60_000)
    page.refresh()
    assert page.isVisible() and stage() is Stage.PICTURES
    assert page.part.text().endswith("No. 2") and page.who.text() == "Bo"
    page.buttons["measure"].click()
    assert stage() is Stage.MEASURING
    qtbot.waitUntil(lambda: stage() is not Stage.MEASURING, timeout=150_000)
    assert stage() is Stage.DONE, operator.operator_mode.facts
    qtbot.waitUntil(lambda: bool(operator.operator_mode.found), timeout=60_000)
    assert page.isVisible()
    after = operator.operator_mode.found
    assert after is not None and after.rows[0].value == before.rows[0].value
    assert after.verdict in (Verdict.CONFORMING, before.verdict)


@pytest.mark.parametrize("name", ["de", *(pytest.param(name, marks=pytest.mark.accuracy) for name in ("en", "zh_CN"))])
def test_nothing_is_cut_in_the_smallest_window(
    bench: Bench, qapp: QApplication, qtbot: Any, measured_project: Path, name: str
) -> None:
    with window_in(name, bench, qapp, qtbot) as window:
        window.resize(SMALLEST)
        bench.model.open(measured_project)
        window.enter_operator_mode()
        qtbot.waitUntil(lambda: bool(window.operator_mode.found), timeout=60_000)
        window.operator.refresh()
        for _ in range(3):
            qapp.processEvents()
        assert clipped(window) == {}
        for button in window.operator.buttons.values():
            corner = button.mapTo(window, QPoint(button.width() - 1, button.height() - 1))
            assert window.rect().contains(corner)


def test_a_part_of_which_nothing_asked_for_could_be_measured_is_not_called_measured(
    operator: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(operator.operator_mode, "found", ResultList(None, (), unmeasured=True))
    operator.operator.refresh()
    assert (operator.operator.headline.text(), operator.operator.detail.text()) == ("Not proven", "")
