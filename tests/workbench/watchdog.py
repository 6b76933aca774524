"""Measures how long the GUI thread is away from its event loop, and what it does there.

A heartbeat beats every few milliseconds. Between two beats the GUI thread handles whatever came; the processor time it
spends on that is what it kept the technician waiting for. Processor time, not the clock: on a machine with fewer
cores than processes the clock also counts the time the system gave to somebody else. Both are kept. A signal looks now
and then where the GUI thread is, so that the cause of a long absence can be told. (Another thread that looks at the
GUI thread's frames crashes Python 3.11.)
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any

from PySide6.QtCore import QObject, QTimer

BEAT_MS = 5
LOOK_S = 0.008
CHANGES_MS = 0.5
"""A thread that was busy for less has not got into another situation; to ask would take longer than that."""
DEPTH = 7
ROOT = Path(__file__).parents[2]


@dataclass(frozen=True, slots=True)
class Absence:
    """One stretch between two beats, in ms; `during` names the situation, `where` the lines it was seen at."""

    busy_ms: float
    clock_ms: float
    at_s: float
    during: str = ""
    where: tuple[str, ...] = ()

    def __str__(self) -> str:
        lines = "".join(f"\n      {line}" for line in self.where)
        return f"{self.busy_ms:.0f} ms ({self.clock_ms:.0f} by the clock) at {self.at_s:.1f} s, {self.during}{lines}"


class Watchdog(QObject):
    """A context: watches the GUI thread from entering to leaving it.

    Parameters
    ----------
    during
        Names the situation, for the report.
    stacks
        Look where the GUI thread is; costs it a little time.
    keep_ms
        Shorter stretches are forgotten: a long watch must not fill the memory it watches.
    """

    def __init__(self, during: Callable[[], str] = lambda: "", *, stacks: bool = True, keep_ms: float = 0.0) -> None:
        super().__init__()
        self._timer = QTimer(self)
        self._timer.setInterval(BEAT_MS)
        self._timer.timeout.connect(self._beat)
        self._during, self._stacks, self._keep_ms = during, stacks, keep_ms
        self._situation = ""
        self._seen: list[tuple[str, ...]] = []
        self._before: Any = None
        self.absences: list[Absence] = []

    @property
    def longest_ms(self) -> float:
        """The longest time the GUI thread was busy in one go."""
        return max((absence.busy_ms for absence in self.absences), default=0.0)

    def worst(self, count: int = 5) -> list[Absence]:
        """The longest absences."""
        return sorted(self.absences, key=lambda absence: -absence.busy_ms)[:count]

    def longer_than(self, limit_ms: float) -> list[Absence]:
        """Absences longer than that, the longest first."""
        return [absence for absence in self.worst(len(self.absences)) if absence.busy_ms > limit_ms]

    def __enter__(self) -> Watchdog:
        self._started = time.perf_counter()
        self._busy, self._clock = time.thread_time(), self._started
        self._situation = self._during()
        self._timer.start()
        if self._stacks and hasattr(signal, "setitimer"):
            self._before = signal.signal(signal.SIGALRM, self._look)
            signal.setitimer(signal.ITIMER_REAL, LOOK_S, LOOK_S)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._timer.stop()
        if self._before is not None:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, self._before)

    def _beat(self) -> None:
        busy, clock = time.thread_time(), time.perf_counter()
        seen, self._seen = self._seen, []
        away = 1e3 * (busy - self._busy)
        where = tuple(dict.fromkeys(" < ".join(stack) for stack in seen if stack)) if away > 20 else ()
        if away >= self._keep_ms:
            self.absences.append(
                Absence(away, 1e3 * (clock - self._clock), clock - self._started, self._situation, where[:12])
            )
        if away >= CHANGES_MS:
            self._situation = self._during()
        self._busy, self._clock = time.thread_time(), time.perf_counter()

    def _look(self, number: int, frame: FrameType | None) -> None:
        lines: list[str] = []
        while frame is not None and len(lines) < DEPTH:  # by hand: the traceback module would take longer than a beat
            code = frame.f_code
            if not any(part in code.co_filename for part in ("/tests/", "pytest", "pluggy", "watchdog")):
                lines.append(f"{Path(code.co_filename).name}:{frame.f_lineno} {code.co_name}")
            frame = frame.f_back
        self._seen.append(tuple(lines))


STRICT = os.environ.get("TRISECT_STRICT_CLOCK") == "1"
"""Hold the window to its promise of 50 ms: on a quiet machine. A shared one, whose processor's caches belong to others
half of the time, is given four times as long; a window that really blocks is away for longer than that."""

LIMIT_MS = 50.0 if STRICT else 200.0
"""The GUI thread may be busy for so long in one go."""

SCENE_LIMIT_MS = 150.0 if STRICT else 600.0
"""The same while 3D is set up or drawn by software OpenGL, which draws in the GUI thread; a graphics card does not."""

_NOMINAL_S = 0.004


def slowness() -> float:
    """How many times slower than the reference this machine is just now; at least 1."""
    return max(1.0, min(_reference_s() for _ in range(5)) / _NOMINAL_S)


def too_long(dog: Watchdog, slower: float) -> list[str]:
    """The absences that keep a technician waiting, told with their causes."""
    return [
        str(absence)
        for absence in dog.longer_than(LIMIT_MS * slower)
        if not any("views/scene" in line for line in absence.where) or absence.busy_ms > SCENE_LIMIT_MS * slower
    ]


def _reference_s() -> float:
    begun = time.thread_time()
    total = 0
    for number in range(100_000):
        total += number % 7
    return time.thread_time() - begun
