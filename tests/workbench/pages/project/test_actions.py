"""Ways into and out of projects: what is asked, what is never lost, what is told."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from PySide6.QtWidgets import QLineEdit, QWidget

from core.errors import InputError
from core.files.pictures import write_picture
from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project, read_project, recoverable, write_autosave
from core.files.project.keys import finished
from core.files.project.lock import take_lock
from core.files.recording.unfinished import note_recording
from tests.workbench.hand_lane import HandLane
from workbench.bench import Bench
from workbench.pages.live.settings import LiveSettings
from workbench.pages.project.actions import ProjectActions
from workbench.views import ask
from workbench.work import jobs

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

    def __call__(self, _parent: Any, _title: str, text: str, answers: list[str], **_: Any) -> int:
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
def projects(hand_bench: Bench, window: QWidget) -> ProjectActions:
    return ProjectActions(hand_bench, window)


def named(name: str) -> ProjectFile:
    return ProjectFile(new_project(name))


def project(folder: Path, *names: str) -> Path:
    for name in names or ("Block",):
        create_project(folder, named(name))
    return folder


def renamed(projects: ProjectActions, name: str) -> None:
    before = projects.model.project
    projects.model.edit("rename", replace(before, info=replace(before.info, name=name)))


def errors(projects: ProjectActions) -> list[str]:
    return [notice.text for notice in projects.bench.notices.all if notice.level == "error"]


# ---- what is opened


@pytest.mark.parametrize("of", [lambda folder: folder, lambda folder: folder / "project.json"])
def test_a_project_opens_by_its_folder_and_by_its_file(
    projects: ProjectActions, tmp_path: Path, of: Callable[[Path], Path]
) -> None:
    folder = project(tmp_path / "block")
    projects.open_dropped(of(folder))
    assert projects.model.folder == folder
    assert projects.model.project.info.name == "Block"
    assert not projects.model.is_modified
    assert projects.bench.settings.recent == [folder]


def test_a_path_given_relative_to_where_the_program_was_started_is_remembered_in_full(
    projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = project(tmp_path / "block")
    monkeypatch.chdir(folder)
    projects.open_dropped(Path("project.json"))
    assert projects.model.folder == folder
    assert projects.bench.settings.recent == [folder]


def test_a_recording_set_becomes_a_project_that_measures_it_where_it_lies(
    projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recordings = tmp_path / "set"
    (recordings / "camera").mkdir(parents=True)
    (recordings / "rig.toml").write_text(RIG)
    monkeypatch.setattr(ask, "ask_name_and_folder", lambda _p, _t, name, folder: (name, tmp_path / "mine"))
    projects.open_dropped(recordings / "rig.toml")
    assert projects.model.folder == tmp_path / "mine" / "set"
    assert projects.model.project.sources.camera == (recordings / "camera").as_posix()
    assert projects.bench.settings.projects_folder == tmp_path / "mine"


def test_what_is_neither_project_nor_set_is_told_and_the_open_project_stays(
    projects: ProjectActions, tmp_path: Path
) -> None:
    projects.open_project(project(tmp_path / "block"))
    projects.open_dropped(tmp_path)
    assert "neither a project (project.json) nor a recording set (rig.toml)" in errors(projects)[0]
    assert projects.model.folder == tmp_path / "block"


def test_a_project_that_is_open_is_not_opened_again(projects: ProjectActions, tmp_path: Path) -> None:
    folder = project(tmp_path / "block")
    projects.open_project(folder)
    renamed(projects, "Other")
    projects.open_project(folder)
    assert projects.model.undo_stack.canUndo()


def test_another_project_takes_the_place_of_the_open_one_which_is_saved(
    projects: ProjectActions, tmp_path: Path
) -> None:
    first, second = project(tmp_path / "first", "First"), project(tmp_path / "second", "Second")
    projects.open_project(first)
    renamed(projects, "Renamed")
    projects.open_project(second)
    assert projects.model.project.info.name == "Second"
    assert read_project(first).project.info.name == "Renamed"


def test_a_project_that_cannot_be_opened_leaves_the_open_one_alone(projects: ProjectActions, tmp_path: Path) -> None:
    projects.open_project(project(tmp_path / "first", "First"))
    newer = tmp_path / "newer"
    newer.mkdir()
    (newer / "project.json").write_text('{"schema_version": 999}')
    projects.open_project(newer)
    assert projects.model.project.info.name == "First"
    assert "open it with a newer version of Trisect" in errors(projects)[0]


# ---- after a crash


@pytest.mark.parametrize(
    ("answer", "name"), [("Recover the changes", "Typed last"), ("Open the saved state", "Block"), ("Do not", "")]
)
def test_changes_saved_before_a_crash_are_asked_about(
    projects: ProjectActions, asked: Asked, tmp_path: Path, answer: str, name: str
) -> None:
    folder = project(tmp_path / "block")
    write_autosave(folder, named("Typed last"))
    asked.answer = answer
    projects.open_project(folder)
    assert len(asked.questions) == 1
    assert projects.model.project.info.name == name
    assert projects.model.is_modified == (name == "Typed last")
    assert (recoverable(folder) is not None) == (name != "Block"), "gone only where the saved state was chosen"


# ---- a damaged project.json


def damaged(folder: Path) -> Path:
    project(folder, "First", "Second", "Third")
    (folder / "project.json").write_bytes(b"{ half a proj")
    return folder


def test_a_damaged_project_is_opened_from_its_newest_good_backup_in_one_question(
    projects: ProjectActions, asked: Asked, tmp_path: Path
) -> None:
    folder = damaged(tmp_path / "block")
    asked.answer = "Backup of "
    projects.open_project(folder)
    ((text, answers),) = asked.questions
    assert "project.json cannot be read: this is no valid JSON" in text
    assert len(answers) == 2
    assert projects.model.project.info.name == "Second"
    assert projects.model.is_modified
    assert (folder / "project.json").read_bytes() == b"{ half a proj", "nothing is written before it is saved"
    assert projects.save()
    assert read_project(folder).project.info.name == "Second"


def test_the_autosave_of_a_damaged_project_is_offered_beside_the_backup(
    projects: ProjectActions, asked: Asked, tmp_path: Path
) -> None:
    folder = damaged(tmp_path / "block")
    write_autosave(folder, named("Typed last"))
    asked.answer = "Unsaved changes of "
    projects.open_project(folder)
    ((_, answers),) = asked.questions
    assert [answer.split(" of ")[0] for answer in answers] == ["Unsaved changes", "Backup", "Do not open"]
    assert projects.model.project.info.name == "Typed last"


def test_a_damaged_project_can_be_left_closed_and_the_open_one_stays(
    projects: ProjectActions, asked: Asked, tmp_path: Path
) -> None:
    projects.open_project(project(tmp_path / "open", "Open one"))
    projects.open_project(damaged(tmp_path / "block"))
    assert projects.model.project.info.name == "Open one"
    assert errors(projects) == []


def test_a_damaged_project_without_anything_better_is_one_sentence(
    projects: ProjectActions, asked: Asked, tmp_path: Path
) -> None:
    (tmp_path / "project.json").write_bytes(b"nothing")
    projects.open_project(tmp_path)
    assert asked.questions == []
    assert "this is no valid JSON" in errors(projects)[0]
    assert not projects.model.is_open


def test_a_project_whose_file_is_gone_is_opened_from_its_backups(
    projects: ProjectActions, asked: Asked, tmp_path: Path
) -> None:
    folder = damaged(tmp_path / "block")
    (folder / "project.json").unlink()
    asked.answer = "Backup of "
    projects.open_dropped(folder)
    assert projects.model.project.info.name == "Second"


def test_an_earlier_version_is_opened_by_its_file_and_saved_as_the_present_one(
    projects: ProjectActions, tmp_path: Path
) -> None:
    folder = project(tmp_path / "block", "First", "Second")
    (backup,) = (folder / "backups").iterdir()
    projects.open_dropped(backup)
    assert projects.model.folder == folder
    assert projects.model.project.info.name == "First"
    assert projects.model.is_modified
    projects.save()
    assert read_project(folder).project.info.name == "First"


# ---- folders that cannot be written to


def read_only(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise InputError("cannot be written, because the disk is read-only", where="project.json")

    monkeypatch.setattr(os, "access", lambda *_: False)
    for name in ("write_project", "write_autosave"):
        monkeypatch.setattr(f"workbench.project_model.{name}", refuse)


def test_a_read_only_project_can_be_looked_at_and_says_so(
    projects: ProjectActions, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = project(tmp_path / "block")
    read_only(monkeypatch)
    projects.open_project(folder)
    opened = projects.model.is_open
    (notice,) = projects.bench.notices.all
    assert notice.level == "warning"
    assert "is read-only: what is changed or measured here cannot be saved" in notice.text
    ((text, answers),) = asked.questions
    assert "Go on in a copy?" in text and answers[0] == "Save a copy …"
    projects.close_project()
    assert (opened, projects.model.is_open) == (True, False)
    assert len(asked.questions) == 1, "nothing was changed, nothing is lost"


def test_a_read_only_project_goes_on_in_a_copy_with_what_was_changed(
    projects: ProjectActions, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    folder = project(tmp_path / "block")
    asked.answer = "Look at it"
    with monkeypatch.context() as patched:
        read_only(patched)
        patched.setattr(ask, "ask_name_and_folder", lambda *_: ("Mine", tmp_path / "copies"))
        projects.open_project(folder)
        renamed(projects, "Changed")
        projects.copies.save_copy()
        qtbot.waitUntil(lambda: projects.model.folder == tmp_path / "copies" / "Mine")
    assert projects.model.project.info.name == "Changed" and projects.model.is_modified
    assert projects.save() and read_project(tmp_path / "copies" / "Mine").project.info.name == "Changed"
    assert read_project(folder).project.info.name == "Block"
    assert errors(projects) == []


def test_the_offer_of_a_copy_is_taken_at_once(
    projects: ProjectActions, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    asked.answer = "Save a copy"
    folder = project(tmp_path / "block")
    monkeypatch.setattr(os, "access", lambda path, _: not Path(path).is_relative_to(folder))
    monkeypatch.setattr(ask, "ask_name_and_folder", lambda *_: ("Mine", tmp_path))
    projects.open_project(folder)
    qtbot.waitUntil(lambda: projects.model.folder == tmp_path / "Mine")
    assert not projects.model.is_modified and len(asked.questions) == 1


def test_a_copy_of_a_project_that_can_be_saved_is_of_its_newest_state(
    projects: ProjectActions, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    folder = project(tmp_path / "block")
    monkeypatch.setattr(ask, "ask_name_and_folder", lambda *_: ("Mine", tmp_path))
    projects.open_project(folder)
    renamed(projects, "Changed")
    projects.copies.save_copy()
    qtbot.waitUntil(lambda: projects.model.folder == tmp_path / "Mine")
    for place in (folder, tmp_path / "Mine"):
        assert read_project(place).project.info.name == "Changed"
    assert asked.questions == []


def test_a_copy_waits_for_the_end_of_a_recording(
    projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    projects.open_project(project(tmp_path / "block"))
    projects.model.recording_begins(projects)
    projects.copies.save_copy()
    assert "Stop the recording first" in errors(projects)[0]


def test_changes_that_cannot_be_saved_are_told_once_and_asked_about_before_they_are_lost(
    projects: ProjectActions, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, told = project(tmp_path / "block"), list[str]()
    projects.model.failed.connect(told.append)
    read_only(monkeypatch)
    projects.open_project(folder)
    for name in ("A", "B"):
        renamed(projects, name)
        projects.model.autosave()
    assert len(told) == 1
    projects.close_project()
    assert projects.model.is_open
    assert projects.model.project.info.name == "B"
    asked.answer = "Leave without saving"
    projects.close_project()
    assert not projects.model.is_open


def test_a_project_that_cannot_be_made_is_not_open(
    projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setattr(ask, "ask_new_project", lambda *_: ("Block", tmp_path / "file", 0))
    projects.new_project()
    assert not projects.model.is_open
    assert len(errors(projects)) == 1


# ---- leaving


def test_leaving_while_something_is_measured_asks_and_then_stops_it(
    projects: ProjectActions, asked: Asked, tmp_path: Path
) -> None:
    measuring = cast(HandLane, projects.bench.measuring)
    measuring.held = {jobs.MEASURE_SCAN}
    projects.open_project(project(tmp_path / "block"))
    ended: list[str] = []
    projects.bench.run_long(
        projects, jobs.MEASURE_SCAN, label="Scan", on_done=ended.append, on_cancelled=lambda: ended.append("cancelled")
    )
    projects.close_project()
    stayed = projects.model.is_open
    assert "A job is not finished yet: Scan." in asked.questions[0][0]
    asked.answer = "Stop and leave"
    projects.close_project()
    assert (stayed, projects.model.is_open) == (True, False)
    assert ended == ["cancelled"]
    assert not measuring.busy


def test_closing_a_project_waits_for_what_records_and_then_keeps_it(
    projects: ProjectActions, window: QWidget, asked: Asked, tmp_path: Path, qtbot: Any
) -> None:
    model, went_on = projects.model, list[bool]()
    projects.open_project(project(tmp_path / "block"))
    model.recording_begins(projects)
    projects.close_project(lambda: went_on.append(True))
    assert "A recording is running." in asked.questions[0][0]
    assert window.isEnabled(), "staying is nothing"
    asked.answer = "Stop and leave"
    with qtbot.waitSignal(model.leaving):
        projects.close_project(lambda: went_on.append(True))
    projects.close_project(lambda: went_on.append(False))
    assert len(asked.questions) == 2, "it is being left: asking again would be of no use"
    assert model.is_open and not window.isEnabled() and went_on == []
    renamed(projects, "Recorded")
    model.recording_ends(projects)
    assert model.is_open, "not in the midst of telling it"
    qtbot.waitUntil(lambda: not model.is_open)
    assert window.isEnabled() and went_on == [True]
    assert read_project(tmp_path / "block").project.info.name == "Recorded"


def test_what_is_being_typed_is_saved_too(
    projects: ProjectActions, window: QWidget, tmp_path: Path, qtbot: Any
) -> None:
    projects.open_project(project(tmp_path / "block"))
    editor = QLineEdit(window)
    editor.editingFinished.connect(lambda: renamed(projects, editor.text()))
    with qtbot.waitExposed(window):
        window.show()
    window.activateWindow()
    editor.setFocus()
    qtbot.waitUntil(editor.hasFocus)
    qtbot.keyClicks(editor, "Typed last")
    projects.save()
    assert read_project(tmp_path / "block").project.info.name == "Typed last"
    assert editor.hasFocus()
    window.hide()


# ---- the sample and the simulated rig


def made_sample(folder: Path, speaks: str = "en") -> Path:
    return project(folder, "Sample")


def test_the_sample_is_made_once_and_opened_when_it_is_ready(projects: ProjectActions, qtbot: Any) -> None:
    measuring = cast(HandLane, projects.bench.measuring)
    measuring.answers[jobs.SAMPLE_PROJECT] = made_sample
    projects.open_sample()
    assert projects.sample.preparing
    projects.open_sample()
    qtbot.waitUntil(lambda: projects.model.is_open)
    assert measuring.ran == [jobs.SAMPLE_PROJECT], "a second click makes no second sample"
    assert "is being prepared" in projects.bench.notices.all[0].text
    projects.close_project()
    projects.open_sample()
    assert projects.model.project.info.name == "Sample"
    assert measuring.ran == [jobs.SAMPLE_PROJECT]


def test_a_first_measurement_is_prepared_once_and_leaves_a_project_alone_that_was_opened_meanwhile(
    projects: ProjectActions, qtbot: Any, tmp_path: Path
) -> None:
    measuring = cast(HandLane, projects.bench.measuring)
    measuring.held = {jobs.SAMPLE_TO_MEASURE}
    for _ in range(2):
        projects.begin_first_measurement()
    assert len(measuring.waiting) == 1
    other = project(tmp_path / "other", "Other")
    projects.open_project(other)
    measuring.finish(new_project("Sample"))
    assert projects.model.project.info.name == "Other"
    assert "Help, First measurement" in projects.bench.notices.all[-1].text


@pytest.mark.parametrize(("inspected", "expected"), [(True, ["inspect"]), (False, [])])
def test_an_inspected_sample_opens_at_its_result(
    projects: ProjectActions, inspected: bool, expected: list[str]
) -> None:
    folder = made_sample(projects.bench.settings.projects_folder / "Sample")
    projects.open_project(folder)
    if inspected:
        projects.model.record("gauge", finished("gauge", projects.model.project, {}))
    projects.close_project()
    went: list[str] = []
    projects.go_to.connect(went.append)
    projects.open_project(folder)
    assert went == [], "opened as any other project, it opens as before"
    projects.close_project()
    projects.open_sample()
    assert projects.model.folder == folder.resolve()
    assert went == expected


def test_a_project_opened_meanwhile_is_not_taken_away_by_the_sample(
    projects: ProjectActions, tmp_path: Path, qtbot: Any
) -> None:
    measuring = cast(HandLane, projects.bench.measuring)
    measuring.held = {jobs.SAMPLE_PROJECT}
    projects.open_sample()
    projects.open_project(project(tmp_path / "block"))
    measuring.finish(made_sample(projects.bench.settings.projects_folder / "Sample"))
    assert projects.model.project.info.name == "Block"
    assert projects.bench.notices.all[-1].text == "The sample is ready: File, Open sample."


def test_a_cancelled_sample_leaves_nothing_and_can_be_asked_for_again(projects: ProjectActions, qtbot: Any) -> None:
    measuring, quick = cast(HandLane, projects.bench.measuring), cast(HandLane, projects.bench.quick)
    measuring.held = {jobs.SAMPLE_PROJECT}
    base = projects.bench.settings.projects_folder
    projects.open_sample()
    (base / ".Sample.xyz" / "project").mkdir(parents=True)
    measuring.cancel_all()
    qtbot.waitUntil(lambda: not quick.busy)
    assert list(base.iterdir()) == []
    preparing = [projects.sample.preparing]
    projects.open_sample()
    assert [*preparing, projects.sample.preparing] == [False, True]


def test_a_folder_that_is_in_the_samples_way_is_left_alone(projects: ProjectActions, qtbot: Any) -> None:
    base = projects.bench.settings.projects_folder
    (base / "Sample").mkdir(parents=True)
    cast(HandLane, projects.bench.measuring).answers[jobs.SAMPLE_PROJECT] = made_sample
    projects.open_sample()
    qtbot.waitUntil(lambda: projects.model.is_open)
    assert projects.model.folder == base / "Sample 2"
    assert list((base / "Sample").iterdir()) == []


def test_a_new_project_without_a_fan_states_its_boards_and_has_their_sheets(
    projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    monkeypatch.setattr(ask, "ask_new_project", lambda *_: ("Corner", tmp_path, 1))
    projects.new_project()
    model = projects.model
    assert not model.project.rig.has_fan
    qtbot.waitUntil(lambda: bool(model.project.rig.known_planes), timeout=30_000)
    assert set(model.project.rig.known_planes) == {"floor", "wall"}
    assert (tmp_path / "Corner" / "corner.pdf").read_bytes().startswith(b"%PDF")
    assert not errors(projects)


def test_the_simulated_rig_can_be_tried_without_a_fan(projects: ProjectActions) -> None:
    projects.try_simulated_without_fan()
    rig = projects.model.project.rig
    assert not rig.has_fan and set(rig.known_planes) == {"near", "far"}
    assert rig.gauge is not None and projects.model.project.info.name


def test_a_new_project_for_a_rig_of_one_s_own_does_not_begin_with_the_simulated_one(
    projects: ProjectActions, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = iter(("first", "second"))
    monkeypatch.setattr(ask, "ask_new_project", lambda *_: (next(names), tmp_path, 0))
    live = LiveSettings(projects.bench, "scan")
    projects.try_simulated()
    assert live.kind == "simulated"
    projects.new_project()
    assert live.kind == "opencv", "nothing else was chosen before"
    live.set_kind("aravis")
    projects.try_simulated()
    assert live.kind == "simulated"
    projects.new_project()
    assert live.kind == "aravis", "the camera chosen last"


def test_trying_the_simulated_rig_makes_a_project_of_its_own_each_time(projects: ProjectActions) -> None:
    shown: list[str] = []
    projects.go_to.connect(shown.append)
    projects.try_simulated()
    first = projects.model.folder
    projects.try_simulated()
    assert first is not None
    assert projects.model.folder == first.parent / "Simulated rig 2"
    assert shown == ["camera", "camera"]
    gauge = projects.model.project.rig.gauge
    assert gauge is not None
    assert (gauge.nominal_mm, gauge.tolerance_mm) == (50.0, 0.2)


# ---- open elsewhere


@pytest.mark.parametrize(
    ("answer", "is_open", "is_read_only"),
    [("Open read only", True, True), ("Take over", True, False), ("Do not open", False, False)],
)
def test_a_project_that_is_open_elsewhere_is_asked_about(
    projects: ProjectActions, asked: Asked, tmp_path: Path, answer: str, is_open: bool, is_read_only: bool
) -> None:
    folder = project(tmp_path / "block")
    elsewhere = take_lock(folder)
    write_autosave(folder, named("not saved over there"))
    asked.answer = answer
    projects.open_project(folder)
    text, answers = asked.questions[0]
    assert f"block is open elsewhere: by {elsewhere.holder.owner} on {elsewhere.holder.host} since 20" in text
    assert answers == ["Open read only", "Take over", "Do not open"]
    # what is not saved over there may be recovered by whoever takes it over, and by nobody else
    assert len(asked.questions) == (2 if answer == "Take over" else 1)
    if answer != "Take over":
        assert (projects.model.is_open, projects.model.is_read_only) == (is_open, is_read_only)
        elsewhere.check()


def test_nothing_is_measured_or_recorded_in_a_project_that_is_open_elsewhere(
    projects: ProjectActions, asked: Asked, tmp_path: Path
) -> None:
    folder = project(tmp_path / "block")
    take_lock(folder)
    asked.answer = "Open read only"
    projects.open_project(folder)
    lane = cast(HandLane, projects.bench.measuring)
    projects.bench.run_long(projects, jobs.MEASURE_SCAN, folder, label="scan", on_done=lambda _: None)
    assert lane.waiting[-1][1] == jobs.REFUSE


# ---- packed


def test_a_project_is_packed_as_it_is_and_unpacked_and_opened_elsewhere(
    projects: ProjectActions, asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, qtbot: Any
) -> None:
    projects.open_project(project(tmp_path / "block"))
    renamed(projects, "As it is now")
    monkeypatch.setattr(ask, "choose_file_to_save", lambda *_: tmp_path / "sent")
    projects.copies.pack()
    qtbot.waitUntil((tmp_path / "sent.trisectz").is_file)
    projects.close_project()
    monkeypatch.setattr(ask, "ask_name_and_folder", lambda _p, _t, name, _f: (name, tmp_path / "here"))
    projects.open_dropped(tmp_path / "sent.trisectz")
    qtbot.waitUntil(lambda: projects.model.folder == tmp_path / "here" / "sent")
    assert projects.model.project.info.name == "As it is now"
    assert not errors(projects)


def test_recovery_says_when_it_was_saved_and_what_differs(
    projects: ProjectActions, asked: Asked, tmp_path: Path
) -> None:
    folder = project(tmp_path / "block")
    made = new_project("Block")
    info = replace(made.info, part="Gauge " + 60 * "x", serial="7", operator="Anna")
    write_autosave(folder, ProjectFile(replace(made, info=info)))
    asked.answer = "Recover the changes"
    projects.open_project(folder)
    text, _ = asked.questions[0]
    assert "was not closed properly: there are unsaved changes of 20" in text
    assert "What was saved at 20" in text
    assert 'info.serial: – → "7"' in text
    assert "xxxx…" in text
    assert 'info.operator: – → "Anna"' in text
    assert "info.name" not in text


@pytest.mark.parametrize("used", [True, False])
def test_pictures_of_an_interrupted_recording_are_used_or_told_where_they_are(
    projects: ProjectActions, asked: Asked, tmp_path: Path, used: bool
) -> None:
    folder = project(tmp_path / "block")
    recorded = folder / "recordings" / "scan-20260101-120000"
    note_recording(folder, "scan", recorded)
    recorded.mkdir(parents=True)
    write_picture(recorded / "frame00000.png", np.full((4, 6), 90, np.uint8))
    asked.answer = "Use them" if used else ""
    projects.open_project(folder)
    assert len(asked.questions) == 1
    assert bool(projects.model.project.sources.scan) is used
    told = [notice.text for notice in projects.bench.notices.all]
    assert told == ([] if used else [f"The pictures are in {recorded}."])
