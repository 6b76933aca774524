"""Compiled loops are made ready by two processes, once."""

import subprocess
import sys

import pytest

from core import compiled
from core.errors import Cancelled
from core.pipeline.compile_ahead import compile_ahead
from core.pipeline.live.warm_up import stages
from core.pipeline.project import sample_project

START = subprocess.Popen


@pytest.fixture
def started(monkeypatch, tmp_path):
    """The processes that were started; each runs the program set as `started.program` in place of compiling."""

    class Started(list):
        program = "pass"

    processes = Started()

    def start(command, **options):
        processes.append(START([sys.executable, "-c", processes.program]))
        return processes[-1]

    monkeypatch.setattr(compiled, "FOLDER", tmp_path)
    monkeypatch.setattr(compiled, "_USUAL", tmp_path)
    monkeypatch.setattr(subprocess, "Popen", start)
    return processes


def test_two_processes_make_ready_and_later_none(started):
    told = []
    compile_ahead(lambda step, done, total: told.append((done, total)))
    assert len(started) == 2
    assert told[-1][0] == told[-1][1]
    compile_ahead()
    assert len(started) == 2


def test_what_was_compiled_in_idle_time_is_not_made_ready_again(started):
    stages()[-1]()
    compile_ahead()
    assert not started


def test_the_sample_is_made_once_all_is_ready(monkeypatch, tmp_path):
    def cancel(progress):
        raise Cancelled

    monkeypatch.setattr(sample_project, "compile_ahead", cancel)
    with pytest.raises(Cancelled):
        sample_project.sample_project(tmp_path / "sample")
    assert not list(tmp_path.iterdir())


def test_what_failed_is_tried_again_next_time(started):
    started.program = "raise SystemExit(1)"
    compile_ahead()
    compile_ahead()
    assert len(started) == 4


def test_cancelled_it_leaves_no_process_behind(started):
    started.program = "import time; time.sleep(600)"

    def cancel(step, done, total):
        raise Cancelled

    with pytest.raises(Cancelled):
        compile_ahead(cancel)
    assert [process.poll() is None for process in started] == [False, False]
    assert not compiled.is_complete()


def test_a_process_that_compiles_ends_in_order_while_its_standard_input_is_open():
    program = (
        "import threading; from core.pipeline.compile_ahead import _end_with_the_first as watch;"
        "threading.Thread(target=watch, daemon=True).start()"
    )
    process = START([sys.executable, "-c", program], stdin=subprocess.PIPE)
    with process:
        assert process.wait(60) == 0


def test_a_process_that_compiles_ends_with_the_one_that_began_it():
    program = "from core.pipeline.compile_ahead import _end_with_the_first as watch; watch()"
    process = START([sys.executable, "-c", program], stdin=subprocess.PIPE)
    process.stdin.close()
    assert process.wait(60) == 1
