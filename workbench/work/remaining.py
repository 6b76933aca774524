"""How much of a job is left, in words.

Jobs report stages one after another, and how long the later ones take is not in any of them. So the durations of the
last run of the same job are remembered, and stretched by how the stages done so far compare with them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping


class Remaining:
    """Follows one job.

    Parameters
    ----------
    remembered
        Seconds of each stage the last time; empty for the first time.
    clock
        Seconds; for tests.
    """

    def __init__(self, remembered: Mapping[str, float], clock: Callable[[], float] = time.monotonic) -> None:
        self._remembered, self._clock = dict(remembered), clock
        self._stage, self._begun, self._share = "", clock(), 0.0
        self.seconds: dict[str, float] = {}

    def tell(self, stage: str, done: int, total: int) -> None:
        """The job's progress."""
        if stage != self._stage:
            self._close()
            self._stage, self._begun = stage, self._clock()
        self._share = done / total if total else 0.0

    def finish(self) -> dict[str, float]:
        """The job is done: seconds of each stage, to be remembered."""
        self._close()
        self._stage = ""
        return self.seconds

    @property
    def share(self) -> float | None:
        """How much of the whole job is done, 0 … 1, or None where that is not known."""
        left = self.left
        if left is None:
            return None
        spent = sum(self.seconds.values()) + self._clock() - self._begun
        return spent / (spent + left) if spent + left > 0 else None

    @property
    def left(self) -> float | None:
        """Seconds left, or None while nothing can be said."""
        in_stage = self._clock() - self._begun
        remembered = self._remembered.get(self._stage)
        if self._share > 0.05 and in_stage > 0.5:
            of_stage = in_stage * (1 - self._share) / self._share
        elif remembered is not None:
            of_stage = max(remembered * self._pace - in_stage, 0.0)
        else:
            return None
        later = [s for name, s in self._remembered.items() if name != self._stage and name not in self.seconds]
        return of_stage + sum(later) * self._pace

    @property
    def _pace(self) -> float:
        """How much slower than the last time the finished stages were."""
        both = [name for name in self.seconds if self._remembered.get(name, 0) > 0]
        before = sum(self._remembered[name] for name in both)
        return min(max(sum(self.seconds[name] for name in both) / before, 0.3), 3.0) if before > 1 else 1.0

    def _close(self) -> None:
        if self._stage:
            spent = self._clock() - self._begun
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + spent


def in_words(seconds: float) -> str:
    """A rough duration as one says it: "12 s", "2 min"."""
    if seconds < 60:
        return f"{max(1, round(seconds))} s"
    return f"{round(seconds / 60)} min"
