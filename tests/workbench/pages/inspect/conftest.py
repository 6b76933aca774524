"""The lanes of a bench without processes, and the Inspect page as a window."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import cast

import pytest
from pytestqt.qtbot import QtBot

from tests.workbench.hand_lane import HandLane
from tests.workbench.pages import inspect_cases as cases
from workbench.bench import Bench
from workbench.pages.inspect.page import InspectPage
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.work import jobs


@pytest.fixture
def measuring(hand_bench: Bench) -> HandLane:
    """The lane of long jobs."""
    return cast(HandLane, hand_bench.measuring)


@pytest.fixture
def quick(hand_bench: Bench) -> HandLane:
    """The lane of short jobs; whatever scan is to be shown has its thickness."""
    lane = cast(HandLane, hand_bench.quick)
    lane.answers[jobs.INSPECTION_VIEW] = lambda folder, project: cases.view(cases.gauge())
    return lane


@pytest.fixture
def show_page(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., InspectPage]]:
    """Shows the page of a presenter, without OpenGL; it is closed after the test."""
    monkeypatch.setenv("TRISECT_NO_OPENGL", "none")

    with ExitStack() as at_end:

        def show(presenter: InspectPresenter, width: int = 1280, height: int = 800) -> InspectPage:
            made = InspectPage(presenter)
            qtbot.addWidget(made)
            made.resize(width, height)
            made.show()
            at_end.callback(made.close)
            return made

        yield show
