"""`pytest -p tests.time_left`: what would begin after TRISECT_TRY_UNTIL, in seconds since 1970, is not tried.

A run with a limit, which would be ended amid its proofs and say nothing, tells so how many it had no time for. The
first few, which a change is nearest to, are tried whatever the time. A run in which none has passed is red.
"""

from __future__ import annotations

import os
import time

import pytest

AT_LEAST = 20
"""Tests that are tried however late it is: proofs of some 10 s each, two at a time, take two minutes."""
LATE = "NOT TRIED for want of time"
_FIRST = pytest.StashKey[set[str]]()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep which come first, of those that are left."""
    config.stash[_FIRST] = {item.nodeid for item in items[:AT_LEAST]}


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Leave out what would begin too late."""
    until = os.environ.get("TRISECT_TRY_UNTIL", "")
    if until and time.time() > float(until) and item.nodeid not in item.config.stash[_FIRST]:
        pytest.skip(LATE)


def _counts(config: pytest.Config) -> tuple[int, int, int]:
    """How many there were to try, have passed, and were not tried; what this machine lacks something for is none."""
    told = config.pluginmanager.get_plugin("terminalreporter")
    ended = told.stats if told else {}
    passed, others = len(ended.get("passed", [])), sum(len(ended.get(one, [])) for one in ("failed", "error"))
    late = sum(LATE in str(report.longrepr) for report in ended.get("skipped", []))
    return passed + others + late, passed, late


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Nothing is proven where all was left out."""
    touched, passed, _ = _counts(session.config)
    if touched and not passed and not hasattr(session.config, "workerinput"):
        session.exitstatus = session.exitstatus or pytest.ExitCode.TESTS_FAILED


def pytest_unconfigure(config: pytest.Config) -> None:
    """Say it last, for a reader of the log and for `.ci/run`."""
    if not hasattr(config, "workerinput"):
        print("touched {}, passed {}, NOT TRIED {}".format(*_counts(config)), flush=True)
