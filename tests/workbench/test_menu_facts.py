"""Every state of the menus: which entries can be chosen follows from plain facts."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication

from core.files.project.data import new_project
from workbench.main_window import MainWindow
from workbench.menus import NEED_A_PROJECT, OF_A_PAGE, OPERATOR_MAY, MenuFacts, why_not
from workbench.step_state import ORDER
from workbench.work import jobs
from workbench.work.tasks import Task

ENTRIES = ("new", "open", "import", "undo", "messages", "manual", "cancel", *NEED_A_PROJECT, "step scan")
STATES = [
    MenuFacts(page, frozenset(does), job=job)
    for page, does, job in product(("", *ORDER), ((), ("run",), OF_A_PAGE), (False, True))
    if page or not does
]


def test_what_can_be_chosen_in_every_state() -> None:
    for facts, name in product(STATES, ENTRIES):
        why, known = why_not(name, facts), (name, facts)
        if name == "cancel":
            assert bool(why) != facts.job, known
        elif name not in NEED_A_PROJECT and name != "step scan":
            assert not why, known
        elif not facts.page:
            assert why == "Open a project first.", known
        elif name in OF_A_PAGE:
            assert bool(why) != (name in facts.does), known
        else:
            end = {"back": ORDER[0], "next": ORDER[-1]}.get(name)
            assert bool(why) == (facts.page == end), known


def test_an_operator_has_what_changes_nothing() -> None:
    for facts, name in product(STATES, (*ENTRIES, "full")):
        why = why_not(name, facts._replace(operator=True))
        assert why == (why_not(name, facts) if name in OPERATOR_MAY else "Leave operator mode first."), (facts, name)


def test_on_every_page_the_entries_do_something_or_say_why_not(window: MainWindow, tmp_path: Path) -> None:
    entries = window.menus.actions
    window.model.create(tmp_path / "one", new_project("one"))
    assert not entries["cancel"].isEnabled() and entries["cancel"].toolTip() == "No job is running."
    for page in ORDER:
        window.go_to(page)
        for name in OF_A_PAGE:
            assert entries[name].isEnabled() == hasattr(window.presenters[page], f"do_{name}"), (page, name)
        for button, name in ((window.back, "back"), (window.next, "next")):
            assert not button.isEnabled() or entries[name].isEnabled(), (page, name)
            if not entries[name].isEnabled():
                assert button.toolTip() == entries[name].toolTip(), (page, name)


def test_the_menus_are_refreshed_once_as_a_job_starts_and_once_as_it_ends(
    window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    window.model.create(tmp_path / "one", new_project("one"))
    QApplication.processEvents()
    seen: list[bool] = []
    refresh, lane = window.menus.refresh, window.bench.measuring

    def counted(facts: MenuFacts) -> None:
        seen.append(facts.job)
        refresh(facts)

    monkeypatch.setattr(window.menus, "refresh", counted)
    task = Task(lane, window, 0, jobs.SAMPLE_PROJECT, "a job")
    lane.task_started.emit(task)
    QApplication.processEvents()
    assert (seen, window.menus.actions["cancel"].isEnabled()) == ([True], True)
    lane.task_ended.emit(task)
    QApplication.processEvents()
    assert (seen, window.menus.actions["cancel"].isEnabled()) == ([True, False], False)
