"""Tools, Plan a rig: what is foretold is shown, and written where one wants it."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from PySide6.QtWidgets import QMainWindow

from core.errors import InputError
from core.files.project.data import new_project
from core.messages import Message
from core.wings.rig_planning.rig_plan import ForetoldRig
from tests.workbench.hand_lane import HandLane
from workbench.bench import Bench
from workbench.views import ask
from workbench.wings.rig_planning import jobs
from workbench.wings.rig_planning.rig_plan import RigPlans

ROWS = [
    ("block 50\u00a0mm", "U\u00a0=\u00a00.017\u00a0mm (k\u00a0=\u00a02)"),
    ("sweeps", "58 of 60 give 40 000 points"),
]


@pytest.fixture
def plans(hand_bench: Bench, qtbot: Any) -> RigPlans:
    window = QMainWindow()
    qtbot.addWidget(window)
    made = RigPlans(hand_bench, window)
    made.setProperty("window", window)
    return made


def foretold(*_: Any, **__: Any) -> ForetoldRig:
    return ForetoldRig(ROWS, np.full((4, 6), 0.03), (1920, 1374), cast(Any, "the plan"))


def test_a_chosen_rig_is_planned_shown_and_written(
    plans: RigPlans, qtbot: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bench = plans._bench
    cast(HandLane, bench.measuring).answers[jobs.FORETELL_RIG] = foretold
    monkeypatch.setattr(ask, "choose_file_to_open", lambda *_: tmp_path / "rig.toml")
    plans.open()
    qtbot.waitUntil(lambda: plans.shown is not None)
    shown = plans.shown
    assert shown is not None and shown.isVisible() and shown.windowTitle() == "Plan of rig.toml"
    qtbot.waitUntil(lambda: [tuple(row) for row in shown.table.rows()] == ROWS)
    written: list[tuple[Any, ...]] = []
    cast(HandLane, bench.quick).answers[jobs.WRITE_RIG_PLAN] = lambda *words: written.append(words)
    monkeypatch.setattr(ask, "choose_folder", lambda *_: tmp_path / "plan")
    shown.save.click()
    qtbot.waitUntil(lambda: [(one.result, folder) for one, folder in written] == [("the plan", tmp_path / "plan")])
    qtbot.waitUntil(lambda: str(tmp_path / "plan") in bench.notices.all[-1].text)
    shown.close()
    qtbot.waitUntil(lambda: plans.shown is None)


def test_with_a_project_its_own_rig_is_planned_and_another_can_be_chosen(
    plans: RigPlans, qtbot: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bench = plans._bench
    bench.model.create(tmp_path / "block", new_project("Block"))
    asked: list[tuple[Any, ...]] = []
    lane = cast(HandLane, bench.measuring)

    def foretold_project(*what: Any) -> ForetoldRig:
        asked.append(what)
        return foretold()

    lane.answers[jobs.FORETELL_PROJECT] = foretold_project
    lane.answers[jobs.FORETELL_RIG] = foretold
    plans.open()
    qtbot.waitUntil(lambda: plans.shown is not None)
    shown = plans.shown
    assert (
        shown is not None and shown.windowTitle() == "Plan of Block" and "as they are calibrated" in shown.where.text()
    )
    qtbot.waitUntil(lambda: asked == [(tmp_path / "block", bench.model.project, "en")])
    monkeypatch.setattr(ask, "choose_file_to_open", lambda *_: tmp_path / "rig.toml")
    shown.other.click()
    qtbot.waitUntil(lambda: plans.shown is not shown)
    assert plans.shown is not None and plans.shown.windowTitle() == "Plan of rig.toml"


def test_the_window_is_there_at_once_and_closed_before_its_plan_ends_the_work(plans: RigPlans, tmp_path: Path) -> None:
    lane = cast(HandLane, plans._bench.measuring)
    lane.held = {jobs.FORETELL_RIG}
    plans.plan(tmp_path / "rig.toml")
    shown = plans.shown
    assert shown is not None and shown.isVisible() and not shown.save.isEnabled()
    assert shown.map._empty.message == "The plan is being worked out …"
    shown.close()
    assert plans.shown is None and not lane.busy


def test_a_rig_that_cannot_be_planned_is_told_and_nothing_is_shown(
    plans: RigPlans, qtbot: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def refused(*_: Any, **__: Any) -> ForetoldRig:
        raise InputError(Message("design.too_few_scans", "{scans} scans cannot be drawn", scans=0))

    cast(HandLane, plans._bench.measuring).answers[jobs.FORETELL_RIG] = refused
    plans.plan(tmp_path / "rig.toml")
    qtbot.waitUntil(lambda: bool(plans._bench.notices.all))
    assert "cannot be drawn" in plans._bench.notices.all[-1].text and plans.shown is None


def test_without_an_answer_nothing_is_planned(plans: RigPlans, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ask, "choose_file_to_open", lambda *_: None)
    plans.choose()
    assert cast(HandLane, plans._bench.measuring).ran == []
