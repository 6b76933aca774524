"""Decisions of the laser planes page."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from core.errors import InputError
from core.files.project.data import Accepted
from core.files.project.folder import read_project
from core.files.project.keys import finished, left_to_do
from core.files.results.planes_file import read_planes, write_planes
from core.findings.table import note_of
from core.messages import Message, plain
from core.pipeline.live.events import LiveEnded, LiveStarted
from core.report.facts.of_planes import planes_facts
from core.report.facts.pictures import left_out
from tests.calibrate.fan_scenes import CAMERA
from tests.workbench.hand_lane import HandLane
from tests.workbench.pages.planes_cases import NO_PLATE, Planes, folder_with_poses, project_with
from workbench.bench import Bench
from workbench.language import sentence, text_of
from workbench.pages.calibration.stage import Stage
from workbench.pages.planes import words
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.pages.words import fact_row
from workbench.step_state import State
from workbench.work import jobs


@pytest.fixture
def planes(hand_bench: Bench) -> Planes:
    return Planes(hand_bench)


@pytest.fixture(scope="session")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folder_with_poses(tmp_path_factory.mktemp("poses") / "planes")


@pytest.fixture
def page(hand_bench: Bench, planes: Planes, tmp_path: Path, qtbot: Any) -> PlanesPresenter:
    """A project with an accepted camera and no pictures of the plate."""
    made = PlanesPresenter(hand_bench)
    hand_bench.model.create(tmp_path / "project", project_with())
    made.model.record("camera", finished("camera", made.project, {}))
    settled(qtbot, made)
    return made


@pytest.fixture
def found(page: PlanesPresenter, pictures: Path, qtbot: Any) -> PlanesPresenter:
    page.use_folder(pictures)
    qtbot.waitUntil(lambda: page.stage is Stage.SOLVED)
    settled(qtbot, page)
    return page


@pytest.fixture
def accepted(found: PlanesPresenter, qtbot: Any) -> PlanesPresenter:
    found.accept()
    qtbot.waitUntil(lambda: found.stage is Stage.ACCEPTED)
    settled(qtbot, found)
    return found


def stage(page: PlanesPresenter) -> Stage:
    """Read anew each time."""
    return page.stage


def settled(qtbot: Any, page: PlanesPresenter) -> None:
    qtbot.waitUntil(lambda: not page.bench.quick.busy and not page.bench.measuring.busy)


# ---- how far it is


def test_every_stage_before_a_calibration_says_what_is_missing(
    page: PlanesPresenter, pictures: Path, tmp_path: Path, qtbot: Any
) -> None:
    said = [(page.stage, page.blocker())]
    (tmp_path / "empty").mkdir()
    for folder in (tmp_path / "empty", pictures):
        sources = replace(page.project.sources, planes=folder.as_posix())
        page.model.edit("choose", replace(page.project, sources=sources))
        settled(qtbot, page)
        said.append((page.stage, page.blocker()))
    page.model.edit("reject", replace(page.project, accepted=Accepted()))
    said.append((page.stage, page.blocker()))
    assert said == [
        (Stage.NONE, "Record or choose pictures of the plate under the laser first."),
        (Stage.EMPTY, "Choose a folder that holds pictures of the plate under the laser."),
        (Stage.FOUND, "Calibrate the laser planes from their pictures first."),
        (Stage.NO_CAMERA, "Accept a camera calibration first."),
    ]
    assert page.cannot_search == "Accept a camera calibration first."
    assert page.cannot_accept == page.cannot_reject == "There is no calibration yet."


def test_a_chosen_folder_is_measured_and_solved(page: PlanesPresenter, pictures: Path, qtbot: Any) -> None:
    page.use_folder(pictures)
    assert (page.stage, page.blocker()) == (Stage.SEARCHING, "The pictures are being measured.")
    assert page.cannot_search == "The pictures are being measured."
    qtbot.waitUntil(lambda: page.stage is Stage.SOLVED)
    assert page.blocker() == "Accept the laser planes first."
    assert [pose.used for pose in page.views()] == [True] * 6 + [False]
    assert len(page.work.pictures or ()) == 7, "pictures with the laser off are no poses of their own"


def test_pictures_are_seen_before_they_are_measured_and_not_read_again_and_again(
    page: PlanesPresenter, planes: Planes, pictures: Path, qtbot: Any
) -> None:
    seen: list[str] = []
    page.look.picture.connect(lambda name, _: seen.append(name))
    sources = replace(page.project.sources, planes=pictures.as_posix())
    page.model.edit("choose", replace(page.project, sources=sources))
    settled(qtbot, page)
    page.choose("pose03")
    settled(qtbot, page)
    for _ in range(3):
        page.work.changed.emit()
    settled(qtbot, page)
    assert seen == ["pose00", "pose03"]
    assert planes.shown == []


def test_cancelling_the_measurement_goes_back_to_where_it_was(
    page: PlanesPresenter, planes: Planes, pictures: Path, qtbot: Any
) -> None:
    planes.measuring.held = {jobs.FIND_POSES}
    page.use_folder(pictures)
    planes.measuring.cancel_all()
    settled(qtbot, page)
    assert (page.stage, page.work.problem) == (Stage.FOUND, "")
    assert page.cannot_search == ""


def test_what_cannot_be_calibrated_says_why_in_the_words_of_the_window(
    page: PlanesPresenter, pictures: Path, qtbot: Any
) -> None:
    page.target.set_target("kind", "checkerboard")
    page.use_folder(pictures)
    qtbot.waitUntil(lambda: page.stage is Stage.FAILED)
    assert page.work.problem == ("planes: none of the 7 poses can be used; check the number of lines under Laser.")
    assert page.blocker().startswith("The laser planes could not be calibrated")
    assert page.bench.notices.all[-1].text == page.work.problem


def test_measurements_of_a_project_that_was_left_do_not_end_those_of_the_next(
    page: PlanesPresenter, planes: Planes, pictures: Path, tmp_path: Path
) -> None:
    planes.measuring.held = {jobs.FIND_POSES}
    page.use_folder(pictures)
    left = page.work.search_task
    page.model.create(tmp_path / "next", project_with(planes=pictures))
    page.work.search()
    assert left is not None
    left.cancelled.emit()  # a process takes its time to stop
    assert page.stage is Stage.SEARCHING


# ---- poses


def test_a_pose_left_out_is_solved_without_at_once_and_undone_from_memory(found: PlanesPresenter, qtbot: Any) -> None:
    before, ids = found.work.calibration, [found.candidate]
    found.set_used(["pose02"], False)
    assert stage(found) is Stage.SOLVING
    settled(qtbot, found)
    ids.append(found.candidate)
    pose = found.quality_of("pose02")
    assert pose is not None and pose.reason is not None and pose.reason.code == "set.left_out_by_hand"
    assert found.model.undo_stack.undoText() == "leave out pose02"
    found.model.undo_stack.undo()
    ids.append(found.candidate)
    assert found.work.calibration is before, "nothing is solved twice"
    found.model.undo_stack.redo()
    ids.append(found.candidate)
    assert ids[0] == ids[2] != ids[1] == ids[3]


def test_several_poses_are_left_out_by_one_edit(found: PlanesPresenter, qtbot: Any) -> None:
    found.set_used(["pose01", "pose02"], False)
    assert found.model.undo_stack.undoText() == "leave out 2 poses"
    found.set_used(["pose01", "pose02"], True)
    assert found.model.undo_stack.undoText() == "let 2 poses count"
    settled(qtbot, found)
    assert stage(found) is Stage.SOLVED


def test_the_poses_left_out_are_counted_by_reason(found: PlanesPresenter, qtbot: Any, tmp_path: Path) -> None:
    found.set_used(["pose01", "pose03"], False)
    settled(qtbot, found)
    lines = ["2 × left out by hand: pose01, pose03", f"1 × {NO_PLATE}: pose06"]
    assert [str(one.line()) for one in left_out(found.views())] == lines
    calibration = found.work.calibration
    assert calibration is not None
    write_planes(tmp_path / "planes.json", calibration, CAMERA)
    for one in (calibration, read_planes(tmp_path / "planes.json", CAMERA)):
        assert any(str(note).startswith("3 of 7 poses left out: ") for note in one.notes)
        assert "left out" not in words.notes(one), "said once"
    rows = {row[0]: row[1] for row in map(fact_row, planes_facts(calibration))}
    assert rows["Poses"] == "4 of 7"


def test_the_note_on_poses_left_out_is_not_repeated_however_it_names_them(found: PlanesPresenter) -> None:
    calibration = found.work.calibration
    assert calibration is not None
    told_by_another = note_of("fan.poses_left_out", n=1, all=7, names=("pose06 (no plate)",))
    few = note_of("fan.few_poses", n=2, all=7, least=3)
    stated = replace(calibration, notes=(told_by_another, few), scale_assumed=False)
    assert words.notes(stated) == sentence(text_of(few))


def test_too_few_poses_are_told_and_undone(found: PlanesPresenter, qtbot: Any) -> None:
    found.set_used([f"pose{number:02d}" for number in range(5)], False)
    settled(qtbot, found)
    assert stage(found) is Stage.FAILED
    assert "only one pose can be used" in found.work.problem
    lines = [str(one.line()) for one in left_out(found.work.poses or ())]
    assert lines == [f"1 × {NO_PLATE}: pose06"]
    found.model.undo_stack.undo()
    assert stage(found) is Stage.SOLVED


def test_the_pose_shown_gets_the_numbers_of_its_lines_once_they_are_solved(
    found: PlanesPresenter, planes: Planes, qtbot: Any
) -> None:
    assert planes.shown[-1] == ("pose00", True)
    count = len(planes.shown)
    for _ in range(3):
        found.work.changed.emit()
    settled(qtbot, found)
    assert len(planes.shown) == count, "what is shown is not read again and again"
    found.choose("pose04")
    settled(qtbot, found)
    assert planes.shown[-1] == ("pose04", True)


# ---- plate and laser


def test_the_plates_temperature_comes_and_goes_with_its_uncertainty(page: PlanesPresenter) -> None:
    def stated() -> tuple[float | None, float | None]:
        values = page.target.target_values()
        return values["celsius"], values["u_celsius"]

    assert stated() == (None, None)
    page.target.set_target("celsius", 23.0)
    assert stated() == (23.0, 0.5)
    page.target.set_target("u_celsius", 1.0)
    assert stated() == (23.0, 1.0)
    page.target.set_target("u_celsius", None)
    assert stated() == (None, None)
    page.target.set_target("u_celsius", 1.0)
    assert stated() == (20.0, 1.0)
    page.target.set_target("kind", "charuco")
    assert stated() == (None, None), "another plate"


@pytest.mark.parametrize(
    ("change", "read"),
    [
        (lambda p: p.set_laser("channel", "red-green"), lambda p: p.project.rig.channel_of("planes")),
        (lambda p: p.set_laser("lines", 2), lambda p: p.project.rig.lines),
        (lambda p: p.set_laser("angle", math.radians(4.0)), lambda p: p.project.rig.angle),
        (lambda p: p.set_laser("angle", None), lambda p: p.project.rig.angle),
        (lambda p: p.set_laser("constrain_fan", False), lambda p: p.project.options.constrain_fan),
        (lambda p: p.set_laser("automatic", False), lambda p: p.project.options.plane_stripe),
        (lambda p: p.set_laser("width_px", 9.0), lambda p: p.project.options.plane_stripe),
        (lambda p: p.target.set_target("size_mm", 55.0), lambda p: p.project.rig.plane_target.side_mm),
        (lambda p: p.target.set_target("celsius", 23.0), lambda p: p.project.rig.part.target.celsius),
        (lambda p: p.target.set_target("kind", "charuco"), lambda p: type(p.project.rig.plane_target)),
    ],
)
def test_each_edit_of_plate_and_laser_can_be_undone(
    page: PlanesPresenter, change: Callable[[Any], None], read: Callable[[Any], Any]
) -> None:
    before = read(page)
    change(page)
    after = read(page)
    assert after != before
    page.model.undo_stack.undo()
    assert read(page) == before
    page.model.undo_stack.redo()
    assert read(page) == after


def test_another_laser_is_solved_at_once_from_the_same_poses(
    found: PlanesPresenter, planes: Planes, qtbot: Any
) -> None:
    ran, before = list(planes.measuring.ran), found.candidate
    found.set_laser("constrain_fan", False)
    settled(qtbot, found)
    assert found.candidate != before
    assert found.work.calibration is not None
    assert "as asked" in words.verdict_sentence(found.work.calibration)
    assert planes.measuring.ran == ran
    rows = {row[0]: row[1:] for row in map(fact_row, planes_facts(found.work.calibration))}
    assert rows["Line 1, to the next"][0] == "5°" and rows["Line 1, to the next, free"][0].startswith(("4.99", "5.00"))
    assert (rows["Line 1, to the next"][2], rows["Off one axis"][2]) == ("good", "good")


def test_another_plate_must_be_measured_again_and_comes_back_from_memory(
    found: PlanesPresenter, planes: Planes, qtbot: Any
) -> None:
    ran, before = list(planes.measuring.ran), found.candidate
    found.target.set_target("size_mm", 55.0)
    assert (found.stage, found.candidate) == (Stage.FOUND, "")
    found.model.undo_stack.undo()
    assert (found.stage, found.candidate) == (Stage.SOLVED, before)
    assert planes.measuring.ran == ran


def test_a_plate_that_cannot_be_is_refused_with_a_sentence(page: PlanesPresenter) -> None:
    refused: list[tuple[str, str]] = []
    page.target.target_refused.connect(lambda *what: refused.append(what))
    page.target.set_target("kind", "charuco")
    page.target.set_target("marker_mm", 1000.0)
    assert refused[-1][0] == "marker_mm"
    assert refused[-1][1]
    page.target.set_target("marker_mm", 5.0)
    assert refused[-1] == ("marker_mm", "")


# ---- accept, reject, history


def test_accepting_is_an_edit_and_a_result(accepted: PlanesPresenter) -> None:
    assert accepted.project.accepted.planes == accepted.candidate
    assert accepted.blocker() == ""
    assert accepted.state.state is State.DONE
    assert accepted.cannot_accept == "These laser planes are accepted already."
    accepted.model.undo_stack.undo()
    assert accepted.project.accepted.planes == ""
    assert stage(accepted) is Stage.SOLVED
    accepted.model.undo_stack.redo()
    assert stage(accepted) is Stage.ACCEPTED


def test_accepted_planes_are_there_when_the_project_is_opened_again(
    accepted: PlanesPresenter, planes: Planes, qtbot: Any
) -> None:
    id_, folder = accepted.candidate, accepted.model.folder
    assert folder is not None
    accepted.model.save()
    assert read_project(folder).project.accepted.planes == id_
    accepted.model.close()
    assert accepted.candidate == ""
    accepted.model.open(folder)
    settled(qtbot, accepted)
    assert (accepted.stage, accepted.candidate) == (Stage.ACCEPTED, id_)
    assert len(accepted.history.entries) == 1
    assert accepted.seen_by.camera is CAMERA


def test_rejecting_what_is_accepted_is_an_edit_that_can_be_undone(accepted: PlanesPresenter) -> None:
    accepted.reject()
    assert accepted.project.accepted.planes == ""
    assert stage(accepted) is Stage.REJECTED
    assert accepted.cannot_reject == "This calibration is rejected already."
    assert accepted.blocker() == "The laser planes were rejected; accept better ones first."
    accepted.model.undo_stack.undo()
    assert stage(accepted) is Stage.ACCEPTED


def test_rejecting_what_nobody_accepted_is_an_edit_too_and_accepting_it_takes_that_back(
    found: PlanesPresenter, qtbot: Any
) -> None:
    found.reject()
    assert (stage(found), found.model.undo_stack.undoText()) == (Stage.REJECTED, "reject the laser planes")
    found.model.undo_stack.undo()
    settled(qtbot, found)
    assert stage(found) is Stage.SOLVED
    found.reject()
    found.accept()
    qtbot.waitUntil(lambda: found.stage is Stage.ACCEPTED)
    assert found.project.rejected == frozenset()


def test_planes_found_but_not_accepted_are_offered_again_when_the_project_is_reopened(
    found: PlanesPresenter, qtbot: Any
) -> None:
    poses, shown, folder = found.work.poses, found.candidate, found.model.folder
    assert folder is not None
    cast(HandLane, found.bench.quick).answers[jobs.FOUND_POSES] = lambda folder, project: poses
    found.model.save()
    found.model.close()
    found.model.open(folder)
    qtbot.waitUntil(lambda: found.stage is Stage.SOLVED)
    assert (found.candidate, found.cannot_accept) == (shown, "")
    assert cast(HandLane, found.bench.measuring).ran.count(jobs.FIND_POSES) == 1


def test_another_camera_puts_the_planes_out_of_date_and_says_so(accepted: PlanesPresenter) -> None:
    after = replace(accepted.project.accepted, camera="c2")
    accepted.model.edit("accept another camera", replace(accepted.project, accepted=after))
    assert stage(accepted) is Stage.OUTDATED
    assert "camera calibration" in accepted.state.sentence
    assert accepted.blocker() == "The accepted laser planes are out of date; calibrate again."


def test_planes_of_the_history_are_restored_and_undone(accepted: PlanesPresenter, qtbot: Any) -> None:
    first = accepted.candidate
    assert accepted.history.why_not_restore() == "Choose a calibration in the list first."
    accepted.history.choose(first)
    assert accepted.history.why_not_restore() == "These laser planes are in use."
    accepted.set_used(["pose02"], False)
    settled(qtbot, accepted)
    accepted.accept()
    settled(qtbot, accepted)
    assert [entry.id for entry in accepted.history.entries] == [accepted.candidate, first]
    accepted.history.restore()
    assert accepted.project.accepted.planes == first
    assert accepted.model.undo_stack.undoText() == "restore laser planes"
    assert (stage(accepted), accepted.blocker()) == (Stage.OTHER, ""), "measured with on purpose"
    accepted.model.undo_stack.undo()
    assert accepted.project.accepted.planes != first
    assert stage(accepted) is Stage.ACCEPTED


def test_settings_that_give_what_is_accepted_are_not_out_of_date_however_they_came_about(
    accepted: PlanesPresenter, qtbot: Any
) -> None:
    accepted.set_used(["pose06"], False)  # it showed no plate anyway
    settled(qtbot, accepted)
    assert stage(accepted) is Stage.ACCEPTED
    states = [accepted.state.state]
    accepted.set_used(["pose02"], False)
    settled(qtbot, accepted)
    states.append(accepted.state.state)
    accepted.set_used(["pose02"], True)
    states.append(accepted.state.state)
    assert states == [State.DONE, State.OUTDATED, State.DONE]


def test_planes_whose_file_tells_too_little_are_accepted_again_and_what_rests_on_them_is_measured_again(
    accepted: PlanesPresenter, planes: Planes, qtbot: Any
) -> None:
    id_ = accepted.candidate
    planes.kept[:] = [SimpleNamespace(**{**vars(entry), "facts_known": False}) for entry in planes.kept]
    for step in ("scan", "gauge", "report"):
        accepted.model.record(step, finished(step, accepted.project, accepted.model.results))
    assert not left_to_do(accepted.project, accepted.model.results)
    accepted.history.refresh()
    settled(qtbot, accepted)
    assert stage(accepted) is Stage.OUTDATED
    assert (accepted.cannot_accept, "earlier version" in accepted.blocker()) == ("", True)
    accepted.accept()
    settled(qtbot, accepted)
    assert (accepted.project.accepted.planes, stage(accepted)) == (id_, Stage.ACCEPTED)
    assert accepted.cannot_accept == "These laser planes are accepted already."
    assert left_to_do(accepted.project, accepted.model.results) == ("scan", "gauge", "report")
    assert "laser planes" in accepted.model.states["scan"].sentence


def test_planes_that_rest_on_another_camera_are_not_restored(accepted: PlanesPresenter) -> None:
    first = accepted.candidate
    accepted.model.edit("x", replace(accepted.project, accepted=Accepted(camera="c2")))
    accepted.history.choose(first)
    assert "another camera" in accepted.history.why_not_restore()
    accepted.history.restore()
    assert accepted.project.accepted.planes == ""


def test_what_cannot_be_kept_is_told_and_can_be_accepted_later(
    found: PlanesPresenter, planes: Planes, qtbot: Any
) -> None:
    planes.quick.held = {jobs.ACCEPT_PLANES}
    found.accept()
    assert found.cannot_accept
    planes.quick.fail(InputError("cannot be written, because the disk is full", where="planes.json"))
    assert found.project.accepted.planes == ""
    assert found.cannot_accept == ""


# ---- live


def test_live_poses_are_taken_with_or_without_the_laser_off_as_was_said_last(
    page: PlanesPresenter, planes: Planes, tmp_path: Path
) -> None:
    page.set_pairs(False)
    assert PlanesPresenter(page.bench).live.pairs is False, "remembered by the program"
    page.do_live()
    live = cast(HandLane, page.bench.live)
    request = live.waiting[0][2][0]
    assert (request.step, request.pairs, request.camera) == ("planes", False, CAMERA)
    assert (page.stage, page.blocker()) == (Stage.LIVE, "Stop the live source when there are enough poses.")
    assert page.cannot_search == page.cannot_accept == page.cannot_reject == "Stop the live source first."
    assert page.model.is_recording
    page.live.stop()
    live.finish(LiveEnded(request.folder, 0, 0))
    assert page.stage is Stage.NONE


def test_a_recording_becomes_the_source_and_is_measured(page: PlanesPresenter, qtbot: Any) -> None:
    page.do_live()
    live = cast(HandLane, page.bench.live)
    task, _, (request,), _ = live.waiting[0]
    task.reported.emit(LiveStarted("Simulated rig", (320, 240)))
    folder_with_poses(request.folder)
    page.live.stop()
    live.finish(LiveEnded(request.folder, 7, 0))
    qtbot.waitUntil(lambda: page.stage is Stage.SOLVED)
    assert page.folder == request.folder
    settled(qtbot, page)
    page.model.undo_stack.undo()
    assert page.stage is Stage.NONE


def test_no_poses_are_taken_while_the_camera_is_read_or_pictures_are_measured(
    page: PlanesPresenter, planes: Planes, pictures: Path, tmp_path: Path
) -> None:
    planes.measuring.held = {jobs.FIND_POSES}
    page.use_folder(pictures)
    assert page.live.cannot_start() == "The pictures are being measured; wait for it, or cancel it."
    planes.measuring.cancel_all()
    planes.quick.held = {jobs.READ_CAMERA}
    page.model.create(tmp_path / "next", project_with("c2"))
    assert page.live.cannot_start() == "The camera calibration is being read."
    page.do_live()
    assert not page.live.running


def test_planes_of_a_minority_are_accepted_only_by_a_decision(found: PlanesPresenter, planes: Planes, qtbot: Any):
    calibration = found.work.calibration
    assert calibration is not None
    poses = tuple(
        replace(pose, used=place < 2, exclusion=None if place < 2 else plain("it disagrees"))
        for place, pose in enumerate(calibration.poses)
    )
    found.work.calibration = replace(calibration, poses=poses)
    asked: list[Message] = []

    def yes(minority: Message) -> bool:
        asked.append(minority)
        return True

    found.accept()
    assert stage(found) is Stage.SOLVED
    found.decide = yes
    found.accept()
    qtbot.waitUntil(lambda: found.stage is Stage.ACCEPTED)
    settled(qtbot, found)
    assert [one.code for one in asked] == ["fan.minority"]
    assert len(planes.kept) == 1
