"""Decisions of the camera page."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.calibrate.board_shape import MADE
from core.errors import InputError
from core.files.pictures import write_picture
from core.files.project.data import Sources
from core.files.project.keys import finished
from core.messages import Message
from core.pipeline.live.events import LiveEnded
from core.translations import PSEUDO, language
from workbench import language as spoken
from workbench.pages.calibration.stage import Stage
from workbench.pages.camera.presenter import CameraPresenter
from workbench.step_state import State
from workbench.work import jobs


@pytest.fixture
def presenter(camera_bench):
    made = CameraPresenter(camera_bench)
    made.opened()
    return made


@pytest.fixture
def solved(presenter, views_folder, qtbot):
    presenter.use_folder(views_folder)
    qtbot.waitUntil(lambda: presenter.work.judgement is not None, timeout=30_000)
    return presenter


@pytest.fixture
def accepted(solved, qtbot):
    solved.accept()
    qtbot.waitUntil(lambda: solved.project.accepted.camera != "")
    return solved


def settled(qtbot, presenter):
    qtbot.waitUntil(lambda: not presenter.work.solving and not presenter.bench.quick.busy)


def test_nothing_is_calibrated_or_accepted_in_a_project_that_is_read_only(solved, monkeypatch):
    assert solved.cannot_search == solved.cannot_accept == ""
    monkeypatch.setattr(type(solved.model), "is_read_only", property(lambda _: True))
    assert (
        solved.cannot_search == solved.cannot_accept == "The project is read-only: go on in a copy (File, Save a copy)."
    )
    assert solved.cannot_reject == "", "it is not on the disk"


def test_without_pictures_it_asks_for_some(presenter):
    assert presenter.stage is Stage.NONE
    assert presenter.blocker() == "Record or choose pictures of the camera's target first."
    assert presenter.cannot_search and presenter.cannot_accept and presenter.cannot_reject


def test_a_folder_without_pictures_is_told(presenter, tmp_path, qtbot):
    empty = tmp_path / "empty"
    empty.mkdir()
    presenter.model.edit("x", replace(presenter.project, sources=Sources(camera=str(empty))))
    qtbot.waitUntil(lambda: presenter.work.pictures == ())
    assert presenter.stage is Stage.EMPTY
    assert "holds pictures" in presenter.blocker()


def test_pictures_of_a_project_are_listed_but_not_searched_by_themselves(presenter, views_folder, qtbot):
    presenter.model.edit("x", replace(presenter.project, sources=Sources(camera=str(views_folder))))
    qtbot.waitUntil(lambda: len(presenter.work.thumbnails) == 9)
    assert presenter.stage is Stage.FOUND
    assert presenter.blocker() == "Calibrate the camera from its pictures first."
    assert presenter.work.seen is None


def test_a_chosen_folder_is_searched_and_solved(presenter, views_folder, qtbot):
    presenter.use_folder(views_folder)
    assert presenter.stage is Stage.SEARCHING
    assert "being searched" in presenter.blocker()
    qtbot.waitUntil(lambda: presenter.stage is Stage.SOLVED)
    assert presenter.blocker() == "Accept a camera calibration first."
    assert presenter.work.calibration.rms_px < 0.1
    assert [view.used for view in presenter.views()].count(False) == 1


def test_choosing_a_folder_is_undone_and_its_search_is_not_lost(solved, qtbot):
    solved.model.undo_stack.undo()
    assert solved.stage is Stage.NONE
    ran = list(solved.bench.measuring.ran)
    solved.model.undo_stack.redo()
    settled(qtbot, solved)
    assert solved.stage is Stage.SOLVED
    assert solved.bench.measuring.ran == ran


def test_a_search_of_a_project_that_was_left_does_not_end_that_of_the_next(presenter, views_folder, tmp_path):
    presenter.bench.measuring.held = {jobs.FIND_VIEWS}
    presenter.use_folder(views_folder)
    project, left = presenter.project, presenter.work.search_task
    presenter.model.create(tmp_path / "next", replace(project, sources=Sources(camera=views_folder.as_posix())))
    presenter.work.search()
    left.cancelled.emit()  # a process takes its time to stop
    assert presenter.stage is Stage.SEARCHING


def test_what_cannot_be_calibrated_says_why(presenter, views_folder, qtbot):
    presenter.target.set_target("kind", "circle_grid")
    presenter.use_folder(views_folder)
    qtbot.waitUntil(lambda: not presenter.work.searching)
    assert presenter.stage is Stage.FAILED
    assert "found in none" in presenter.work.problem
    assert "could not be calibrated" in presenter.blocker()
    assert any("found in none" in notice.text for notice in presenter.bench.notices.all)


def test_a_view_left_out_is_solved_without_at_once_and_undone_from_memory(solved, qtbot):
    before = solved.work.calibration
    solved.set_used(["camera/view03.png"], False)
    assert solved.work.solving
    settled(qtbot, solved)
    after = solved.work.calibration
    assert after.rms_px < before.rms_px
    assert solved.quality_of("camera/view03.png").reason.code == "set.left_out_by_hand"
    assert solved.model.undo_stack.undoText() == "leave out view03.png"
    solved.model.undo_stack.undo()
    assert solved.work.calibration is before and not solved.work.solving
    solved.model.undo_stack.redo()
    assert solved.work.calibration is after


def test_too_few_views_left_are_told_and_undone(solved, qtbot):
    solved.set_used([view.name for view in solved.views()][:-2], False)
    settled(qtbot, solved)
    assert solved.stage is Stage.FAILED
    assert "are not left out by hand" in solved.work.problem
    solved.model.undo_stack.undo()
    assert solved.stage is Stage.SOLVED


def test_the_threshold_leaves_out_what_is_above_as_one_edit(solved, qtbot):
    edits = solved.model.undo_stack.count()
    solved.set_threshold(0.06)
    settled(qtbot, solved)
    assert solved.project.options.excluded == {"camera/view03.png"}
    solved.set_threshold(0.001)
    settled(qtbot, solved)
    assert len(solved.project.options.excluded) == 8
    solved.set_threshold(0.06)
    assert solved.model.undo_stack.count() == edits + 1
    solved.model.undo_stack.undo()
    assert not solved.project.options.excluded


def test_raising_the_threshold_lets_in_only_what_it_had_left_out(solved, qtbot):
    solved.set_used(["camera/view00.png"], False)
    settled(qtbot, solved)
    solved.set_threshold(0.06)
    settled(qtbot, solved)
    solved.set_threshold(1.0)
    assert solved.project.options.excluded == {"camera/view00.png"}


def test_accepting_keeps_records_and_opens_the_way(accepted):
    assert accepted.stage is Stage.ACCEPTED
    assert accepted.blocker() == ""
    assert accepted.state.state is State.DONE
    assert accepted.cannot_accept == "This calibration is accepted already."
    assert (accepted.model.folder / "calibrations" / f"camera-{accepted.candidate}.json").exists()


def test_accepting_is_undone_and_the_result_stays_a_fact(accepted):
    accepted.model.undo_stack.undo()
    assert accepted.project.accepted.camera == ""
    assert accepted.stage is Stage.SOLVED
    assert "camera" in accepted.model.results


def test_a_change_after_accepting_wants_to_be_accepted_again(accepted, qtbot):
    accepted.set_used(["camera/view03.png"], False)
    settled(qtbot, accepted)
    assert accepted.stage is Stage.SOLVED
    assert accepted.blocker() == "Accept a camera calibration first."
    assert "left-out views" in accepted.state.sentence
    accepted.accept()
    qtbot.waitUntil(lambda: accepted.stage is Stage.ACCEPTED)
    assert accepted.state.state is State.DONE


def test_other_pictures_make_the_accepted_calibration_out_of_date(accepted, tmp_path):
    other = tmp_path / "other"
    other.mkdir()
    accepted.model.edit("x", replace(accepted.project, sources=Sources(camera=str(other))))
    assert accepted.stage is Stage.OUTDATED
    assert "out of date" in accepted.blocker()


def test_rejecting_what_is_not_accepted_stops_the_way(solved):
    solved.reject()
    assert solved.stage is Stage.REJECTED
    assert "was rejected" in solved.blocker()
    assert solved.cannot_reject and not solved.cannot_accept


def test_rejecting_what_was_accepted_is_undone(accepted):
    accepted.reject()
    assert accepted.project.accepted.camera == ""
    assert accepted.stage is Stage.REJECTED
    accepted.model.undo_stack.undo()
    assert accepted.stage is Stage.ACCEPTED


def test_the_target_is_changed_with_usual_sizes_and_undone(presenter):
    presenter.target.set_target("kind", "charuco")
    assert presenter.target.target_values() == {
        "kind": "charuco", "columns": 12, "rows": 9, "size_mm": 15.0, "marker_mm": 11.25, "dictionary": "DICT_4X4_50",
        "made": "", "size_per_mille": None, "flatness_mm": None,
    }  # fmt: skip
    presenter.model.undo_stack.undo()
    assert presenter.target.target_values()["kind"] == "checkerboard"


def test_how_a_target_was_made_says_how_true_it_is_until_another_kind_is_shown(presenter):
    presenter.target.set_target("made", "print shop")
    assert presenter.project.rig.camera_board == MADE["print shop"]
    presenter.target.set_target("size_per_mille", 0.1)
    values = presenter.target.target_values()
    assert (values["made"], values["size_per_mille"], values["flatness_mm"]) == ("stated", 0.1, 0.1)
    presenter.target.set_target("kind", "charuco")
    assert presenter.target.target_values()["made"] == ""
    presenter.model.undo_stack.undo()
    assert presenter.project.rig.camera_board.scale_sd == 1e-4


def test_a_target_that_cannot_be_is_refused_with_a_sentence(presenter, qtbot):
    presenter.target.set_target("kind", "charuco")
    with qtbot.waitSignal(presenter.target.target_refused) as refused:
        presenter.target.set_target("marker_mm", 20.0)
    assert refused.args[0] == "marker_mm" and "smaller" in refused.args[1]
    assert presenter.target.target_values()["marker_mm"] == 11.25


def test_another_target_must_be_searched_again_and_undo_needs_no_search(solved, qtbot):
    solved.target.set_target("columns", 16)
    assert solved.stage is Stage.FOUND
    solved.model.undo_stack.undo()
    settled(qtbot, solved)
    assert solved.stage is Stage.SOLVED


def test_the_target_is_written_to_scale(presenter, tmp_path, qtbot):
    path = tmp_path / "target.pdf"
    presenter.target.print_target(path, "A4")
    qtbot.waitUntil(path.exists, timeout=20000)
    assert path.read_bytes().startswith(b"%PDF")


def test_a_kept_calibration_is_compared_and_restored(accepted, qtbot):
    first = accepted.candidate
    accepted.set_used(["camera/view03.png"], False)
    settled(qtbot, accepted)
    accepted.accept()
    qtbot.waitUntil(lambda: len(accepted.history.entries) == 2)
    accepted.history.choose(first)
    qtbot.waitUntil(lambda: accepted.history.changes is not None)
    assert accepted.history.changes.views == (8, 7)
    second = accepted.project.accepted.camera
    lane = accepted.bench.measuring
    lane.held.add(jobs.MEASURE_SCAN)
    scan = accepted.bench.run_long(accepted, jobs.MEASURE_SCAN, label="Measure", on_done=print)
    assert accepted.history.why_not_restore() == "A job is not finished yet: Measure."
    accepted.history.restore()
    assert accepted.project.accepted.camera == second, "the job was begun with this one"
    scan.cancel()
    accepted.history.restore()
    assert accepted.project.accepted.camera == first
    assert accepted.stage is Stage.OTHER and accepted.blocker() == ""
    accepted.model.undo_stack.undo()
    assert accepted.stage is Stage.ACCEPTED
    assert accepted.project.accepted.camera == second


def test_a_camera_of_another_program_is_taken_and_undone(presenter, tmp_path, qtbot):
    matrix = {"rows": 3, "cols": 3, "dt": "d", "data": [800.0, 0, 320.0, 0, 800.0, 240.0, 0, 0, 1.0]}
    distortion = {"rows": 1, "cols": 5, "dt": "d", "data": [0.01, 0, 0, 0, 0]}
    size = {"image_width": 640, "image_height": 480}
    file = {**size, "camera_matrix": matrix, "distortion_coefficients": distortion}
    (tmp_path / "camera.json").write_text(json.dumps(file))
    presenter.history.take(tmp_path / "camera.json")
    qtbot.waitUntil(lambda: presenter.project.accepted.camera != "")
    assert presenter.stage is Stage.ACCEPTED and presenter.blocker() == "", "no picture is needed"
    qtbot.waitUntil(lambda: len(presenter.history.entries) == 1)
    presenter.model.undo_stack.undo()
    assert presenter.project.accepted.camera == ""
    presenter.history.choose(presenter.history.entries[0].id)
    presenter.history.restore()
    assert presenter.project.accepted.camera != ""


def test_no_camera_is_taken_from_a_file_while_a_job_rests_on_the_one_in_use_or_nothing_can_be_written(
    presenter, monkeypatch
):
    lane = presenter.bench.measuring
    lane.held.add(jobs.MEASURE_SCAN)
    scan = presenter.bench.run_long(presenter, jobs.MEASURE_SCAN, label="Measure", on_done=print)
    assert presenter.history.why_not_import() == "A job is not finished yet: Measure."
    scan.cancel()
    assert presenter.history.why_not_import() == ""
    monkeypatch.setattr(type(presenter.model), "is_read_only", property(lambda _: True))
    assert "read-only" in presenter.history.why_not_import()


def test_reopening_shows_the_accepted_calibration_and_solves_it_without_searching(accepted, qtbot):
    candidate, folder = accepted.candidate, accepted.model.folder
    accepted.model.save()
    accepted.bench.measuring.ran.clear()
    accepted.model.open(folder)
    qtbot.waitUntil(lambda: accepted.work.calibration is not None)
    assert accepted.candidate == candidate
    assert accepted.stage is Stage.ACCEPTED
    accepted.set_used(["camera/view03.png"], False)
    settled(qtbot, accepted)
    assert accepted.candidate != candidate
    assert jobs.FIND_VIEWS not in accepted.bench.measuring.ran


def test_a_restored_calibration_of_other_pictures_is_not_taken_for_that_of_these(
    accepted, views_folder, tmp_path, qtbot
):
    other = tmp_path / "other"
    other.mkdir()
    for path in views_folder.iterdir():
        write_picture(other / path.name, np.full((12, 16), 7, np.uint8))
    accepted.model.edit("x", replace(accepted.project, sources=Sources(camera=str(other))))
    accepted.model.record("camera", finished("camera", accepted.project, {}))
    accepted.model.save()
    accepted.model.open(accepted.model.folder)
    qtbot.waitUntil(lambda: not accepted.bench.quick.busy)
    assert accepted.work.seen is None
    assert accepted.stage is Stage.ACCEPTED


def test_closing_the_project_forgets_everything(accepted):
    accepted.model.close()
    assert accepted.work.calibration is None
    assert accepted.history.entries == ()


def test_another_camera_model_is_solved_at_once_and_undone(solved, qtbot):
    before = solved.work.calibration.camera.matrix
    solved.set_model("skew", True)
    settled(qtbot, solved)
    assert before[0, 1] == 0 != solved.work.calibration.camera.matrix[0, 1]
    assert solved.model_values()["skew"]
    solved.model.undo_stack.undo()
    assert np.array_equal(solved.work.calibration.camera.matrix, before)


def test_new_views_are_asked_for_with_regard_to_those_there_that_count(solved, qtbot):
    lane = solved.bench.live
    solved.set_used(["camera/view02.png"], False)
    settled(qtbot, solved)
    solved.live.start()
    assert lane.waiting[0][2][0].there == ()
    solved.live.stop()
    lane.finish(LiveEnded(Path("nowhere"), 0, 0))
    solved.live.set_adding(True)
    solved.live.start()
    names = [view.name for view in lane.waiting[0][2][0].there]
    assert names == [f"camera/view{n:02d}.png" for n in range(8) if n != 2]
    lane.finish(LiveEnded(Path("nowhere"), 0, 0))


def reopened(presenter, qtbot):
    """The project saved, closed and opened again."""
    folder = presenter.model.folder
    presenter.model.save()
    presenter.model.close()
    presenter.model.open(folder)
    settled(qtbot, presenter)
    return presenter


def test_rejecting_a_solution_nobody_accepted_is_undone_and_redone(solved, qtbot):
    solved.reject()
    assert solved.stage is Stage.REJECTED
    assert solved.model.undo_stack.undoText() == "reject the camera calibration"
    solved.model.undo_stack.undo()
    settled(qtbot, solved)
    assert solved.stage is Stage.SOLVED
    solved.model.undo_stack.redo()
    settled(qtbot, solved)
    assert solved.stage is Stage.REJECTED
    solved.accept()
    qtbot.waitUntil(lambda: solved.stage is Stage.ACCEPTED)
    assert solved.project.rejected == frozenset()


def test_a_solution_found_but_not_accepted_is_offered_again_when_the_project_is_reopened(solved, qtbot):
    found, shown = solved.work.seen, solved.candidate
    solved.bench.quick.answers[jobs.FOUND_VIEWS] = lambda folder, project: found
    searched = solved.bench.measuring.ran.count(jobs.FIND_VIEWS)
    reopened(solved, qtbot)
    qtbot.waitUntil(lambda: solved.stage is Stage.SOLVED)
    assert solved.candidate == shown
    assert solved.cannot_accept == "" and solved.cannot_reject == ""
    assert solved.bench.measuring.ran.count(jobs.FIND_VIEWS) == searched


def test_a_rejected_solution_is_still_rejected_when_the_project_is_reopened(solved, qtbot):
    found = solved.work.seen
    solved.bench.quick.answers[jobs.FOUND_VIEWS] = lambda folder, project: found
    solved.reject()
    reopened(solved, qtbot)
    qtbot.waitUntil(lambda: solved.stage is Stage.REJECTED)
    assert "was rejected" in solved.blocker()


def test_beside_an_accepted_camera_a_newer_solution_is_offered_again_too(accepted, tmp_path, qtbot):
    other = tmp_path / "other"
    other.mkdir()
    for number in range(3):
        write_picture(other / f"view{number:02d}.png", np.full((12, 16), number, np.uint8))
    accepted.use_folder(other)
    settled(qtbot, accepted)
    qtbot.waitUntil(lambda: accepted.work.seen is not None)
    found = accepted.work.seen
    accepted.bench.quick.answers[jobs.FOUND_VIEWS] = lambda folder, project: found
    reopened(accepted, qtbot)
    qtbot.waitUntil(lambda: accepted.work.seen is found)


def test_what_went_wrong_is_told_in_the_language_of_the_window(presenter, monkeypatch):
    monkeypatch.setattr(spoken, "_chosen", language(PSEUDO))
    problem = InputError(Message("x.few", "few views"), todo=Message("x.more", "record more"))
    assert presenter.work._in_words(problem) == "⟦⟦fééŵ vííééŵš⟧; ⟦ŕééçóóŕd móóŕéé⟧.⟧"
