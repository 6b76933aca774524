"""How many frames are missing, from the numbers that the camera itself gives its frames."""

from __future__ import annotations

_MOST_16_BIT = 0xFFFF
"""The largest frame number of cameras that count in 16 bits; 0 or 1 follows."""


class FrameNumbers:
    """Counts the gaps in a camera's frame numbers.

    Numbers of 16 bits (GigE Vision 1) begin again at 1 behind 65535, 0 being none. A number that goes back in another
    way is a camera that counts anew: nothing is known to be missing then.
    """

    def __init__(self) -> None:
        self._last: int | None = None

    def restart(self) -> None:
        """The next number follows nothing."""
        self._last = None

    def missing_before(self, number: int) -> int:
        """How many frames are missing between the last number and this one."""
        last, self._last = self._last, number
        if last is None or number == last:
            return 0
        if number > last:
            return number - last - 1
        wrapped = _MOST_16_BIT - last + max(number - 1, 0)
        return wrapped if last <= _MOST_16_BIT and wrapped < _MOST_16_BIT // 2 else 0
