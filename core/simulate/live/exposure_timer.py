"""Exposure times of a simulated camera: in a time of its own, or at a fixed rate with exposures that are missed."""

from __future__ import annotations

from collections.abc import Callable
from math import floor

RATE_HZ = 12.0
"""Frames a second: near the 14 of the paper's camera."""


class ExposureTimer:
    """Counter of the exposures of a camera.

    It has a time of its own, that goes on by 1/12 s with each frame that is delivered, and no faster than the clock:
    where machine or reader are slow, so is that time, and nothing is missed. With a rate of 0 it goes on as fast as
    frames are delivered. With any other rate its time is the clock's, as a real camera's is.

    Parameters
    ----------
    clock
        Time in s that only runs forward.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._origin = clock()
        self._rate, self._paced, self._hurried = RATE_HZ, False, False
        self._base_number, self._base_s = 0, 0.0
        self._last = self._delivered = -1
        self._forgiven = True
        self._exposed_at = float("-inf")

    def start(self) -> None:
        """Restart the timer: the next exposure has number 0 and time 0 s."""
        self._origin = self._clock()
        self._base_number, self._base_s = 0, 0.0
        self._last = self._delivered = -1
        self._forgiven = True

    def set_rate(self, rate_hz: float) -> None:
        """Set the exposures' rate in Hz; 0 exposes as fast as frames are delivered."""
        self.skip()
        now = self.now()
        self._base_number, self._base_s = self._last + 1, now
        self._rate, self._paced, self._hurried = rate_hz or RATE_HZ, rate_hz > 0, rate_hz == 0
        self._origin = self._clock() - now

    @property
    def is_paced(self) -> bool:
        """Whether the simulated time follows the clock, instead of waiting for each frame to be delivered."""
        return self._paced

    def now(self) -> float:
        """Return the simulated time in s since the start."""
        return self._clock() - self._origin if self._paced else self.time_of(self._delivered + 1)

    def time_of(self, number: int) -> float:
        """Compute the time of exposure `number`, in s since the start."""
        return self._base_s + (number - self._base_number) / self._rate

    def wait_s(self) -> float:
        """Compute the time in s until the next exposure is due; 0 or less if it is due."""
        if self._paced:
            return self.time_of(self._last + 1) - self.now()
        return 0.0 if self._hurried else self._exposed_at + 1 / self._rate - self._clock()

    def late_s(self) -> float:
        """Compute how many s the clock is ahead of a simulated time that waits for a frame; else 0."""
        return 0.0 if self._paced or self._hurried or self._forgiven else max(0.0, -self.wait_s())

    def expose(self) -> tuple[int, int]:
        """Count the exposure that is due; returns its number, and the number of exposures missed before it."""
        number = self._last + 1
        if self._paced:
            due = self._base_number + floor((self.now() - self._base_s) * self._rate)
            number = max(number, due)
        lost = 0 if self._forgiven else number - self._last - 1
        self._last, self._forgiven, self._exposed_at = number, False, self._clock()
        return number, lost

    def delivered(self) -> None:
        """Record that the frame of the last exposure has been read."""
        self._delivered = self._last

    def skip(self) -> None:
        """Discard the exposures due up to now: the next one comes later, and none of these counts as missed."""
        self._forgiven = True
        if self._paced:
            self._last = max(self._last, self._base_number + floor((self.now() - self._base_s) * self._rate))
        else:
            self._last = self._delivered
