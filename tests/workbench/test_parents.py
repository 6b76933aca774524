"""Each widget of the window has a parent, which deletes it: none is left to Python's garbage collector."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtWidgets import QApplication

from tests.workbench.parentless import parentless
from tests.workbench.test_fit import fill_inspect_page, window_in
from workbench.bench import Bench
from workbench.main_window import MainWindow
from workbench.steps import STEPS


def see_all_tabs(window: MainWindow, qtbot: Any) -> None:
    """Each page, and each of its tabs."""
    for step in STEPS:
        window.go_to(step.name)
        tabs: Any = getattr(window.pages[step.name], "tabs", None)
        for tab in range(tabs.count()) if tabs is not None else ():
            tabs.setCurrentIndex(tab)
            qtbot.wait(10)


def test_no_widget_of_any_page_is_without_a_parent(
    bench: Bench, qapp: QApplication, measured_project: Path, qtbot: Any
) -> None:
    before = qapp.topLevelWidgets()
    with window_in("en", bench, qapp, qtbot) as window:
        see_all_tabs(window, qtbot)
        assert parentless(qapp, before) == [], "without a project"
        bench.model.open(measured_project)
        fill_inspect_page(window, bench, qtbot)
        see_all_tabs(window, qtbot)
        assert parentless(qapp, before) == [], "with results"
        window.menus.actions["operator mode"].trigger()
        window.operator.leaving.click()
        assert parentless(qapp, before) == [], "after operator mode"
        bench.model.close()
        bench.model.open(measured_project)
        see_all_tabs(window, qtbot)
        assert parentless(qapp, before) == [], "with the project opened again"
