"""With each wing taken away the window opens, without the entries of its menus."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from core.door import WITHOUT
from tests.code import ROOT
from tests.wings.strangers import look_again
from workbench.main_window import MainWindow
from workbench.wing import window_wings

OURS = tuple(sorted(path.parent.name for path in ROOT.glob("workbench/wings/*/wing.py")))


@pytest.fixture(params=OURS)
def taken_away(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[set[str]]:
    """The entries of a wing that is taken away."""
    entries = {entry.name for wing in window_wings() if wing.name == request.param for entry in wing.entries}
    monkeypatch.setenv(WITHOUT, str(request.param))
    look_again()
    yield entries
    monkeypatch.undo()
    look_again()


def test_every_folder_of_a_wing_is_found() -> None:
    assert tuple(sorted(wing.name for wing in window_wings())) == OURS


def test_the_window_opens_without_it(taken_away: set[str], window: MainWindow) -> None:
    assert taken_away and not taken_away & window.menus.actions.keys()
    assert "many sets" in window.menus.actions and window.bench.notices.all == []


def test_with_it_its_entries_stand_where_it_says(window: MainWindow) -> None:
    names = list(window.menus.actions)
    assert names.index("plan rig") == names.index("console") + 1
