from __future__ import annotations

import sys
import weakref
from collections.abc import Iterator
from typing import Any

import pytest
import shiboken6
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QApplication

from core.errors import InputError
from workbench.language import text_of
from workbench.work.jobs import Job
from workbench.work.tasks import STOP_WITHIN_MS, Lane, Task
from workbench.work.worker import Failure


def job(name: str) -> Job:
    return Job(f"tests.workbench.lane_jobs:{name}")


class Answers:
    """Collects what a task says."""

    def __init__(self) -> None:
        self.got: list[tuple[str, Any]] = []

    def run(self, lane: Lane, name: str, *args: Any, **more: Any) -> Task:
        return lane.run(
            lane,
            job(name),
            *args,
            label=name,
            on_done=lambda value: self.got.append(("done", value)),
            on_failed=lambda problem: self.got.append(("failed", problem)),
            on_cancelled=lambda: self.got.append(("cancelled", None)),
            **more,
        )


@pytest.fixture(scope="module")
def lane(qapp: QApplication) -> Iterator[Lane]:
    """One for all these tests, and with nothing warm: some end its process, and the next one is there soon."""
    made = Lane("quick")
    yield made
    made.close()
    made.wait_until_closed()


def finish(qtbot: Any, lane: Lane, seconds: float = 20) -> None:
    qtbot.waitUntil(lambda: not lane.busy, timeout=int(seconds * 1000))


def test_a_job_gives_its_result_and_tells_its_progress(qtbot: Any, lane: Lane) -> None:
    answers, told = Answers(), []
    task = answers.run(lane, "double", 21)
    task.progressed.connect(lambda *what: told.append(what))
    finish(qtbot, lane)
    assert answers.got == [("done", 42)]
    assert told == [("doubling", 1, 1)]


def test_an_answer_whose_receiver_is_gone_is_dropped_and_the_job_is_done_all_the_same(qtbot: Any, lane: Lane) -> None:
    got: list[Any] = []
    receiver, other = QObject(), QObject()
    other.setObjectName("other")
    heard: set[str] = set()
    for one in (receiver, other):
        task = lane.run(one, job("double"), 21, label="double", on_done=got.append, on_failed=got.append)
        for signal in (task.progressed, task.ended):
            signal.connect(lambda *_, one=one: heard.add(one.objectName()))
    lane.run(receiver, job("refuse"), label="refuse", on_done=got.append, on_failed=got.append)
    ended: list[str] = []
    lane.task_ended.connect(lambda task: ended.append(task.label))
    shiboken6.delete(receiver)
    finish(qtbot, lane)
    assert got == [42]
    assert heard == {"other"}, "nothing is told of what was connected for a receiver that is gone"
    assert ended == ["double", "double", "refuse"]


def test_threads_of_a_lane_do_not_wait_long_for_one_another(qtbot: Any, lane: Lane) -> None:
    got: list[float] = []
    lane.run(lane, Job("sys:getswitchinterval"), label="lock", on_done=got.append, offers={})
    finish(qtbot, lane)
    assert got == [pytest.approx(0.001)]


def test_jobs_run_in_the_order_they_were_given(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    for value in (1, 2, 3):
        answers.run(lane, "double", value)
    finish(qtbot, lane)
    assert [value for _, value in answers.got] == [2, 4, 6]


def test_only_the_newest_waiting_job_for_a_receiver_is_run_if_asked(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    for value in (1, 2, 3):
        answers.run(lane, "double", value, replace_waiting=True)
    finish(qtbot, lane)
    assert answers.got == [("cancelled", None), ("done", 2), ("done", 6)]


def test_a_job_finds_what_the_one_before_left_in_the_memory_until_the_process_is_another(
    qtbot: Any, lane: Lane
) -> None:
    answers, remembering = Answers(), {"memory": "memory"}
    for value in (1, 2):
        answers.run(lane, "remember", value, offers=remembering)
    answers.run(lane, "die")
    answers.run(lane, "remember", 3, offers=remembering)
    finish(qtbot, lane)
    assert [value for kind, value in answers.got if kind == "done"][-2:] == [1, None]


def test_another_job_and_the_same_for_another_receiver_keep_waiting(qtbot: Any, lane: Lane) -> None:
    answers, other = Answers(), QObject()
    answers.run(lane, "double", 1)
    answers.run(lane, "double", 2)
    lane.run(lane, job("refuse"), label="double", on_done=lambda _: None, replace_waiting=True)
    lane.run(other, job("double"), 3, label="double", on_done=lambda _: None, replace_waiting=True)
    finish(qtbot, lane)
    assert answers.got == [("done", 2), ("done", 4)]


def test_bad_input_arrives_as_its_one_sentence(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    answers.run(lane, "refuse")
    finish(qtbot, lane)
    ((kind, problem),) = answers.got
    assert kind == "failed"
    assert isinstance(problem, InputError)
    assert text_of(problem) == "view03.png: the board has 8 × 6 corners, not 9 × 6; check rig.toml."


@pytest.mark.parametrize(("name", "kind"), [("crash", "ZeroDivisionError"), ("die", "ProcessEnded")])
def test_a_job_that_breaks_down_is_told_and_the_lane_goes_on(qtbot: Any, lane: Lane, name: str, kind: str) -> None:
    answers = Answers()
    answers.run(lane, name)
    answers.run(lane, "double", 4)
    finish(qtbot, lane)
    (failed, problem), done = answers.got
    assert failed == "failed"
    assert isinstance(problem, Failure)
    assert problem.kind == kind
    assert done == ("done", 8)


def test_a_result_that_cannot_be_sent_is_a_failure(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    answers.run(lane, "unsendable")
    finish(qtbot, lane)
    assert answers.got[0][0] == "failed"


def test_a_process_that_cannot_be_started_fails_the_job_and_the_lane_goes_on(
    qtbot: Any, lane: Lane, monkeypatch: pytest.MonkeyPatch
) -> None:
    lane.close()
    answers = Answers()
    with monkeypatch.context() as patch:
        patch.setattr(sys, "executable", "/no/such/python")
        answers.run(lane, "double", 1)
        assert answers.got == [], "told before whoever asked could know of the task"
        finish(qtbot, lane)
    ((kind, problem),) = answers.got
    assert kind == "failed"
    assert "No such file" in problem.details
    answers.run(lane, "double", 4)
    finish(qtbot, lane)
    assert answers.got[1:] == [("done", 8)]


def test_what_cannot_be_sent_to_a_job_fails_it_and_the_lane_goes_on(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    answers.run(lane, "double", lambda: None)
    answers.run(lane, "double", 4)
    finish(qtbot, lane)
    assert [kind for kind, _ in answers.got] == ["failed", "done"]


@pytest.mark.parametrize("name", ["count_until_cancelled", "deaf"])
def test_cancel_acts_soon_even_on_a_job_that_does_not_listen(qtbot: Any, lane: Lane, name: str) -> None:
    answers = Answers()
    answers.run(lane, "double", 1)
    finish(qtbot, lane)
    task = answers.run(lane, name)
    qtbot.wait(100)
    assert STOP_WITHIN_MS <= 1000
    task.cancel()
    finish(qtbot, lane)
    assert answers.got[1:] == [("cancelled", None)]
    answers.run(lane, "double", 5)
    finish(qtbot, lane)
    assert answers.got[-1] == ("done", 10)


def test_a_job_that_was_done_before_it_heard_of_the_cancel_is_told_as_done(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    answers.run(lane, "double", 1)
    finish(qtbot, lane)
    task = answers.run(lane, "past_its_last_look")
    qtbot.wait(100)
    task.cancel()
    finish(qtbot, lane)
    assert answers.got[1:] == [("done", "written")]
    assert task.succeeded


def test_a_waiting_job_can_be_cancelled_before_it_begins(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    answers.run(lane, "double", 1)
    answers.run(lane, "double", 2).cancel()
    finish(qtbot, lane)
    assert answers.got == [("cancelled", None), ("done", 2)]


def test_events_arrive_while_the_job_runs_and_before_its_result(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    task = answers.run(lane, "watched", 5, offers={"progress": "progress", "watch": "watch"})
    task.reported.connect(lambda value: answers.got.append(("event", value)))
    finish(qtbot, lane)
    assert answers.got == [*(("event", i) for i in range(5)), ("done", 5)]


def test_a_view_is_sent_only_after_the_last_one_was_shown(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    views: list[str] = []
    task = answers.run(lane, "echo", offers={"channel": "channel"})
    task.view.connect(views.append)
    for command in ("a", "b", "c"):
        task.send(command)
    qtbot.waitUntil(lambda: views == ["a"], timeout=10_000)
    qtbot.wait(100)
    assert views == ["a"]
    task.shown()
    task.send("d")
    qtbot.waitUntil(lambda: views == ["a", "d"], timeout=5_000)
    task.send("stop")
    finish(qtbot, lane)
    assert answers.got == [("done", ["a", "b", "c", "d"])]


def test_a_lane_computes_on_one_core_and_carries_no_window(qtbot: Any) -> None:
    answers, lane = Answers(), Lane("alone")
    try:
        answers.run(lane, "surroundings")
        finish(qtbot, lane)
    finally:
        lane.close()
        lane.wait_until_closed()
    assert answers.got == [("done", ("1", False))]


def test_what_is_done_ahead_is_done_piece_by_piece_while_no_job_waits(qtbot: Any) -> None:
    lane, answers = Lane("ahead", ahead=job("pieces")), Answers()
    try:
        answers.run(lane, "pieces_done")
        finish(qtbot, lane)
        qtbot.wait(1000)
        answers.run(lane, "pieces_done")
        finish(qtbot, lane)
    finally:
        lane.close()
        lane.wait_until_closed()
    (_, first), (_, second) = answers.got
    assert first < second < 50


@pytest.mark.parametrize(("pieces", "told"), [("first_pieces", [True, False]), ("pieces", [])])
def test_what_is_made_ready_for_the_first_time_is_told_from_its_beginning_to_its_end(
    qtbot: Any, pieces: str, told: list[bool]
) -> None:
    lane, answers = Lane("ahead", ahead=job(pieces)), Answers()
    heard: list[bool] = []
    lane.preparing_changed.connect(heard.append)
    try:
        lane.prepare()
        answers.run(lane, "double", 21)
        finish(qtbot, lane)
        qtbot.waitUntil(lambda: heard == told, timeout=20_000)
    finally:
        lane.close()
        lane.wait_until_closed()
    assert heard == told


def test_a_process_that_ends_while_it_makes_ready_does_so_no_longer(qtbot: Any) -> None:
    lane = Lane("ahead", ahead=job("first_pieces"))
    heard: list[bool] = []
    lane.preparing_changed.connect(heard.append)
    lane.prepare()
    qtbot.waitUntil(lambda: heard == [True], timeout=20_000)
    lane.close()
    lane.wait_until_closed()
    assert heard == [True, False]


def test_a_lane_that_nobody_holds_any_more_ends_before_its_tasks(
    qapp: QApplication, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ended by its last task it would delete that task, its child, a second time: the program would crash."""
    monkeypatch.setattr(Lane, "prepare", lambda _: None)
    lane, answers = Lane("short"), Answers()
    answers.run(lane, "double", 1)
    lane.close()
    gone = weakref.ref(lane)
    del lane
    assert gone() is None
    qapp.processEvents()
    assert answers.got == [("cancelled", None)]
