"""`pytest -p tests.time_left`: what would begin after TRISECT_TRY_UNTIL, in seconds since 1970, is not tried.

A run with a limit, which would be ended amid its proofs and say nothing, tells so how many it had no time for.
"""

from __future__ import annotations

import os
import time

import pytest


def pytest_runtest_setup() -> None:
    """Leave out what would begin too late."""
    until = os.environ.get("TRISECT_TRY_UNTIL", "")
    if until and time.time() > float(until):
        pytest.skip("NOT TRIED for want of time")
