"""Measures how long the GUI thread is away from its event loop.

A heartbeat beats every few milliseconds. Between two beats the GUI thread handles whatever came; the processor time it
spends on that is what it kept the technician waiting for. Processor time, not the clock: on a machine with fewer
cores than processes the clock also counts the time the system gave to somebody else. Both are kept.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from types import TracebackType

from PySide6.QtCore import QObject, QTimer

BEAT_MS = 5


@dataclass(frozen=True, slots=True)
class Absence:
    """One stretch between two beats, in ms."""

    busy_ms: float
    clock_ms: float
    at_s: float


class Watchdog(QObject):
    """A context: watches the GUI thread from entering to leaving it."""

    def __init__(self) -> None:
        super().__init__()
        self._timer = QTimer(self)
        self._timer.setInterval(BEAT_MS)
        self._timer.timeout.connect(self._beat)
        self.absences: list[Absence] = []

    @property
    def longest_ms(self) -> float:
        """The longest time the GUI thread was busy in one go."""
        return max((absence.busy_ms for absence in self.absences), default=0.0)

    def worst(self, count: int = 5) -> list[Absence]:
        """The longest absences."""
        return sorted(self.absences, key=lambda absence: -absence.busy_ms)[:count]

    def __enter__(self) -> Watchdog:
        self._started = time.perf_counter()
        self._busy, self._clock = time.thread_time(), self._started
        self._timer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._timer.stop()

    def _beat(self) -> None:
        busy, clock = time.thread_time(), time.perf_counter()
        self.absences.append(Absence(1e3 * (busy - self._busy), 1e3 * (clock - self._clock), clock - self._started))
        self._busy, self._clock = busy, clock
