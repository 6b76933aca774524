"""Frames of a recording at the rate of a camera."""

from __future__ import annotations

import time
from collections.abc import Callable


class Pace:
    """Clock that tells when the next frame of a recording is due.

    A reader that comes late gets its frame at once, and the following ones at the rate from then on: nothing of a
    recording is lost.

    Parameters
    ----------
    rate_hz
        Frames per second; 0: as fast as they are read.
    clock, sleep
        Time in s that only runs forward, and how to wait.
    """

    def __init__(
        self,
        rate_hz: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.rate_hz = rate_hz
        self._clock, self._sleep = clock, sleep
        self._last: float | None = None

    def restart(self) -> None:
        """Restart the clock: the next frame is due at once."""
        self._last = None

    def wait(self, timeout_s: float) -> bool:
        """Wait until the next frame is due, at most `timeout_s`; returns whether it is due."""
        now = self._clock()
        due = now if self._last is None or self.rate_hz <= 0 else max(now, self._last + 1 / self.rate_hz)
        if due - now > timeout_s:
            self._sleep(timeout_s)
            return False
        if due > now:
            self._sleep(due - now)
        self._last = due
        return True
