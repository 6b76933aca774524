"""A whole run with a second process: the same bytes, and one sentence where that process dies."""

import json
import os
import signal
import sys
from contextlib import suppress

import pytest

from core.errors import Cancelled, InputError
from core.pipeline.run import run
from core.second_process import SecondProcess
from core.settings.options import Options
from tests.simulated import contents
from tests.test_second_process import ROOT, process_of

COARSE = Options(sigma_cut_mm=5.0)
TIMES = ("measured_at", "made_at", "timings_s")


@pytest.fixture
def beside(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))  # where it finds the call that tells who it is
    with SecondProcess() as process:
        yield process


@pytest.mark.accuracy
def test_alone_and_with_a_second_process_the_results_are_the_same_bytes(tiny_set, beside, tmp_path):
    heard = []
    run(tiny_set, tmp_path / "alone", COARSE)
    run(tiny_set, tmp_path / "two", COARSE, lambda step, done, total: heard.append(step), beside)
    alone, two = contents(tmp_path / "alone"), contents(tmp_path / "two")
    assert alone.keys() == two.keys()
    records = [json.loads(files.pop("run.json")) for files in (alone, two)]
    for record in records:
        for times in TIMES:
            del record[times]
    assert records[0] == records[1]
    for files in (alone, two):
        assert files.pop("report.pdf").startswith(b"%PDF")  # prints the time
    assert alone == two
    assert {"camera views", "plane poses", "network", "report"} <= set(heard)


@pytest.mark.skipif(sys.platform == "win32", reason="ends by a signal of POSIX")
def test_a_second_process_that_is_killed_leaves_whole_files_and_one_sentence(tiny_set, beside, tmp_path):
    _, pid = beside.submit(process_of, None).result()

    def progress(step, done, total):
        if step == "plane poses":
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    with pytest.raises(InputError, match="second process") as told:
        run(tiny_set, tmp_path, COARSE, progress, beside)
    assert str(told.value).count(".") == 1
    assert_whole(tmp_path)


def test_cancelled_while_the_second_process_looks_at_the_scan_nothing_is_half_written(tiny_set, beside, tmp_path):
    def progress(step, done, total):
        if step == "plane poses":
            raise Cancelled

    with pytest.raises(Cancelled):
        run(tiny_set, tmp_path, COARSE, progress, beside)
    assert_whole(tmp_path)


def assert_whole(out):
    """Camera and record are there, nothing of the scan, and no other file."""
    assert {path.name for path in out.iterdir()} == {"camera.json", "run.json"}
    assert json.loads((out / "run.json").read_text())["timings_s"].keys() == {"camera"}
