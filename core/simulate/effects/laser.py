"""A line laser whose sheet of light is no Gaussian across: flat, with a halo, or with a shoulder on one side."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from core.model.arrays import Array
from core.simulate.effects.ranges import require_ranges

HALO_WIDTH = 4.0
"""Gaussian σ of the halo over that of the light."""
SHOULDER_AT = 1.8
"""σ from the light's middle to that of its shoulder, which is as wide."""


@dataclass(frozen=True, slots=True)
class LaserEffects:
    """Section across a sheet of light, d in its σ: exp(−½|r·d|ᵉ) + halo · exp(−½(d/4)²) + shoulder · exp(−½(d − 1.8)²).

    With r all exponents e have the same standard deviation.

    Parameters
    ----------
    edge
        Exponent e: 2 for the Gaussian of a single transverse mode; 4 to 8 for the flat light of a multimode diode, a
        super-Gaussian.
    halo
        Light that a dusty or cast line lens scatters about the line, over the crest.
    shoulder
        Light on one side, as of a collimator out of its place, over the crest. There is no middle then that all would
        agree on.

    The strengths that are tried are chosen, not measured: makers state a width only.
    """

    edge: float = 2.0
    halo: float = 0.0
    shoulder: float = 0.0

    def __post_init__(self) -> None:
        require_ranges(self, (("edge", 1.0, 20.0), ("halo", 0.0, 1.0), ("shoulder", 0.0, 1.0)))

    @property
    def reach(self) -> float:
        """Ratio of the distance that the laser's light reaches, halo or shoulder included, to that of a Gaussian."""
        return HALO_WIDTH if self.halo else 1.0 + SHOULDER_AT / 4 if self.shoulder else 1.0

    def across(self, d: Array) -> Array:
        """Compute the light (N,) at d (N,), in σ, from the sheet's middle; 1 there for a Gaussian."""
        light = np.exp(-0.5 * (d**2 if self.edge == 2 else np.abs(self._narrowed * d) ** self.edge))
        if self.halo:
            light += self.halo * np.exp(-0.5 * (d / HALO_WIDTH) ** 2)
        if self.shoulder:
            light += self.shoulder * np.exp(-0.5 * (d - SHOULDER_AT) ** 2)
        return np.asarray(light)

    @property
    def _narrowed(self) -> float:
        """Standard deviation of exp(−½|d|ᵉ)."""
        return 2 ** (1 / self.edge) * math.sqrt(math.gamma(3 / self.edge) / math.gamma(1 / self.edge))


GAUSSIAN_LASER = LaserEffects()
"""Gaussian across."""
