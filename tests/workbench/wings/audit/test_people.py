"""People of a project in the window: who signs in, what each may change, for which reason."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtWidgets import QWidget

from core.errors import InputError
from core.files.project.data import Project
from core.files.project.folder import write_autosave
from core.files.project.keys import finished
from core.files.recording.rig import GaugeSpec
from core.wings.audit.people import Rules, person, write_rules
from core.wings.audit.trail import read_trail
from tests.workbench.pages.project.test_actions import project, projects
from tests.workbench.pages.project.test_next_part import asked, first_part
from workbench.bench import Bench
from workbench.main_window import MainWindow
from workbench.pages.project.actions import ProjectActions
from workbench.project_model import ProjectModel
from workbench.views import ask
from workbench.wing import guard_project
from workbench.wings.audit import pin
from workbench.wings.audit.people import PeopleGuard, guard_of

__all__ = ["asked", "projects"]


@pytest.fixture
def model(hand_bench: Bench, tmp_path: Path) -> Iterator[ProjectModel]:
    hand_bench.settings.projects_folder = tmp_path
    hand_bench.model.open(project(tmp_path / "block"))
    yield hand_bench.model
    hand_bench.model.close()


@pytest.fixture
def guard(hand_bench: Bench, model: ProjectModel) -> PeopleGuard:
    made = PeopleGuard(hand_bench)
    model.guard = made
    return made


def renamed(project: Project, name: str) -> Project:
    return replace(project, info=replace(project.info, name=name))


def test_whoever_has_signed_in_stays_so(
    guard: PeopleGuard, projects: ProjectActions, asked: list[tuple[str, str]], qtbot: Any, tmp_path: Path
) -> None:
    first_part(tmp_path / "Block 1")
    people = (person("Ada", "administrator", "1234"), person("Bo", "operator", "5678"))
    write_rules(tmp_path / "Block 1", Rules(people))
    projects.open_project(tmp_path / "Block 1")
    guard.sign_in("Bo", "5678")
    with qtbot.waitSignal(projects.go_to):
        projects.begin_next_part()
    assert asked == [("Block", "Bo")]
    assert guard.signed_in == people[1] and guard.rules.people == people


def test_where_people_have_roles_an_inspectors_pin_leads_out(
    window: MainWindow, measured_project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    people = (person("Ada", "administrator", "1234"), person("Bo", "operator", "5678"))
    write_rules(measured_project, Rules(people))
    window.model.open(measured_project)
    window.enter_operator_mode()
    answers: list[tuple[str, str] | None] = [None, ("Ada", "0000"), ("Bo", "5678"), ("Ada", "1234")]
    monkeypatch.setattr(pin, "ask_name_and_pin", lambda *_: answers.pop(0))
    for said in ("", "do not belong together", "inspector or administrator"):
        window.operator.leaving.click()
        assert window.operator_mode.on and window.operator.isVisible()
        assert said in window.operator.banner.text()
    window.operator.leaving.click()
    assert not window.operator_mode.on


def test_whoever_may_not_change_something_is_told_and_nothing_changes_until_somebody_signs_in_who_may(
    guard: PeopleGuard, model: ProjectModel, tmp_path: Path
) -> None:
    folder = tmp_path / "block"
    write_rules(folder, Rules((person("Anna", "administrator", "anna-1"), person("Ole", "operator", "0000"))))
    model.open(folder)
    told: list[InputError] = []
    shown: list[Project] = []
    model.failed.connect(told.append)
    model.changed.connect(lambda before, after: shown.append(after))
    before = model.project
    wanted = with_nominal(before, 50.0)
    model.edit("change nominal", wanted)
    assert (model.project, shown) == (before, [before])
    assert "only an administrator may change this; sign in" in str(told[0])
    with pytest.raises(InputError):
        guard.sign_in("Anna", "0000")
    guard.sign_in("Anna", "anna-1")
    model.edit("change nominal", wanted)
    model.save()
    assert model.project == wanted
    last = read_trail(folder).entries[-1]
    assert (last.what, last.by, last.role) == ("saved", "Anna", "administrator")
    guard.sign_out()
    assert not model.undo_stack.canUndo()
    model.edit("rename", renamed(model.project, "Other"))
    assert model.project.info.name == "Other"


def test_the_reason_for_limits_changed_after_a_result_is_in_the_trail_at_once_and_without_one_nothing_changes(
    guard: PeopleGuard, model: ProjectModel, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "block"
    write_rules(folder, Rules(reasons=True))
    model.open(folder)
    asked: list[str] = []
    answers = ["", "as the customer wished"]

    def answer(_parent: Any, _title: str, text: str) -> str:
        asked.append(text)
        return answers[len(asked) - 1]

    monkeypatch.setattr(ask, "ask_line", answer)
    model.edit("first nominal", with_nominal(model.project, 50.0))
    model.record("gauge", finished("gauge", model.project, model.results))
    model.edit("other nominal", with_nominal(model.project, 51.0))
    assert model.project.rig.gauge == GaugeSpec(50.0, 0.1)
    model.edit("other nominal", with_nominal(model.project, 51.0))
    assert ["(other nominal)" in text for text in asked] == [True, True]
    last = read_trail(folder).entries[-1]
    assert (last.why, [change.field for change in last.changes]) == ("as the customer wished", ["rig.gauge.nominal_mm"])


def with_nominal(project: Project, nominal: float) -> Project:
    return replace(project, rig=replace(project.rig, gauge=GaugeSpec(nominal, 0.1)))


def test_a_window_of_another_language_keeps_who_has_signed_in(window: MainWindow, tmp_path: Path) -> None:
    folder = project(tmp_path / "block")
    write_rules(folder, Rules((person("Anna", "administrator", "anna-1"),)))
    window.model.open(folder)
    guard = window.model.guard
    assert isinstance(guard, PeopleGuard)
    guard.sign_in("Anna", "anna-1")
    other = QWidget()
    assert guard_of(window.bench, other) is guard and guard.window is other
    assert guard.signed_in is not None and guard.signed_in.name == "Anna"
    guard.window = window


def test_people_of_a_project_that_is_open_already_hold_at_once(hand_bench: Bench, tmp_path: Path) -> None:
    folder = project(tmp_path / "block")
    write_rules(folder, Rules((person("Anna", "administrator", "anna-1"),)))
    hand_bench.model.open(folder)
    assert PeopleGuard(hand_bench).names == ["Anna"]


def test_a_damaged_list_of_people_keeps_a_project_closed_and_the_open_one_in_force(
    guard: PeopleGuard, model: ProjectModel, tmp_path: Path
) -> None:
    write_rules(tmp_path / "block", Rules((person("Anna", "administrator", "anna-1"),)))
    model.open(tmp_path / "block")
    other = project(tmp_path / "other")
    (other / "people.json").write_text("{")
    with pytest.raises(InputError, match=r"people\.json"):
        model.open(other)
    assert model.folder == tmp_path / "block" and guard.names == ["Anna"]


def test_signing_in_means_something_with_a_project_and_out_of_operator_mode(window: MainWindow, tmp_path: Path) -> None:
    entries = window.menus.actions
    names = list(entries)
    assert names[names.index("export") + 1 :][:3] == ["audit", "sign in", "close"]
    assert entries["sign in"].toolTip() == "Open a project first."
    window.model.open(project(tmp_path / "block"))
    window._refreshing.at_once()
    assert entries["sign in"].isEnabled()
    window.enter_operator_mode()
    assert entries["sign in"].toolTip() == "Leave operator mode first."
    window.operator_mode.turn(False)


def test_a_guard_that_cannot_be_made_is_told(
    hand_bench: Bench, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("workbench.wings.audit.people.guard_of", lambda *_: None)
    guard_project(hand_bench, window)
    (notice,) = hand_bench.notices.all
    assert notice.text.endswith("what it makes is no EditGuard.")


def test_recovered_changes_that_nobody_may_save_do_not_keep_a_person_from_signing_in(
    guard: PeopleGuard, projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, model = tmp_path / "block", projects.model
    write_rules(folder, Rules((person("Anna", "administrator", "anna-1"),)))
    write_autosave(folder, replace(model.file, project=with_nominal(model.project, 50.0)))
    model.open(folder, recover=True)
    assert not projects.save()
    monkeypatch.setattr(pin, "ask_name_and_pin", lambda *_: ("Anna", "anna-1"))
    guard.sign_in_or_out(projects.save)
    assert projects.save() and read_trail(folder).entries[-1].by == "Anna"
