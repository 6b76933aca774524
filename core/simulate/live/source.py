"""The simulated rig as a live source: a camera in real time, without a camera.

Pictures are made on a thread of its own, one ahead of whoever reads them. Time goes on with the frames that are read,
so a slow machine slows the sweeping hand down and loses nothing. At a rate that was set it is a real camera's: instants
for which nobody was ready (the reader was busy, or the machine too slow) are lost and counted.

The hand that holds a plate waits for who takes the pictures: each pose is held until a frame of it was dealt with.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from core.acquire.source import Capabilities, Frame, Lasers, Shown, SourceSettings
from core.simulate.live.exposure_timer import ExposureTimer
from core.simulate.live.motion import PlateMotion
from core.simulate.live.scene import LiveScene, LiveTruth, Moment

EXPOSURE_MS = 8.0
"""Exposure time of the pictures as the twin renders them; another one makes them brighter or darker in proportion."""

CAPABILITIES = Capabilities(exposure_ms=(0.01, 1000.0), gain_db=(-40.0, 80.0), rate_hz=(0.0, 10_000.0))
"""Wider than any camera's: the twin has no limits of its own."""

_LONGEST_STEP_S = 0.4
"""A plate moves on so far, at most, between two frames more than it should: it is still seen to move."""
_REMEMBERED = 240
"""Frames of which it is known what they show; who looks at one is not so far behind."""


@dataclass(frozen=True, slots=True)
class _State:
    """Shown and lasers that are on, and since when, in s."""

    step: Shown
    lasers: Lasers
    began_s: float = 0.0
    swept_s: float = 0.0
    lit_s: float = 0.0

    def lit(self, lasers: Lasers, now_s: float) -> _State:
        return replace(self, lasers=lasers, swept_s=self._sweep(now_s), lit_s=now_s)

    def at(self, number: int, time_s: float, plate_s: float) -> Moment:
        return Moment(self.step, self.lasers, plate_s, self._sweep(time_s), number)

    def _sweep(self, time_s: float) -> float:
        return self.swept_s + (max(0.0, time_s - self.lit_s) if self.lasers.hand else 0.0)


class _Exposure(NamedTuple):
    """One frame to be exposed, and the `orders` that had been given when it was due."""

    orders: int
    moment: Moment
    lost: int
    """Instants lost before it."""
    exposure: float
    gain: float


@dataclass(slots=True)
class _Hand:
    """Holds a plate: `held` is the pose it does not leave yet, `waited_s` how long it has waited so far.

    `seen` says in which rest each of the last frames was exposed.
    """

    motion: PlateMotion | None
    held: int = 0
    waited_s: float = 0.0
    seen: dict[int, int | None] = field(default_factory=dict)

    def plate_s(self, time_s: float, slow_s: float) -> float:
        """The plate's own time, `time_s` after the step began; it goes on while the machine is slow by `slow_s`."""
        if self.motion is None:
            return time_s
        self.waited_s -= min(slow_s, _LONGEST_STEP_S)
        late_s = time_s - self.waited_s - self.motion.end_of_rest(self.held)
        self.waited_s += max(0.0, late_s)
        return time_s - self.waited_s

    def shows(self, index: int, plate_s: float) -> None:
        """The frame of this index was exposed at a time of the plate."""
        self.seen[index] = None if self.motion is None else self.motion.rest_at(plate_s)
        if len(self.seen) > _REMEMBERED:
            del self.seen[min(self.seen)]

    def go_on(self, index: int) -> None:
        """The frame of this index has been dealt with."""
        if self.seen.get(index) == self.held:
            self.held += 1


class SimulatedSource:
    """Simulated rig as a :class:`core.acquire.source.FrameSource`.

    With a rate of 0 every frame is there as soon as it can be made, 1/12 s after the last one, and the same calls give
    the same pictures.

    Parameters
    ----------
    scene
        Renders its pictures.
    name
        Its name on screen.
    clock
        Time in s that only runs forward.
    """

    def __init__(
        self, scene: LiveScene, name: str = "Simulated rig", clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.name = name
        self._scene = scene
        self._timer = ExposureTimer(clock)
        self._state = _State("camera", Lasers(fan=False, hand=False))
        self._hand = _Hand(None)
        self._exposure = self._gain = 1.0
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None
        self._stopping = False
        self._waiting: Frame | None = None
        self._problem: Exception | None = None
        self._delivered = self._lost = self._orders = 0

    @property
    def capabilities(self) -> Capabilities:
        """Settings that the simulated source has, with their limits: exposure, gain and rate."""
        return CAPABILITIES

    @property
    def truth(self) -> LiveTruth:
        """True camera, fan and thickness of the simulated rig."""
        return self._scene.truth

    def open(self) -> None:
        """Start the simulated exposures, with time and frame numbers from 0."""
        self.close()
        with self._changed:
            self._stopping, self._problem = False, None
            self._delivered = self._lost = 0
            self._timer.start()
            self._state = _State(self._state.step, self._state.lasers)
            self._hand = _Hand(self._scene.motion(self._state.step))
        self._thread = threading.Thread(target=self._expose, name="simulated rig", daemon=True)
        self._thread.start()

    def configure(self, settings: SourceSettings) -> None:
        """Set exposure (default 8 ms), gain (0 dB) and rate (up to 12 Hz; 0: as fast as frames are read)."""
        CAPABILITIES.check(settings, self.name)
        with self._changed:
            if settings.exposure_ms is not None:
                self._exposure = settings.exposure_ms / EXPOSURE_MS
            if settings.gain_db is not None:
                self._gain = 10 ** (settings.gain_db / 20)
            if settings.rate_hz is not None:
                self._timer.set_rate(settings.rate_hz)
            self._ordered()

    def prepare(self, step: Shown) -> None:
        """Put the target, the object or the boards of this `step` before the camera; its motion begins anew."""
        with self._changed:
            now = self._timer.now()
            self._state = _State(step, self._state.lasers, began_s=now, lit_s=now)
            self._hand = _Hand(self._scene.motion(step))
            self._ordered()

    def lasers(self, lasers: Lasers) -> bool:
        """Switch the simulated lasers and return True; the hand goes on where it stopped."""
        with self._changed:
            self._state = self._state.lit(lasers, self._timer.now())
            self._ordered()
        return True

    @property
    def waits(self) -> bool:
        """Whether the next frame is exposed only when the last one was read: unless a rate was set."""
        return not self._timer.is_paced

    def go_on(self, frame: Frame) -> None:
        """Let the plate move on from the pose it is held at: `frame`, taken there, was recorded or is useless."""
        with self._changed:
            self._hand.go_on(frame.index)

    def read(self, timeout_s: float) -> Frame | None:
        """Return the next frame, exposed after the last command; None if there is none within `timeout_s`."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting is not None or self._problem is not None, timeout_s)
            if self._problem is not None:
                raise self._problem
            frame, self._waiting = self._waiting, None
            if frame is not None:
                self._delivered += 1
                self._timer.delivered()
                self._changed.notify_all()
            return frame

    def close(self) -> None:
        """Stop the simulated exposures and end their thread."""
        with self._changed:
            self._stopping = True
            self._changed.notify_all()
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        self._waiting = None

    def _ordered(self) -> None:
        """Drop frames that were exposed before an order, for they do not show it."""
        self._orders += 1
        self._waiting = None
        self._timer.skip()
        self._changed.notify_all()

    def _expose(self) -> None:
        try:
            rendered: set[Shown] = set()
            while (task := self._next_exposure()) is not None:
                moment = task.moment
                picture = self._scene.picture(moment, task.exposure, task.gain)
                if moment.step not in rendered:  # the first one takes long, and is no measure of the machine
                    rendered.add(moment.step)
                    with self._changed:
                        self._timer.skip()
                    continue
                with self._changed:
                    if task.orders == self._orders:
                        self._lost += task.lost
                        when = self._timer.time_of(moment.number)
                        self._waiting = Frame(picture, self._delivered + self._lost, when, self._lost)
                        self._hand.shows(self._waiting.index, moment.time_s)
                        self._changed.notify_all()
        except Exception as problem:  # noqa: BLE001 (told to the reader, whose thread it concerns)
            with self._changed:
                self._problem = problem
                self._changed.notify_all()

    def _next_exposure(self) -> _Exposure | None:
        """Wait for the next instant at which a frame is due; None when it is time to stop."""
        with self._changed:
            while not self._stopping:
                if self._waiting is not None:
                    self._changed.wait()
                    continue
                wait_s = self._timer.wait_s()
                if wait_s > 0:
                    self._changed.wait(wait_s)
                    continue
                slow_s = self._timer.late_s()
                number, lost = self._timer.expose()
                time_s = self._timer.time_of(number)
                plate_s = self._hand.plate_s(max(0.0, time_s - self._state.began_s), slow_s)
                moment = self._state.at(number, time_s, plate_s)
                return _Exposure(self._orders, moment, lost, self._exposure, self._gain)
        return None
