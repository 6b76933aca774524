"""A second process that computes: in order, told of, ended with the first one, and its end told in one sentence."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from core import files_read
from core.code_cache import code_cache
from core.errors import Cancelled, InputError
from core.files.reading import read_bytes
from core.progress import silent
from core.second_process import SecondProcess, second_process, shared_map
from core.stage_times import StageTimes

ROOT = Path(__file__).parents[1]
SOON_S = 20.0


@pytest.fixture
def beside(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))  # where it finds the calls of this file
    with SecondProcess() as process:
        yield process


def process_of(item, /, *, progress=silent):
    time.sleep(0.02)
    return item, os.getpid()


def refuse(item, /, *, progress=silent):
    raise InputError("the picture is black", where=item, todo="open the shutter")


def divide(item, /, *, progress=silent):
    return item / 0


def print_aloud(item, /, *, progress=silent):
    print(item)
    os.write(1, b"a library that mumbles\n")
    return item


def tell_and_sleep(item, /, *, progress=silent):
    progress("frames", 3, 48)
    time.sleep(item)


def sleep(item, /, *, progress=silent):
    time.sleep(item)


def work(seconds, /, *, progress=silent):
    progress("poses", 0, 1)
    until = time.process_time() + seconds
    while time.process_time() < until:
        pass


def cache_folder(item, /, *, progress=silent):
    return str(code_cache())


def read(item, /, *, progress=silent):
    return len(read_bytes(item))


def leave(item, /, *, progress=silent):
    os._exit(3)


def is_gone(pid):
    until = time.monotonic() + SOON_S
    while time.monotonic() < until:
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    return False


def test_both_processes_take_items_and_the_results_are_in_order(beside):
    beside.submit(process_of, "it has started").result()
    done = list(shared_map(process_of, range(40), beside))
    assert [item for item, _ in done] == list(range(40))
    assert len({process for _, process in done}) == 2
    assert done[0][1] == os.getpid()


def test_without_a_second_process_the_first_one_does_all():
    assert [one for one, process in shared_map(process_of, range(5), None) if process == os.getpid()] == [0, 1, 2, 3, 4]


def test_what_a_call_raises_is_raised_here(beside):
    with pytest.raises(InputError, match=r"^frame 7: the picture is black; open the shutter\.$"):
        beside.submit(refuse, "frame 7").result()
    with pytest.raises(ZeroDivisionError):
        beside.submit(divide, 1).result()
    assert beside.submit(process_of, "goes on").result()[0] == "goes on"


def test_what_a_call_reads_is_told_here(beside):
    told = []
    files_read.listen(told.append)
    try:
        assert beside.submit(read, Path(__file__)).result() == Path(__file__).stat().st_size
    finally:
        files_read.listen(None)
    assert told == [Path(__file__)]


def test_what_a_call_prints_is_no_answer(beside):
    assert beside.submit(print_aloud, "text").result() == "text"


def test_while_it_works_the_first_process_hears_how_far_it_is_and_can_cancel(beside):
    heard = []

    def until_told(*told):
        heard.append(told)
        if told != ("scan", 0, 1):
            raise Cancelled

    began = time.perf_counter()
    with pytest.raises(Cancelled):
        beside.wait(beside.submit(tell_and_sleep, 60), until_told, "scan")
    assert time.perf_counter() - began < SOON_S
    assert heard[-1] == ("frames", 3, 48)


def test_who_waits_for_a_call_that_tells_nothing_can_cancel(beside):
    def progress(*told):
        assert told == ("scan", 0, 1)
        raise Cancelled

    began = time.perf_counter()
    with pytest.raises(Cancelled):
        beside.wait(beside.submit(sleep, 60), progress, "scan")
    assert time.perf_counter() - began < SOON_S


def test_what_it_costs_is_booked_to_the_stages(beside):
    times = StageTimes()
    beside.submit(work, 0.05, times).result()
    assert times.seconds()["poses"] == pytest.approx(0.05, abs=0.03)


def test_the_end_of_the_process_is_one_sentence(beside):
    with pytest.raises(
        InputError, match=r"has ended before its work was done \(exit code 3\).*measure again\.$"
    ) as told:
        beside.submit(leave, None).result()
    assert told.value.code == "run.second_process_ended"
    with pytest.raises(InputError, match="has ended before"):
        beside.submit(process_of, "nobody there").result()


@pytest.mark.skipif(sys.platform == "win32", reason="ends by a signal of POSIX")
def test_a_killed_process_is_one_sentence_for_all_it_should_have_done(beside):
    _, pid = beside.submit(process_of, 0).result()
    calls = [beside.submit(tell_and_sleep, 60), beside.submit(process_of, 1)]
    os.kill(pid, signal.SIGKILL)
    for call in calls:
        with pytest.raises(InputError, match="exit code −9"):
            call.result(SOON_S)


def test_it_is_gone_after_the_block_whatever_it_does(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    with second_process() as process:
        assert process is not None
        _, pid = process.submit(process_of, 0).result()
        process.submit(tell_and_sleep, 60)
        waiting = process.submit(process_of, 1)
    assert is_gone(pid)
    assert waiting.cancelled()


def test_with_one_core_there_is_none(monkeypatch):
    monkeypatch.setattr("core.second_process.cores", lambda: 1)
    with second_process() as process:
        assert process is None


@pytest.mark.skipif(sys.platform == "win32", reason="ends by a signal of POSIX")
def test_it_is_gone_when_the_first_one_is_killed(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    program = (
        "from core.second_process import SecondProcess; from tests.test_second_process import *\n"
        "beside = SecondProcess(); print(beside.submit(process_of, 0).result()[1], flush=True)\n"
        "beside.submit(tell_and_sleep, 60).result()"
    )
    first = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert first.stdout is not None
    pid = int(first.stdout.readline())
    first.kill()
    first.wait()
    first.stdout.close()
    assert is_gone(pid)


def test_where_no_cache_can_be_written_both_use_the_same_temporary_one(tmp_path):
    (tmp_path / "file").touch()
    program = (
        "from core.second_process import SecondProcess; from tests.test_second_process import *\n"
        "with SecondProcess() as beside: print(beside.submit(cache_folder, 0).result())\n"
        "print(cache_folder(0))"
    )
    surroundings = os.environ | {"PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(tmp_path / "file")}
    ran = subprocess.run(
        [sys.executable, "-c", program], env=surroundings, capture_output=True, text=True, check=True
    )  # fmt: skip
    of_second, of_first = ran.stdout.split()
    assert of_second == of_first
    assert not Path(of_first).exists()
