"""What the first start says while the compiled loops are made."""

from __future__ import annotations

from typing import Any, cast

from core.remaining import in_words
from workbench.bench import COMPILES_S
from workbench.main_window import MainWindow
from workbench.views.task_bar import StatusBar


def test_the_first_start_says_that_it_prepares_once_and_how_long_and_then_nothing(window: MainWindow) -> None:
    bar, lane = cast(StatusBar, window.statusBar()), cast(Any, window.bench.measuring)
    assert bar.currentMessage() == ""
    lane.preparing_changed.emit(True)
    assert bar.currentMessage() == f"Preparing once, about {in_words(COMPILES_S)} …"
    lane.preparing_changed.emit(False)
    assert bar.currentMessage() == ""


def test_what_was_said_since_stays(window: MainWindow) -> None:
    bar, lane = cast(StatusBar, window.statusBar()), cast(Any, window.bench.measuring)
    lane.preparing_changed.emit(True)
    window.bench.notices.info("Saved.")
    lane.preparing_changed.emit(False)
    assert bar.currentMessage() == "Saved."
