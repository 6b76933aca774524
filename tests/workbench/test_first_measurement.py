"""The first measurement leads from the pictures to the report, waits for each step, and can be left at any time."""

from __future__ import annotations

from itertools import chain, combinations, product
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication

from core.files.project.data import Project, new_project
from core.files.project.folder import project_from_set
from core.messages import NO_BREAK_SPACE
from tests.workbench.technician import Technician
from workbench import first_measurement as first
from workbench.first_measurement import Facts, instruction
from workbench.main_window import MainWindow
from workbench.step_state import ORDER, State
from workbench.views.instruction_bar import InstructionBar
from workbench.work import jobs
from workbench.work.jobs import Job

SOLVED = [frozenset(some) for some in chain.from_iterable(combinations(("camera", "planes"), n) for n in range(3))]


def every_fact() -> list[Facts]:
    return [
        Facts(page, {"project": State.DONE, **dict(zip(ORDER[1:], states, strict=True))}, solved, running)
        for page in ORDER
        for states in product((State.READY, State.DONE, State.OUTDATED), repeat=5)
        for solved in SOLVED
        for running in (False, True)
    ]


def test_an_instruction_is_never_for_what_is_done_nor_for_what_needs_something_before() -> None:
    for facts in every_fact():
        now = instruction(facts)
        if now is first.PROJECT:
            assert facts.page == "project" and not facts.solved
            assert State.DONE not in [facts.states[step] for step in ("camera", "planes", "scan")]
            continue
        before = ORDER[1 : ORDER.index(now.page)]
        assert all(facts.states[step] is State.DONE for step in before), facts
        assert (facts.states[now.page] is State.DONE) == (now is first.FINISHED), facts
        if now.button == "accept":
            assert now.page in facts.solved


def test_each_instruction_comes_and_they_come_in_their_order() -> None:
    nothing = dict.fromkeys(ORDER, State.READY)
    done = [nothing | dict.fromkeys(ORDER[: n + 1], State.DONE) for n in range(6)]
    way = [
        Facts("project", nothing, frozenset(), running=False),
        Facts("camera", nothing, frozenset(), running=False),
        Facts("camera", nothing, frozenset({"camera"}), running=False),
        Facts("camera", done[1], frozenset(), running=False),
        Facts("planes", done[1], frozenset({"planes"}), running=False),
        Facts("planes", done[2], frozenset(), running=False),
        Facts("scan", done[3], frozenset(), running=False),
        Facts("inspect", done[4], frozenset(), running=False),
        Facts("report", done[5], frozenset(), running=False),
    ]
    assert [instruction(facts) for facts in way] == list(first.ORDER)
    without_fan = [facts._replace(has_fan=False, states={**facts.states, "planes": State.NOT_NEEDED}) for facts in way]
    assert list(dict.fromkeys(instruction(facts) for facts in without_fan)) == list(first.ORDERS[False])


def words_of(bar: InstructionBar) -> str:
    """What it says; a number and its unit are kept on one line by another space than a text has."""
    return bar.words.text().replace(NO_BREAK_SPACE, " ")


@pytest.fixture
def begun(window: MainWindow, monkeypatch: pytest.MonkeyPatch, qtbot: Any) -> MainWindow:
    """A first measurement of a project without pictures."""
    monkeypatch.setattr(jobs, "SAMPLE_TO_MEASURE", Job("tests.workbench.lane_jobs:project_to_measure"))
    window.menus.actions["first measurement"].trigger()
    qtbot.waitUntil(lambda: not window.instructions.isHidden(), timeout=20_000)
    return window


def test_it_begins_in_a_project_of_its_own_and_says_what_to_do(begun: MainWindow) -> None:
    bar = begun.instructions
    assert begun.model.folder is not None and begun.model.folder.name == "First measurement"
    assert not bar.isHidden() and words_of(bar) == first.PROJECT.text
    begun.go_to("camera")
    QApplication.processEvents()
    assert words_of(bar) == first.SOLVE_CAMERA.text


@pytest.mark.parametrize(("of", "what"), [("work", "solving"), ("acceptance", "keeping")])
def test_while_a_calibration_is_solved_or_kept_nothing_is_to_be_pressed(begun: MainWindow, of: str, what: str) -> None:
    camera: Any = begun.presenters["camera"]
    begun.go_to("camera")
    for working, said in ((True, first.WAIT), (False, first.SOLVE_CAMERA.text)):
        setattr(getattr(camera, of), what, working)
        camera.changed.emit()
        QApplication.processEvents()
        assert words_of(begun.instructions) == said
        assert begun.instructions.show_button.isHidden() == working


def test_going_back_or_elsewhere_is_no_mistake(begun: MainWindow) -> None:
    begun.go_to("report")
    QApplication.processEvents()
    assert words_of(begun.instructions) == first.SOLVE_CAMERA.text
    begun.instructions.show_button.click()
    assert begun.current == "camera"


def test_it_can_be_left_and_what_was_done_stays(begun: MainWindow) -> None:
    folder = begun.model.folder
    begun.instructions.leave_button.click()
    begun.go_to("camera")
    QApplication.processEvents()
    assert begun.instructions.isHidden() and begun.model.folder == folder


def test_another_project_is_not_led_through(begun: MainWindow, tmp_path: Path) -> None:
    begun.model.create(tmp_path / "other", new_project("Other"))
    QApplication.processEvents()
    assert begun.instructions.isHidden()


@pytest.mark.accuracy
def test_whoever_does_only_what_it_says_ends_with_a_report(
    technician: Technician, simulated: Path, tmp_path: Path
) -> None:
    t, window = technician, technician.window
    bar = window.instructions

    def of_the_set(_: str) -> Project:
        return project_from_set(simulated, "First measurement")

    window.projects._create(
        tmp_path / "first", of_the_set, "First measurement", then=window.projects.first_measurement_begun.emit
    )
    told: list[str] = []
    while True:
        t.idle()
        QApplication.processEvents()
        t.until(lambda: words_of(bar) != first.WAIT, "an instruction")
        if words_of(bar) == first.FINISHED.text:
            break
        assert words_of(bar) not in told, f"said twice: {words_of(bar)}"
        told.append(words_of(bar))
        t.press(bar.show_button)
        pressed = window.focusWidget()
        assert pressed is not None and pressed.isEnabled(), words_of(bar)
        t._qtbot.keyClick(pressed, Qt.Key.Key_Space)
        t.until(lambda: words_of(bar) != told[-1], f"what comes after: {told[-1]}")
    assert "report" in t.model.results
    assert t.errors() == []
    assert told[0] == first.PROJECT.text and told[-1] == first.REPORT.text
