from __future__ import annotations

import logging
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from workbench.notices import Level, Notices, log_to_file


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
