"""Ways into and out of projects: what is asked, what is never lost, what is told."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest
from PySide6.QtWidgets import QLineEdit, QWidget

from core.errors import InputError
from core.files.project import (
    ProjectFile,
    new_project,
    read_project,
    recoverable,
    write_autosave,
    write_project,
)
from tests.workbench.hand_lane import HandLane
from workbench import jobs
from workbench.bench import Bench
from workbench.pages.project_doors import ProjectDoors
from workbench.views import ask

RIG = """
[camera_target]
kind = "checkerboard"
inner_corners = [17, 12]
square_mm = 10.0
[plane_target]
kind = "black_square"
side_mm = 60.0
[laser_fan]
lines = 3
angle_deg = 5.0
"""


class Asked:
    """Stands in for the question windows: keeps what was asked, gives the answer that begins so."""

    def __init__(self) -> None:
        self.questions: list[tuple[str, list[str]]] = []
        self.answer = ""

    def __call__(self, _parent: Any, _title: str, text: str, answers: list[str]) -> int:
        self.questions.append((text, list(answers)))
        return next(
            (n for n, one in enumerate(answers) if self.answer and one.startswith(self.answer)), len(answers) - 1
        )


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Asked:
    asked = Asked()
    monkeypatch.setattr(ask, "ask", asked)
    return asked


@pytest.fixture
def window(qtbot: Any) -> Iterator[QWidget]:
    made = QWidget()
    qtbot.addWidget(made)
    yield made


@pytest.fixture
def doors(hand_bench: Bench, window: QWidget) -> ProjectDoors:
    return ProjectDoors(hand_bench, window)


def named(name: str) -> ProjectFile:
    return ProjectFile(new_project(name))


def project(folder: Path, *names: str) -> Path:
    for name in names or ("Block",):
        write_project(folder, named(name))
    return folder


def renamed(doors: ProjectDoors, name: str) -> None:
    before = doors.model.project
    doors.model.edit("rename", replace(before, info=replace(before.info, name=name)))


def errors(doors: ProjectDoors) -> list[str]:
    return [notice.text for notice in doors.bench.notices.all if notice.level == "error"]


# ---- what is opened


@pytest.mark.parametrize("of", [lambda folder: folder, lambda folder: folder / "project.json"])
def test_a_project_opens_by_its_folder_and_by_its_file(
    doors: ProjectDoors, tmp_path: Path, of: Callable[[Path], Path]
) -> None:
    folder = project(tmp_path / "block")
    doors.open_dropped(of(folder))
    assert doors.model.folder == folder
    assert doors.model.project.info.name == "Block"
    assert not doors.model.is_modified
    assert doors.bench.settings.recent == [folder]


def test_a_path_given_relative_to_where_the_program_was_started_is_remembered_in_full(
    doors: ProjectDoors, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = project(tmp_path / "block")
    monkeypatch.chdir(folder)
    doors.open_dropped(Path("project.json"))
    assert doors.model.folder == folder
    assert doors.bench.settings.recent == [folder]


def test_a_recording_set_becomes_a_project_that_measures_it_where_it_lies(
    doors: ProjectDoors, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recordings = tmp_path / "set"
    (recordings / "camera").mkdir(parents=True)
    (recordings / "rig.toml").write_text(RIG)
    monkeypatch.setattr(ask, "ask_name_and_folder", lambda _p, _t, name, folder: (name, tmp_path / "mine"))
    doors.open_dropped(recordings / "rig.toml")
    assert doors.model.folder == tmp_path / "mine" / "set"
    assert doors.model.project.sources.camera == (recordings / "camera").as_posix()
    assert doors.bench.settings.projects_folder == tmp_path / "mine"


def test_what_is_neither_project_nor_set_is_told_and_the_open_project_stays(
    doors: ProjectDoors, tmp_path: Path
) -> None:
    doors.open_project(project(tmp_path / "block"))
    doors.open_dropped(tmp_path)
    assert "neither a project (project.json) nor a recording set (rig.toml)" in errors(doors)[0]
    assert doors.model.folder == tmp_path / "block"


def test_a_project_that_is_open_is_not_opened_again(doors: ProjectDoors, tmp_path: Path) -> None:
    folder = project(tmp_path / "block")
    doors.open_project(folder)
    renamed(doors, "Other")
    doors.open_project(folder)
    assert doors.model.undo_stack.canUndo()


def test_another_project_takes_the_place_of_the_open_one_which_is_saved(doors: ProjectDoors, tmp_path: Path) -> None:
    first, second = project(tmp_path / "first", "First"), project(tmp_path / "second", "Second")
    doors.open_project(first)
    renamed(doors, "Renamed")
    doors.open_project(second)
    assert doors.model.project.info.name == "Second"
    assert read_project(first).project.info.name == "Renamed"


def test_a_project_that_cannot_be_opened_leaves_the_open_one_alone(doors: ProjectDoors, tmp_path: Path) -> None:
    doors.open_project(project(tmp_path / "first", "First"))
    newer = tmp_path / "newer"
    newer.mkdir()
    (newer / "project.json").write_text('{"schema_version": 999}')
    doors.open_project(newer)
    assert doors.model.project.info.name == "First"
    assert "open it with a newer version of Trisect" in errors(doors)[0]


# ---- after a crash


@pytest.mark.parametrize(
    ("answer", "name"), [("Recover the changes", "Typed last"), ("Open the saved state", "Block"), ("Do not", "")]
)
def test_changes_saved_before_a_crash_are_asked_about(
    doors: ProjectDoors, asked: Asked, tmp_path: Path, answer: str, name: str
) -> None:
    folder = project(tmp_path / "block")
    write_autosave(folder, named("Typed last"))
    asked.answer = answer
    doors.open_project(folder)
    assert len(asked.questions) == 1
    assert doors.model.project.info.name == name
    assert doors.model.is_modified == (name == "Typed last")
    assert (recoverable(folder) is not None) == (name != "Block"), "gone only where the saved state was chosen"


# ---- a damaged project.json


def damaged(folder: Path) -> Path:
    project(folder, "First", "Second", "Third")
    (folder / "project.json").write_bytes(b"{ half a proj")
    return folder


def test_a_damaged_project_is_opened_from_its_newest_good_backup_in_one_question(
    doors: ProjectDoors, asked: Asked, tmp_path: Path
) -> None:
    folder = damaged(tmp_path / "block")
    asked.answer = "Backup of "
    doors.open_project(folder)
    ((text, answers),) = asked.questions
    assert "project.json cannot be read: this is no valid JSON" in text
    assert len(answers) == 2
    assert doors.model.project.info.name == "Second"
    assert doors.model.is_modified
    assert (folder / "project.json").read_bytes() == b"{ half a proj", "nothing is written before it is saved"
    assert doors.save()
    assert read_project(folder).project.info.name == "Second"


def test_the_autosave_of_a_damaged_project_is_offered_beside_the_backup(
    doors: ProjectDoors, asked: Asked, tmp_path: Path
) -> None:
    folder = damaged(tmp_path / "block")
    write_autosave(folder, named("Typed last"))
    asked.answer = "Unsaved changes of "
    doors.open_project(folder)
    ((_, answers),) = asked.questions
    assert [answer.split(" of ")[0] for answer in answers] == ["Unsaved changes", "Backup", "Do not open"]
    assert doors.model.project.info.name == "Typed last"


def test_a_damaged_project_can_be_left_closed_and_the_open_one_stays(
    doors: ProjectDoors, asked: Asked, tmp_path: Path
) -> None:
    doors.open_project(project(tmp_path / "open", "Open one"))
    doors.open_project(damaged(tmp_path / "block"))
    assert doors.model.project.info.name == "Open one"
    assert errors(doors) == []


def test_a_damaged_project_without_anything_better_is_one_sentence(
    doors: ProjectDoors, asked: Asked, tmp_path: Path
) -> None:
    (tmp_path / "project.json").write_bytes(b"nothing")
    doors.open_project(tmp_path)
    assert asked.questions == []
    assert "this is no valid JSON" in errors(doors)[0]
    assert not doors.model.is_open


def test_a_project_whose_file_is_gone_is_opened_from_its_backups(
    doors: ProjectDoors, asked: Asked, tmp_path: Path
) -> None:
    folder = damaged(tmp_path / "block")
    (folder / "project.json").unlink()
    asked.answer = "Backup of "
    doors.open_dropped(folder)
    assert doors.model.project.info.name == "Second"


def test_an_earlier_version_is_opened_by_its_file_and_saved_as_the_present_one(
    doors: ProjectDoors, tmp_path: Path
) -> None:
    folder = project(tmp_path / "block", "First", "Second")
    (backup,) = (folder / "backups").iterdir()
    doors.open_dropped(backup)
    assert doors.model.folder == folder
    assert doors.model.project.info.name == "First"
    assert doors.model.is_modified
    doors.save()
    assert read_project(folder).project.info.name == "First"


# ---- folders that cannot be written to


def read_only(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise InputError("cannot be written, because the disk is read-only", where="project.json")

    monkeypatch.setattr(os, "access", lambda *_: False)
    for name in ("write_project", "write_autosave"):
        monkeypatch.setattr(f"workbench.project_model.{name}", refuse)


def test_a_read_only_project_can_be_looked_at_and_says_so(
    doors: ProjectDoors, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = project(tmp_path / "block")
    read_only(monkeypatch)
    doors.open_project(folder)
    assert doors.model.is_open
    (notice,) = doors.bench.notices.all
    assert notice.level == "warning"
    assert "is read-only: what is changed or measured here cannot be saved" in notice.text
    ((text, answers),) = asked.questions
    assert "Go on in a copy?" in text and answers[0] == "Save a copy …"
    assert doors.close_project()
    assert len(asked.questions) == 1, "nothing was changed, nothing is lost"


def test_a_read_only_project_goes_on_in_a_copy_with_what_was_changed(
    doors: ProjectDoors, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    folder = project(tmp_path / "block")
    asked.answer = "Look at it"
    with monkeypatch.context() as patched:
        read_only(patched)
        patched.setattr(ask, "ask_name_and_folder", lambda *_: ("Mine", tmp_path / "copies"))
        doors.open_project(folder)
        renamed(doors, "Changed")
        doors.copy.save_copy()
        qtbot.waitUntil(lambda: doors.model.folder == tmp_path / "copies" / "Mine")
    assert doors.model.project.info.name == "Changed" and doors.model.is_modified
    assert doors.save() and read_project(tmp_path / "copies" / "Mine").project.info.name == "Changed"
    assert read_project(folder).project.info.name == "Block"
    assert errors(doors) == []


def test_the_offer_of_a_copy_is_taken_at_once(
    doors: ProjectDoors, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    asked.answer = "Save a copy"
    folder = project(tmp_path / "block")
    monkeypatch.setattr(os, "access", lambda path, _: not Path(path).is_relative_to(folder))
    monkeypatch.setattr(ask, "ask_name_and_folder", lambda *_: ("Mine", tmp_path))
    doors.open_project(folder)
    qtbot.waitUntil(lambda: doors.model.folder == tmp_path / "Mine")
    assert not doors.model.is_modified and len(asked.questions) == 1


def test_a_copy_of_a_project_that_can_be_saved_is_of_its_newest_state(
    doors: ProjectDoors, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    folder = project(tmp_path / "block")
    monkeypatch.setattr(ask, "ask_name_and_folder", lambda *_: ("Mine", tmp_path))
    doors.open_project(folder)
    renamed(doors, "Changed")
    doors.copy.save_copy()
    qtbot.waitUntil(lambda: doors.model.folder == tmp_path / "Mine")
    for place in (folder, tmp_path / "Mine"):
        assert read_project(place).project.info.name == "Changed"
    assert asked.questions == []


def test_a_copy_waits_for_the_end_of_a_recording(
    doors: ProjectDoors, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    doors.open_project(project(tmp_path / "block"))
    doors.bench.live.run(jobs.RUN_LIVE, None, label="live", on_done=lambda _: None)
    doors.copy.save_copy()
    assert "Stop the recording first" in errors(doors)[0]


def test_changes_that_cannot_be_saved_are_told_once_and_asked_about_before_they_are_lost(
    doors: ProjectDoors, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, told = project(tmp_path / "block"), list[str]()
    doors.model.failed.connect(told.append)
    read_only(monkeypatch)
    doors.open_project(folder)
    for name in ("A", "B"):
        renamed(doors, name)
        doors.model.autosave()
    assert len(told) == 1
    assert not doors.close_project()
    assert doors.model.project.info.name == "B"
    asked.answer = "Leave without saving"
    assert doors.close_project()


def test_a_project_that_cannot_be_made_is_not_open(
    doors: ProjectDoors, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setattr(ask, "ask_name_and_folder", lambda *_: ("Block", tmp_path / "file"))
    doors.new_project()
    assert not doors.model.is_open
    assert len(errors(doors)) == 1


# ---- leaving


def test_leaving_while_something_is_measured_asks_and_then_stops_it(
    doors: ProjectDoors, asked: Asked, tmp_path: Path
) -> None:
    measuring = cast(HandLane, doors.bench.measuring)
    measuring.held = {jobs.MEASURE_SCAN}
    doors.open_project(project(tmp_path / "block"))
    ended: list[str] = []
    doors.bench.measure(
        jobs.MEASURE_SCAN, label="Scan", on_done=ended.append, on_cancelled=lambda: ended.append("cancelled")
    )
    assert not doors.close_project()
    assert "A job is not finished yet: Scan." in asked.questions[0][0]
    asked.answer = "Stop and leave"
    assert doors.close_project()
    assert ended == ["cancelled"]
    assert not measuring.busy


def test_what_is_being_typed_is_saved_too(doors: ProjectDoors, window: QWidget, tmp_path: Path, qtbot: Any) -> None:
    doors.open_project(project(tmp_path / "block"))
    editor = QLineEdit(window)
    editor.editingFinished.connect(lambda: renamed(doors, editor.text()))
    with qtbot.waitExposed(window):
        window.show()
    window.activateWindow()
    editor.setFocus()
    qtbot.waitUntil(editor.hasFocus)
    qtbot.keyClicks(editor, "Typed last")
    doors.save()
    assert read_project(tmp_path / "block").project.info.name == "Typed last"
    assert editor.hasFocus()
    window.hide()


# ---- the sample and the simulated rig


def made_sample(folder: Path) -> Path:
    return project(folder, "Sample")


def test_the_sample_is_made_once_and_opened_when_it_is_ready(doors: ProjectDoors, qtbot: Any) -> None:
    measuring = cast(HandLane, doors.bench.measuring)
    measuring.answers[jobs.SAMPLE_PROJECT] = made_sample
    doors.open_sample()
    assert doors.sample.preparing
    doors.open_sample()
    qtbot.waitUntil(lambda: doors.model.is_open)
    assert measuring.ran == [jobs.SAMPLE_PROJECT], "a second click makes no second sample"
    assert "is being prepared" in doors.bench.notices.all[0].text
    doors.close_project()
    doors.open_sample()
    assert doors.model.project.info.name == "Sample"
    assert measuring.ran == [jobs.SAMPLE_PROJECT]


def test_a_project_opened_meanwhile_is_not_taken_away_by_the_sample(
    doors: ProjectDoors, tmp_path: Path, qtbot: Any
) -> None:
    measuring = cast(HandLane, doors.bench.measuring)
    measuring.held = {jobs.SAMPLE_PROJECT}
    doors.open_sample()
    doors.open_project(project(tmp_path / "block"))
    measuring.finish(made_sample(doors.bench.settings.projects_folder / "Sample"))
    assert doors.model.project.info.name == "Block"
    assert doors.bench.notices.all[-1].text == "The sample is ready: File, Open sample."


def test_a_cancelled_sample_leaves_nothing_and_can_be_asked_for_again(doors: ProjectDoors, qtbot: Any) -> None:
    measuring, quick = cast(HandLane, doors.bench.measuring), cast(HandLane, doors.bench.quick)
    measuring.held = {jobs.SAMPLE_PROJECT}
    base = doors.bench.settings.projects_folder
    doors.open_sample()
    (base / ".Sample.xyz" / "project").mkdir(parents=True)
    measuring.cancel_all()
    qtbot.waitUntil(lambda: not quick.busy)
    assert list(base.iterdir()) == []
    preparing = [doors.sample.preparing]
    doors.open_sample()
    assert [*preparing, doors.sample.preparing] == [False, True]


def test_a_folder_that_is_in_the_samples_way_is_left_alone(doors: ProjectDoors, qtbot: Any) -> None:
    base = doors.bench.settings.projects_folder
    (base / "Sample").mkdir(parents=True)
    cast(HandLane, doors.bench.measuring).answers[jobs.SAMPLE_PROJECT] = made_sample
    doors.open_sample()
    qtbot.waitUntil(lambda: doors.model.is_open)
    assert doors.model.folder == base / "Sample 2"
    assert list((base / "Sample").iterdir()) == []


def test_trying_the_simulated_rig_makes_a_project_of_its_own_each_time(doors: ProjectDoors) -> None:
    shown: list[str] = []
    doors.go_to.connect(shown.append)
    doors.try_simulated()
    first = doors.model.folder
    doors.try_simulated()
    assert first is not None
    assert doors.model.folder == first.parent / "Simulated rig 2"
    assert shown == ["camera", "camera"]
