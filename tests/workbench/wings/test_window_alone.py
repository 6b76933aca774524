"""With each wing taken away the window opens, without the entries of its menus."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtWidgets import QMainWindow
from pytestqt.qtbot import QtBot

from core.door import WITHOUT
from core.files.project.data import KeptStudy, new_project
from core.messages import plain
from tests.code import ROOT
from tests.wings.strangers import look_again
from tests.workbench.tabs import tab_titles
from workbench.bench import Bench
from workbench.main_window import MainWindow
from workbench.pages.report.presenter import ReportPresenter
from workbench.wing import WindowWing, opened_by_entries, window_wings

OURS = tuple(sorted(path.parent.name for path in ROOT.glob("workbench/wings/*/wing.py")))


@pytest.fixture(params=OURS)
def taken_away(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[WindowWing]:
    """A wing that is taken away."""
    (taken,) = (wing for wing in window_wings() if wing.name == request.param)
    monkeypatch.setenv(WITHOUT, taken.name)
    look_again()
    yield taken
    monkeypatch.undo()
    look_again()


def test_every_folder_of_a_wing_is_found() -> None:
    assert tuple(sorted(wing.name for wing in window_wings())) == OURS


def test_the_window_opens_without_it(taken_away: WindowWing, window: MainWindow) -> None:
    page: Any = window.pages["inspect"]
    entries = {one.name for one in taken_away.entries}
    assert entries or taken_away.tabs or taken_away.layers or taken_away.below_repeats
    assert not entries & window.menus.actions.keys()
    assert page.tabs.count() == 4 + sum(len(wing.tabs) for wing in window_wings())
    assert not {one.title for one in taken_away.tabs} & {*tab_titles(page.tabs)}
    layers = [one.name for wing in window_wings() for one in wing.layers]
    colours = page.surface.choices.colours
    assert list(page.layers) == list(page.layer_folds) == layers
    assert [f"layer {name}" for name in layers] == [
        name for n in range(colours.count()) if (name := colours.itemData(n)).startswith("layer ")
    ]
    assert len(page.series.parts) == sum(bool(wing.below_repeats) for wing in window_wings())
    assert "many sets" in window.menus.actions and window.bench.notices.all == []


def test_without_the_wing_of_studies_no_tab_of_it_is_named(
    monkeypatch: pytest.MonkeyPatch, hand_bench: Bench, tmp_path: Path
) -> None:
    kept = KeptStudy("ab", "grr", plain("3 parts"))
    hand_bench.model.create(tmp_path / "one", replace(new_project("one"), studies=(kept,)))
    presenter = ReportPresenter(hand_bench)
    assert presenter.empty_section("studies") == ""
    monkeypatch.setenv(WITHOUT, "studies")
    look_again()
    told = presenter.empty_section("studies")
    monkeypatch.undo()
    look_again()
    why = "Studies are read by the wing studies, which is not there; take it out of TRISECT_WITHOUT_WINGS."
    assert told == why, "ticked or not"


def test_with_it_its_entries_stand_where_it_says(window: MainWindow) -> None:
    names = list(window.menus.actions)
    assert names.index("plan rig") == names.index("console") + 1


def test_a_name_of_no_wing_is_told_in_the_window(
    monkeypatch: pytest.MonkeyPatch, hand_bench: Bench, qtbot: QtBot
) -> None:
    monkeypatch.setenv(WITHOUT, "rig_planing")
    window = QMainWindow()
    qtbot.addWidget(window)
    opened_by_entries(hand_bench, window)
    (notice,) = hand_bench.notices.all
    assert (
        notice.text
        == "TRISECT_WITHOUT_WINGS names rig_planing, but the wings are audit, geometry, rig_planning and studies."
    )
