"""Whatever asks a command to end, it ends in order: a sentence, a code of its own, whole files, no process left."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from core.cli.bar import bar
from core.errors import Cancelled
from core.simulate import recording
from tests.simulated import trisect

ASKED = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129}
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
SOON_S = 60.0


@pytest.fixture(autouse=True)
def heard():
    """Signals as a terminal leaves them: run by `nohup`, tests and what they start would ignore SIGHUP."""
    if sys.platform == "win32":
        yield
        return
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("name", ["SIGINT", pytest.param("SIGTERM", marks=POSIX), pytest.param("SIGHUP", marks=POSIX)])
def test_an_interrupt_lost_in_a_finaliser_still_cancels_at_the_next_progress(name):
    with bar() as progress:
        progress("frames", 0, 3)
        with contextlib.suppress(KeyboardInterrupt):  # as a finaliser would
            signal.raise_signal(getattr(signal, name))
        with pytest.raises(Cancelled):
            progress("frames", 1, 3)


def test_afterwards_an_interrupt_is_pythons_own_again():
    before = signal.getsignal(signal.SIGINT)
    with bar():
        assert signal.getsignal(signal.SIGINT) is not before
    assert signal.getsignal(signal.SIGINT) is before


@POSIX
def test_a_terminal_that_is_closed_hangs_up_twice_and_the_second_time_cuts_nothing_short():
    with bar():
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGHUP)
        signal.raise_signal(signal.SIGHUP)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)


@POSIX
def test_what_nohup_has_a_command_ignore_does_not_end_it():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with bar() as progress:
            signal.raise_signal(signal.SIGHUP)
            progress("frames", 0, 3)
    finally:
        signal.signal(signal.SIGHUP, before)


def begun(*words, until, **more):
    """A command under way: the line `until` has been said on standard error."""
    command = subprocess.Popen(
        [sys.executable, "-m", "core.cli", *map(str, words)], stderr=subprocess.PIPE, text=True,
        env=os.environ | {"TRISECT_LANGUAGE": "en", **more},
    )  # fmt: skip
    assert command.stderr is not None
    for line in command.stderr:
        if line.startswith(until):
            return command
    raise AssertionError(f"it ended with {command.wait()}")


def children_of(pid):
    """The processes that a process has started, or none where the system does not list them."""
    with contextlib.suppress(OSError):
        return [int(one) for one in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return []


def are_gone(pids):
    until = time.monotonic() + SOON_S
    while time.monotonic() < until:
        if not any(Path(f"/proc/{pid}").exists() for pid in pids):
            return True
        time.sleep(0.1)
    return False


@POSIX
@pytest.mark.parametrize("name", ASKED)
def test_a_command_ends_in_order_by_each_signal(tmp_path, monkeypatch, name):
    def half(scenario, rig, made, *_):
        (made / "scan").mkdir(parents=True)
        signal.raise_signal(getattr(signal, name))

    monkeypatch.setattr(recording, "_render", half)
    said = trisect("simulate", "block", "--out", tmp_path / "set")
    assert said.code == ASKED[name]
    assert said.sentence.startswith("trisect: interrupted;")
    assert list(tmp_path.iterdir()) == []


@POSIX
def test_a_program_ends_in_order_that_is_asked_to_by_another_one(tmp_path):
    words = ("simulate", "block", "--scale", "0.2", "--frames", "200", "--out", tmp_path / "set")
    command = begun(*words, until="calibration pictures")
    command.send_signal(signal.SIGTERM)
    told = command.communicate(timeout=SOON_S)[1]
    assert command.returncode == ASKED["SIGTERM"]
    assert told.splitlines()[-1].startswith("trisect: interrupted;")
    assert list(tmp_path.iterdir()) == []


@POSIX
@pytest.mark.parametrize("name", ["SIGTERM", pytest.param("SIGKILL", marks=pytest.mark.accuracy)])
def test_while_it_compiles_a_command_leaves_no_process_behind(simulated, tmp_path, name):
    """Those that compile are ended, and where the command is killed they end by themselves."""
    words = ("run", simulated, "--out", tmp_path / "out")
    command = begun(*words, until="preparing", NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    children = children_of(command.pid)
    assert len(children) >= 2
    command.send_signal(getattr(signal, name))
    told = command.communicate(timeout=SOON_S)[1]
    assert command.returncode == {"SIGTERM": 143, "SIGKILL": -signal.SIGKILL}[name]
    assert name == "SIGKILL" or told.splitlines()[-1].startswith("trisect: interrupted;")
    assert are_gone(children)
    assert not list((tmp_path / "out").iterdir())


@POSIX
def test_a_batch_that_is_killed_leaves_no_process_behind_and_one_that_is_told_nothing_half_written(simulated, tmp_path):
    out = tmp_path / "out"
    for name in ("SIGTERM", "SIGKILL"):
        command = begun("batch", simulated, "--out", out, "--workers", "1", until="measuring sets")
        until = time.monotonic() + SOON_S
        while not (out / simulated.name / ".new").exists() and time.monotonic() < until:
            time.sleep(0.05)
        children = children_of(command.pid)
        command.send_signal(getattr(signal, name))
        told = command.communicate(timeout=SOON_S)[1]
        assert are_gone(children)
        if name == "SIGTERM":
            assert command.returncode == 143
            assert told.splitlines()[-1].startswith("trisect: interrupted;")
            assert not [path for path in out.rglob("*") if path.name in (".new", ".stop") or path.suffix == ".part"]
