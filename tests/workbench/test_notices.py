from __future__ import annotations

import logging
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from core.errors import InputError
from core.messages import plain
from workbench.app import build_window
from workbench.bench import Bench
from workbench.main_window import MainWindow
from workbench.notices import Level, Notices, log_to_file
from workbench.work import jobs
from workbench.work.tasks import Task


@pytest.fixture
def notices(qapp: Any) -> Notices:
    return Notices()


def test_an_exception_on_any_thread_becomes_one_notice_with_details(notices: Notices, qtbot: Any) -> None:
    notices.catch_everything()
    try:

        def fail() -> None:
            raise ZeroDivisionError("in a thread")

        thread = threading.Thread(target=fail)
        thread.start()
        thread.join()
        qtbot.waitUntil(lambda: bool(notices.all), timeout=2000)
    finally:
        notices.release()
    (notice,) = notices.all
    assert notice.level is Level.ERROR
    assert "ZeroDivisionError: in a thread" in notice.details


def test_releasing_gives_the_hooks_back(notices: Notices) -> None:
    before = sys.excepthook, threading.excepthook, sys.unraisablehook
    notices.catch_everything()
    assert sys.excepthook != before[0]
    notices.release()
    assert (sys.excepthook, threading.excepthook, sys.unraisablehook) == before


def test_notices_are_written_to_a_log_file(notices: Notices, tmp_path: Path, usual_log: None) -> None:
    path = log_to_file(tmp_path)
    assert path is not None
    notices.error("the disk is full", "details")
    for handler in logging.getLogger("trisect").handlers:
        handler.flush()
    text = path.read_text(encoding="utf-8")
    assert "the disk is full" in text
    assert "details" in text


def test_where_no_log_can_be_written_the_program_goes_on(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert log_to_file(tmp_path / "file" / "log") is None


@pytest.mark.parametrize(("begun", "there"), [(jobs.FIND_VIEWS, False), (jobs.MEASURE_SCAN, True)])
def test_the_banner_of_a_failed_job_goes_as_that_job_begins_anew(
    window: MainWindow, begun: jobs.Job, there: bool
) -> None:
    window.show()
    window.bench.notices.failed(
        InputError(plain("the board shows 17 × 12 inner corners, not 18 × 12")), jobs.FIND_VIEWS
    )
    assert window.welcome.banner.isVisible()
    task = Task(window.bench.measuring, window, 1, begun, "Camera")
    window.bench.measuring.task_started.emit(task)
    window.bench.measuring.task_ended.emit(task)
    assert window.welcome.banner.isVisible() == there
    assert window.notice_list.count() == 1, "it stays among the messages"


def test_a_notice_from_before_the_window_is_there_is_shown_in_it(bench: Bench, qapp: Any) -> None:
    bench.notices.warning("The wing lab cannot be used.")
    window = build_window(qapp, bench, "light")
    assert window.notice_list.count() == 1 and not window.welcome.banner.isHidden()
    bench.close()
    window.deleteLater()
