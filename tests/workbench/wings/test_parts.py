"""A stranger's part below the repeats that fails costs the page nothing of its own; a notice tells it, once."""

from dataclasses import replace

import pytest
from PySide6.QtGui import QGuiApplication

from core.door import WITHOUT
from tests.wings.strangers import install
from tests.workbench.pages import inspect_cases as cases
from tests.workbench.pages.inspect.conftest import measuring, quick, show_page

__all__ = ["install", "measuring", "quick", "show_page"]

SOURCE = """
from PySide6.QtWidgets import QLabel
from core.report.facts.fact import Fact
from workbench.wing import InspectTab, WindowWing

class Part(QLabel):
    def refresh(self):
        {refresh}
    def facts(self):
        {facts}

def part(presenter):
    return {part}

WINDOW_WING = WindowWing("torn", tabs={tabs}, below_repeats="lab_torn_window:part")
"""
LAYER = """
import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QLabel
from workbench.wing import Coloured, InspectLayer, WindowWing

class Layer(QObject):
    changed, made = Signal(), Signal()
    why_not = ""
    def __init__(self, count):
        super().__init__()
        self.coloured = Coloured("worth", 2.0, np.arange(count, dtype=np.float32), np.zeros(4, np.float32), "no worth")
        self.beside = None
    def forget(self):
        {forget}

class Panel(QLabel):
    def __init__(self, presenter, layer):
        super().__init__()
        self.layer = layer
    def refresh(self):
        self.setText(self.layer.coloured.title)

def layer(presenter):
    return {layer}

WINDOW_WING = WindowWing(
    "torn", layers=(InspectLayer("worth", "Worth", "Worth of it", "lab_torn_window:layer", "lab_torn_window:{panel}"),)
)
"""
FAILED = "torn of the package lab-torn 1.2 failed: "


@pytest.fixture
def page(install, monkeypatch, hand_bench, quick, show_page, tmp_path, qtbot):
    """Shows the page Inspect of a project with two repeats, with the part of a stranger's wing."""

    def shown(refresh="pass", facts="return ()", part="Part()", tabs="()"):
        source = SOURCE.format(refresh=refresh, facts=facts, part=part, tabs=tabs)
        points = {"trisect.window_wings": {"torn": "lab_torn_window:WINDOW_WING"}}
        monkeypatch.setenv(WITHOUT, "studies")
        install("lab-torn", {"lab_torn_window": source}, points)
        repeats = tuple(cases.repeat(number, 50 + 0.01 * number) for number in range(2))
        project = replace(cases.project(nominal_mm=50.0, tolerance_mm=0.2), repeats=repeats)
        made = show_page(cases.entered(hand_bench, tmp_path / "project", project, qtbot))
        made.tabs.setCurrentWidget(made.series)
        return made

    return shown


def told(page):
    return [notice.text for notice in page.presenter.bench.notices.all]


def test_one_that_cannot_be_refreshed_leaves_nothing_stale(page):
    shown = page(refresh="raise OSError('no gauge')")
    assert len(shown.series.table.rows()) == 2
    presenter = shown.presenter
    more = (*presenter.project.repeats, cases.repeat(7, 50.02))
    presenter.model.edit("repeats", replace(presenter.project, repeats=more))
    shown.refreshing.at_once()
    assert len(shown.series.table.rows()) == 3 and shown.series.rows.text_of("Repeats") == "3"
    assert told(shown) == [f"{FAILED}OSError: no gauge"]


def test_its_facts_are_copied_with_the_repeats(page):
    shown = page(facts="return (Fact('wear', 0.25, 'mm'),)")
    shown.series.copy.click()
    assert QGuiApplication.clipboard().text().endswith("\n\nwear [mm]\t0.25\n") and told(shown) == []


@pytest.mark.parametrize(
    ("facts", "why"),
    [
        ("raise KeyError(7)", "KeyError: 7"),
        ("return [3]", "AttributeError: 'int' object has no attribute 'title'"),
        ("return [Fact('wear', {}, 'mm')]", "TypeError"),
    ],
)
def test_the_repeats_are_copied_without_facts_that_fail(page, facts, why):
    shown = page(facts=facts)
    shown.series.copy.click()
    assert "50.010000" in QGuiApplication.clipboard().text()
    (text,) = told(shown)
    assert text.startswith(FAILED + why)


def test_what_is_no_widget_is_told_and_the_page_opens(page):
    shown = page(part="3", tabs="(InspectTab('Torn', 'Torn', 'lab_torn_window:part'),)")
    assert not shown.series.parts and shown.tabs.tabText(shown.tabs.count() - 1) == "Plot"
    why = "of the package lab-torn 1.2 cannot be used: what it makes is no widget."
    assert sorted(told(shown)) == [f"Torn {why}", f"torn {why}"]


@pytest.fixture
def layered(install, monkeypatch, hand_bench, quick, show_page, tmp_path, qtbot):
    """Shows the page Inspect of a project with the layer of a stranger's wing."""

    def shown(layer=f"Layer({cases.POINTS})", forget="pass", panel="Panel"):
        monkeypatch.setenv(WITHOUT, "studies, geometry")
        monkeypatch.setenv("TRISECT_NO_OPENGL", "none")
        source = LAYER.format(layer=layer, forget=forget, panel=panel)
        points = {"trisect.window_wings": {"torn": "lab_torn_window:WINDOW_WING"}}
        install("lab-torn", {"lab_torn_window": source}, points)
        made = show_page(cases.entered(hand_bench, tmp_path / "project", cases.project(), qtbot))
        made.refreshing.at_once()
        return made

    return shown


def coloured_by(page, name):
    page.surface.choices.choose_colour(name)
    page.refreshing.at_once()
    page.surface._draw()
    return page.surface.scene._scene.cloud._values


def test_a_layer_colours_the_surface_and_has_a_panel_of_its_own(layered):
    page = layered()
    assert page.layers["worth"].widget.text() == "worth"
    assert not [text for text in told(page) if "lab-torn" in text]
    values = coloured_by(page, "layer worth")
    assert list(values) == list(page.presenter.scan.view.number)
    assert "no worth" in page.surface.line.text()


@pytest.mark.parametrize(
    ("made", "why"),
    [
        ({"layer": "3"}, "Worth of the package lab-torn 1.2 cannot be used: what it makes is no layer of the surface."),
        ({"layer": "Layer(3).made"}, "what it makes is no layer of the surface."),
        ({"layer": "Layer(3, 4)"}, "cannot be used: TypeError: "),
        ({"layer": "Layer(3)"}, "Worth of the package lab-torn 1.2 failed: IndexError: "),
        ({"layer": "QObject()"}, "Worth of the package lab-torn 1.2 failed: AttributeError: "),
        ({"forget": "raise OSError('torn')"}, "Worth of the package lab-torn 1.2 failed: OSError: torn"),
        ({"panel": "None"}, "Worth of it of the package lab-torn 1.2 cannot be used: AttributeError: "),
        ({"panel": "layer"}, "Worth of it of the package lab-torn 1.2 cannot be used: TypeError: "),
    ],
)
def test_a_layer_that_fails_is_told_and_the_page_goes_on(layered, made, why):
    page = layered(**made)
    if page.surface.choices.colours.findData("layer worth") >= 0:
        coloured_by(page, "layer worth")
    page.presenter.scan.forget()
    page.refreshing.at_once()
    assert any(why in text for text in told(page)), told(page)
    assert len(told(page)) == len(set(told(page)))
    assert page.features.isVisibleTo(page)
