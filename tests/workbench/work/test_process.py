"""What a worker process sends arrives whole, leaves nothing behind, and costs the GUI thread little."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.workbench.work.test_tasks import Answers, finish
from workbench.bench import Bench
from workbench.work import wire
from workbench.work.jobs import Job
from workbench.work.process import ENDS_WITHIN_MS
from workbench.work.tasks import Lane, Task
from workbench.work.wire import Kind


@pytest.fixture
def lane(qtbot: Any) -> Iterator[Lane]:
    made = Lane("alone")
    yield made
    made.close()
    made.wait_until_closed()


def folder_of(lane: Lane) -> Path:
    assert lane._process is not None
    return Path(lane._process._folder.name)


def test_a_large_array_may_be_written_to_and_its_file_is_gone_at_once(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    answers.run(lane, "picture", 10)
    finish(qtbot, lane)
    ((kind, value),) = answers.got
    assert kind == "done"
    assert value["picture"].shape == (10, 1 << 20) and (value["picture"] == 7).all()
    value["picture"][0, 0] = 9
    assert value["picture"][0, 0] == 9 and list(value["small"]) == [0, 1, 2, 3, 4]
    assert list(folder_of(lane).iterdir()) == []


def test_memory_of_a_large_array_goes_with_it(qtbot: Any, lane: Lane) -> None:
    if not Path("/proc/self/maps").exists():
        pytest.skip("only Linux tells what is mapped")
    answers = Answers()
    answers.run(lane, "picture", 10)
    finish(qtbot, lane)
    folder = str(folder_of(lane))
    assert folder in Path("/proc/self/maps").read_text()
    answers.got.clear()
    qtbot.wait(10)
    gc.collect()
    assert folder not in Path("/proc/self/maps").read_text()


def test_nothing_is_left_of_a_process_that_was_killed_while_it_sent_pictures(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    seen: list[int] = []
    task = answers.run(lane, "pictures_for_ever", offers={"channel": "channel"})
    task.reported.connect(lambda _: seen.append(1))
    qtbot.waitUntil(lambda: len(seen) > 5, timeout=20_000)
    folder = folder_of(lane)
    os.kill(lane.pid, signal.SIGKILL)
    finish(qtbot, lane)
    assert answers.got[0][0] == "failed"
    assert not folder.exists()


def test_a_killed_lane_leaves_nothing_even_without_an_event_loop(qtbot: Any) -> None:
    lane, answers = Lane("short"), Answers()
    answers.run(lane, "pictures_for_ever", offers={"channel": "channel"})
    qtbot.wait(1000)
    folder = folder_of(lane)
    lane.close()
    assert answers.got == [("cancelled", None)]
    lane.wait_until_closed()
    assert not folder.exists()


def test_a_job_begun_before_the_end_of_the_process_was_told_runs_in_another_one(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    answers.run(lane, "double", 1)
    finish(qtbot, lane)
    assert lane._process is not None
    os.kill(lane.pid, signal.SIGKILL)
    assert lane._process._process.waitForFinished(5000)  # and no turn of the event loop
    answers.run(lane, "double", 2)
    finish(qtbot, lane)
    assert answers.got == [("done", 2), ("done", 4)]


def test_frames_nobody_waits_for_are_freed(tmp_path: Path) -> None:
    data = wire.frame(Kind.EVENT, 1, np.zeros(1 << 21, np.uint8), tmp_path)
    assert len(data) < 1000 and len(list(tmp_path.iterdir())) == 1
    wire.forget(data[wire.HEAD.size :])
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_sent_leaves_no_file(tmp_path: Path) -> None:
    with pytest.raises(Exception, match=r"lambda|local"):
        wire.frame(Kind.DONE, 1, (np.zeros(1 << 21, np.uint8), lambda: None), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_without_room_in_memory_arrays_go_through_the_pipe(tmp_path: Path) -> None:
    data = wire.frame(Kind.DONE, 1, np.ones(1 << 21, np.uint8), tmp_path / "gone")
    assert wire.value_of(data[wire.HEAD.size :]).sum() == 1 << 21


def test_what_a_job_prints_is_not_taken_for_a_message(qtbot: Any, lane: Lane, capfd: Any) -> None:
    answers = Answers()
    answers.run(lane, "prints")
    finish(qtbot, lane)
    assert answers.got == [("done", 0)]
    assert "written to the first descriptor" in capfd.readouterr().err


def test_a_job_cancelled_before_the_first_process_was_started_never_begins(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    lane.task_started.connect(Task.cancel)
    answers.run(lane, "double", 1)
    assert answers.got == [], "told before whoever asked could know of the task"
    finish(qtbot, lane)
    assert answers.got == [("cancelled", None)]
    assert lane.pid == 0


def test_a_lane_closed_by_whoever_hears_that_a_job_begins_runs_nothing(qtbot: Any, lane: Lane) -> None:
    answers = Answers()
    lane.task_started.connect(lane.close)
    answers.run(lane, "double", 1)
    qtbot.wait(10)
    assert not lane.busy and lane.pid == 0


def test_messages_come_while_somebody_is_asked_within_another_message(qtbot: Any, lane: Lane) -> None:
    answers, heard = Answers(), []
    task = answers.run(lane, "watched", 5, offers={"progress": "progress", "watch": "watch"})

    def ask(value: int) -> None:
        heard.append(value)
        if value == 0:
            qtbot.waitUntil(lambda: heard == [0, 1, 2, 3, 4], timeout=10_000)

    task.reported.connect(ask)
    finish(qtbot, lane)
    assert heard == [0, 1, 2, 3, 4]
    assert answers.got == [("done", 5)]


def test_lanes_start_no_thread_in_the_window(qtbot: Any, lane: Lane) -> None:
    before = threading.enumerate()
    Answers().run(lane, "double", 1)
    finish(qtbot, lane)
    assert threading.enumerate() == before


def test_closing_a_lane_does_not_wait_for_its_process(qtbot: Any, bench: Bench) -> None:
    lane, answers = Lane("deaf"), Answers()
    answers.run(lane, "deaf")
    qtbot.wait(500)
    begun = time.monotonic()
    lane.close()
    assert time.monotonic() - begun < ENDS_WITHIN_MS / 2000
    lane.wait_until_closed()


def test_a_window_that_is_killed_ends_its_workers_which_keep_what_they_have(tmp_path: Path) -> None:
    if not hasattr(signal, "SIGKILL"):
        pytest.skip("no SIGKILL here")
    window = subprocess.Popen([sys.executable, "-c", _WINDOW, str(tmp_path)])
    began, kept = tmp_path / "began", tmp_path / "kept"
    _until(lambda: began.exists() and began.read_text())
    worker = int(began.read_text())
    (memory,) = (Path(part) for part in _arguments(worker) if "trisect-" in part)
    window.kill()
    window.wait()
    _until(kept.exists)
    _until(lambda: not Path(f"/proc/{worker}").exists())
    assert not memory.exists()


def test_a_worker_whose_threads_still_compute_ends_without_a_crash(tmp_path: Path) -> None:
    said = wire.frame(Kind.SETUP, 0, ((), None)) + wire.frame(
        Kind.RUN, 1, (Job("tests.workbench.lane_jobs:leaves_threads_that_compute"), (), {})
    )
    worker = [sys.executable, "-m", "workbench.work.worker", "alone", str(tmp_path / "memory")]
    for _ in range(3):
        ended = subprocess.run(worker, input=said, capture_output=True, timeout=30)
        assert (ended.returncode, ended.stderr) == (0, b"")


@pytest.mark.slow
def test_a_live_picture_of_10_mb_costs_the_gui_thread_about_half_a_millisecond(qtbot: Any, lane: Lane) -> None:
    answers, count, spent = Answers(), 50, [0.0]
    began = [0.0]
    task = answers.run(lane, "pictures_shown", count, offers={"channel": "channel"})

    def show(picture: Any) -> None:
        if not began[0]:
            began[0] = time.thread_time()  # the first picture has waited for the process
        spent[0] = time.thread_time() - began[0]
        task.shown()

    task.view.connect(show)
    # An event loop: waitUntil would ask every 10 ms, and cost as much.
    qtbot.waitSignal(task.ended, timeout=60_000).wait()
    assert answers.got == [("done", None)]
    print(f"{1e3 * spent[0] / (count - 1):.2f} ms for each picture")
    assert spent[0] / (count - 1) < 0.002, "copying 10 MB alone takes 3 ms"


def _until(true: Any, seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def _arguments(pid: int) -> list[str]:
    return Path(f"/proc/{pid}/cmdline").read_text().split("\0")


_WINDOW = """
import sys
from PySide6.QtCore import QCoreApplication
from workbench.work.tasks import Lane
from workbench.work.jobs import Job
app = QCoreApplication([])
lane = Lane("orphan")
job = Job("tests.workbench.lane_jobs:until_the_window_is_gone")
lane.run(lane, job, sys.argv[1], label="wait", on_done=print, offers={"channel": "channel"})
app.exec()
"""
