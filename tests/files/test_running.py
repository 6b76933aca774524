"""Whether a process still runs: asked of this system, and as Windows is asked."""

import os
import subprocess
import sys
from datetime import UTC, datetime, timedelta

import pytest

from core.files.running import is_running, runs_on_windows

BEGAN = datetime(2026, 11, 23, 9, 0, tzinfo=UTC)


class Windows:
    """Answers as kernel32 would; counts open handles."""

    def __init__(self, *, there=True, denied=False, ended=False):
        self.there, self.denied, self.ended, self.open = there, denied, ended, 0

    def OpenProcess(self, access, inherit, pid):
        self.open += self.there
        return 7 if self.there else None

    def WaitForSingleObject(self, handle, ms):
        assert (handle, ms) == (7, 0)
        return 0 if self.ended else 0x102

    def GetProcessTimes(self, handle, created, *others):
        created._obj.value = int((BEGAN - datetime(1601, 1, 1, tzinfo=UTC)).total_seconds() * 1e7)
        return 1

    def CloseHandle(self, handle):
        self.open -= 1
        return 1

    def last_error(self):
        return 5 if self.denied else 87


def test_a_process_runs_until_it_has_ended():
    assert is_running(os.getpid())
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    assert not is_running(ended.pid)
    assert not is_running(0)


@pytest.mark.parametrize(
    ("windows", "runs"),
    [
        (Windows(), True),
        (Windows(ended=True), False),
        (Windows(there=False), False),
        (Windows(there=False, denied=True), True),
    ],
)
def test_windows_is_asked_without_ending_the_process(windows, runs):
    assert runs_on_windows(windows, 4711, None) is runs
    assert windows.open == 0


def test_on_windows_a_number_that_was_given_to_another_process_since_is_not_the_same_one():
    assert runs_on_windows(Windows(), 4711, BEGAN + timedelta(seconds=3))
    assert not runs_on_windows(Windows(), 4711, BEGAN - timedelta(hours=1))
