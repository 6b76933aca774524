"""An exception anywhere is one notice with details to copy and an entry of the log; the program goes on."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QRunnable, Qt, QThreadPool, QTimer
from PySide6.QtWidgets import QPushButton

from tests.workbench.technician import Technician
from workbench.notices import Level, Notice, log_to_file
from workbench.work.jobs import Job

pytestmark = pytest.mark.qt_no_exception_capture


@pytest.fixture
def log_file(tmp_path: Path, usual_log: None) -> Path:
    """Where the program logs to."""
    path = log_to_file(tmp_path / "log")
    assert path is not None
    return path


@pytest.fixture
def t(technician: Technician, log_file: Path) -> Iterator[Technician]:
    """A technician at a program that catches what nobody else does, as the real one."""
    technician.bench.notices.catch_everything()
    yield technician
    technician.bench.notices.release()


def break_down(*_: Any) -> None:
    raise ZeroDivisionError("nothing goes into nothing")


def errors(t: Technician) -> list[Notice]:
    return [notice for notice in t.bench.notices.all if notice.level is Level.ERROR]


def in_a_slot(t: Technician) -> None:
    button = QPushButton(t.window)
    button.clicked.connect(break_down)
    button.click()


def in_a_timer(t: Technician) -> None:
    QTimer.singleShot(0, break_down)


def in_a_thread(t: Technician) -> None:
    thread = threading.Thread(target=break_down)
    thread.start()
    thread.join()


def in_a_runnable(t: Technician) -> None:
    class Work(QRunnable):
        def run(self) -> None:
            break_down()

    QThreadPool.globalInstance().start(Work())
    QThreadPool.globalInstance().waitForDone(2000)


def in_a_job(t: Technician) -> None:
    t.bench.run_long(t.window, Job("tests.workbench.lane_jobs:crash"), label="crash", on_done=lambda _: None)


def in_what_follows_a_job(t: Technician) -> None:
    t.bench.run_long(t.window, Job("tests.workbench.lane_jobs:double"), 2, label="double", on_done=break_down)


SOMEWHERE: tuple[Callable[[Technician], None], ...] = (
    *(in_a_slot, in_a_timer, in_a_thread, in_a_runnable),
    *(in_a_job, in_what_follows_a_job),
)


def test_an_exception_is_one_notice_and_a_log_entry_and_the_program_goes_on(t: Technician, log_file: Path) -> None:
    banner = t.window.welcome.banner
    for count, somewhere in enumerate(SOMEWHERE, 1):
        banner.hide()
        somewhere(t)
        t.until(lambda: len(errors(t)) >= count, f"a notice of what happened {somewhere.__name__}")  # noqa: B023  asked at once
        t.idle()
        assert len(errors(t)) == count, somewhere.__name__
        notice = errors(t)[-1]
        assert notice.text.startswith(
            "Something went wrong in the program; your work is kept. Details: ZeroDivisionError"
        ), somewhere.__name__
        assert "ZeroDivisionError: nothing goes into nothing" in notice.details, somewhere.__name__
        assert "break_down" in notice.details or "lane_jobs.py" in notice.details, somewhere.__name__
        assert banner.isVisible() and banner.text() == notice.text, somewhere.__name__
        assert log_file.read_text(encoding="utf-8").count("Traceback") == count, somewhere.__name__
    t.new_project("afterwards")
    t.type_in(t.field("Part"), "Block")
    assert t.model.project.info.part == "Block"
    t.model.save()


def kill_process_of(lane: Any) -> None:
    os.kill(lane.pid, signal.SIGKILL)


def test_a_process_that_is_killed_comes_back_and_the_middle_of_a_job_is_told(
    t: Technician, measured_project: Path
) -> None:
    t.window.projects.open_project(measured_project)
    t.window.go_to("camera")
    t.idle()
    kill_process_of(t.bench.quick)
    t.until(lambda: t.bench.quick.pid == 0, "the end of the process that reads pictures to be noticed")
    t.window.go_to("scan")
    t.until(lambda: t.presenter().scrub.up_to_date and t.presenter().work.look is not None, "the scan to be shown")
    t.idle()
    assert errors(t) == []

    scanned = t.model.results["scan"]
    t.press("Measure again")
    told: list[str] = []
    t.bench.measuring.current.progressed.connect(lambda stage, *_: told.append(stage))  # type: ignore[union-attr]
    t.until(lambda: "frames" in told, "the frames to be measured")
    kill_process_of(t.bench.measuring)
    t.until(lambda: errors(t), "a notice")
    assert "ended unexpectedly" in errors(t)[0].text
    assert t.model.results["scan"] is scanned
    t.shortcut(Qt.Key.Key_R)
    t.until(lambda: t.model.results["scan"].at > scanned.at, "the scan measured again", 60)
    t.idle()
    assert len(errors(t)) == 1
