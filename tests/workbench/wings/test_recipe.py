"""The page of a stranger's wing, built from the manual's recipe alone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import pytest
from PySide6.QtWidgets import QApplication, QLabel, QMainWindow

from core.files.project.data import new_project
from tests.wings.recipe import install_recipe
from tests.wings.strangers import Install, install, look_again
from tests.workbench.hand_lane import HandLane
from workbench.bench import Bench
from workbench.main_window import MainWindow
from workbench.wing import opened_by_entries
from workbench.work.jobs import Job

__all__ = ["install"]


@pytest.fixture
def recipe(install: Install) -> Iterator[None]:
    """The stranger's package is installed."""
    install_recipe(install)
    yield


def test_its_entry_is_in_the_menu_and_needs_a_project(recipe: None, window: MainWindow, tmp_path: Path) -> None:
    names, entry = list(window.menus.actions), window.menus.actions["wear"]
    assert names.index("wear") == names.index("script") + 1
    assert entry.text() == "&Wear …" and not entry.isEnabled() and entry.toolTip() == "Open a project first."
    window.model.create(tmp_path / "one", new_project("one"))
    QApplication.processEvents()
    assert entry.isEnabled()


def test_its_page_tells_what_its_job_has_found(recipe: None, hand_bench: Bench, qtbot: Any, tmp_path: Path) -> None:
    window = QMainWindow()
    qtbot.addWidget(window)
    hand_bench.model.create(tmp_path / "one", new_project("one"))
    cast(HandLane, hand_bench.quick).answers[Job("lab_wear:deepest")] = lambda folder: 0.25
    (opens,) = [opens for entry, opens in opened_by_entries(hand_bench, window).items() if entry.name == "wear"]
    opens()
    (page,) = [child for child in window.findChildren(QLabel) if child.isWindow()]
    qtbot.waitUntil(lambda: page.text() == "Deepest wear: 0.250 mm")
    assert page.isVisible()


def test_a_page_that_cannot_be_made_is_told_and_the_window_opens(
    install: Install, hand_bench: Bench, qtbot: Any
) -> None:
    source = (
        "from workbench.wing import MenuEntry, WindowWing\n"
        "def opened(bench, window):\n    raise OSError('no such rig')\n"
        "WINDOW_WING = WindowWing('torn', (MenuEntry('torn', 'Torn', 'lab_torn_window:opened'),))\n"
    )
    points = {"trisect.window_wings": {"torn": "lab_torn_window:WINDOW_WING"}}
    install("lab-torn", {"lab_torn_window": source}, points)
    window = QMainWindow()
    qtbot.addWidget(window)
    names = [entry.name for entry in opened_by_entries(hand_bench, window)]
    assert "torn" not in names and "plan rig" in names
    (notice,) = hand_bench.notices.all
    assert "torn of the package lab-torn 1.2 cannot be used: OSError: no such rig" in notice.text


def test_nothing_is_told_where_all_can_be_used(hand_bench: Bench, qtbot: Any) -> None:
    look_again()
    window = QMainWindow()
    qtbot.addWidget(window)
    assert opened_by_entries(hand_bench, window) and hand_bench.notices.all == []


def test_findings_of_a_wing_that_cannot_be_used_are_told(install: Install, hand_bench: Bench, qtbot: Any) -> None:
    source = "from core.wing import Wing\nWING = Wing('torn', findings='lab_torn:ROWS')\n"
    install("lab-torn", {"lab_torn": source}, {"trisect.wings": {"torn": "lab_torn:WING"}})
    window = QMainWindow()
    qtbot.addWidget(window)
    opened_by_entries(hand_bench, window)
    (notice,) = hand_bench.notices.all
    assert "torn of the package lab-torn 1.2 cannot be used: AttributeError: " in notice.text
