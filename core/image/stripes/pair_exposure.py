"""Two pictures of a pair that are not exposed alike: what the plate says of it, and the one brought to the other.

With automatic exposure, or a lamp that is not steady, the picture with the fan on is a·off + b where no laser is, and
on − off keeps (a − 1)·off + b of the plate's print. The fan lights few pixels of any brightness: the line through the
medians of those that are equally bright with the fan off gives a and b.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

SAMPLES = 40_000
"""Pixels that are looked at, at most."""
LEVELS, FEWEST = 24, 50
"""Classes of brightness, and pixels that one has at least."""
LEAST = 0.008
"""Of the full scale (2 of 255 grey levels): where the plate changes by less, no stripe feels it."""
LARGEST = 3.0
"""A gain beyond this, either way, is no matter of exposure: one of the pictures is not of this pose."""


class Exposed(NamedTuple):
    """Exposure of a picture against another one: gain · other + offset, in grey levels, where no laser is."""

    gain: float = 1.0
    offset: float = 0.0

    @classmethod
    def of(cls, on: NDArray[Any], off: NDArray[Any], full_scale: float) -> Exposed:
        """Fit gain and offset of the exposure of `on` (H, W) against `off` (H, W), the same part of both pictures.

        Gain 1 and offset 0 where too little is known, or the difference is too small to matter.
        """
        every = max(1, int(np.sqrt(on.size / SAMPLES)))
        x = off[::every, ::every].ravel().astype(np.float64)
        y = on[::every, ::every].ravel().astype(np.float64)
        seen = (x < full_scale) & (y < full_scale)
        x, y = x[seen], y[seen]
        levels = []
        if len(x) and np.ptp(x):
            of_level = ((x - x.min()) * (LEVELS / np.ptp(x))).astype(int).clip(0, LEVELS - 1)
            own = [of_level == level for level in range(LEVELS)]
            levels = [(x[it].mean(), np.median(y[it]), it.sum()) for it in own if it.sum() >= FEWEST]
        if len(levels) < 2:
            return cls()
        mine, beside, count = np.array(levels).T
        gain, offset = np.polyfit(mine, beside, 1, w=np.sqrt(count)).tolist()
        change = np.abs((gain - 1) * mine + offset)
        if not 1 / LARGEST < gain < LARGEST or change.max() < LEAST * full_scale:
            return cls()
        return cls(gain, offset)

    def like(self, other: NDArray[np.float32]) -> NDArray[np.float32]:
        """Scale the picture `other` (H, W) by gain and offset to the exposure of the one compared with it."""
        if self == Exposed():
            return other
        return np.float32(self.gain) * other + np.float32(self.offset)
