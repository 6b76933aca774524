"""Room light that does not stay as it is within a scan: lamps that flicker or are switched, shadows that pass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from core.simulate.effects.ranges import require_ranges

if TYPE_CHECKING:  # a window that starts reads scenarios, and loads no compiled loops
    from core.simulate.rays import Map

LAMP_HZ = 100.0
"""Twice the mains frequency."""
SHADOW_WIDTH, SHADOW_EDGE = 0.35, 0.04
"""Of a shadow over the picture's width: its own, and that of its soft edges."""
SHADOW_COURSE = 17.0
"""Frames in which a shadow crosses the picture."""


@dataclass(frozen=True, slots=True)
class RoomEffects:
    """Changes of the room's light within a scan.

    Parameters
    ----------
    flicker
        Relative amplitude of the light at 100 Hz as a row collects it, its phase by chance in each picture; rows that
        are read out one after another see bands of it. Incandescent lamps have 0.05 to 0.2, fluorescent ones 0.3 to
        0.5, LEDs 0.05 to 1; an exposure of 5 ms leaves 0.64 of it, one of 10 ms nothing.
    lamp_frame, lamp_change
        From this frame on the light is stronger by this share of itself: a lamp is switched on or off, the sun comes.
    shadow
        Share of the light that a shadow with soft edges takes, such as that of the hand or of somebody who passes; it
        moves over the picture again and again.

    References
    ----------
    IEEE 1789-2015, Recommended practices for modulating current in high-brightness LEDs, clause 4 (percent flicker).
    """

    flicker: float = 0.0
    lamp_frame: int = 0
    lamp_change: float = 0.0
    shadow: float = 0.0

    def __post_init__(self) -> None:
        require_ranges(
            self,
            (
                ("flicker", 0.0, 1.0),
                ("lamp_frame", 0, 100_000),
                ("lamp_change", -1.0, 10.0),
                ("shadow", 0.0, 1.0),
            ),
        )

    def added(self, index: int, shape: tuple[int, ...], readout_s: float, rng: np.random.Generator) -> Map | None:
        """Compute the change of the room's light in frame `index` (−1: the reference) as a share of it; None if none.

        Its shape is (h or 1, w or 1).
        """
        factor = np.ones((1, 1))
        if self.flicker:
            rows = np.arange(shape[0]) / shape[0] if readout_s else np.zeros(1)
            phase = rng.uniform(0, 2 * np.pi)
            factor = factor + self.flicker * np.sin(2 * np.pi * LAMP_HZ * readout_s * rows + phase)[:, None]
        if self.lamp_change and index >= self.lamp_frame:
            factor = factor * (1 + self.lamp_change)
        if self.shadow and index >= 0:
            centre = (1 + SHADOW_WIDTH) * ((index + 0.5) / SHADOW_COURSE % 1) - SHADOW_WIDTH / 2
            off = np.abs(np.arange(shape[1]) / shape[1] - centre) - SHADOW_WIDTH / 2
            factor = factor * (1 - self.shadow / (1 + np.exp(off / (SHADOW_EDGE / 4))))[None, :]
        return None if np.all(factor == 1) else (factor - 1).astype(np.float32)


STEADY_ROOM = RoomEffects()
"""Its light stays as it is."""
