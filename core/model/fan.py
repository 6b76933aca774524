"""Fan: the fixed laser of N lines, whose light planes form one pencil through a common axis."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.model.arrays import Array, frozen_array, set_field
from core.model.light_plane import LightPlane, angle_between


@dataclass(frozen=True, eq=False, slots=True)
class Fan:
    """The calibrated light planes of the fixed laser, line 1 … N in order across the fan.

    Parameters
    ----------
    planes
        N ≥ 1 planes.
    covariance
        (3N, 3N) of the stacked π in 1/mm²; common to every point of a scan. Zero when it is not known.
    """

    planes: tuple[LightPlane, ...]
    covariance: Array | None = None

    def __post_init__(self) -> None:
        set_field(self, "planes", tuple(self.planes))
        if not self.planes:
            raise ValueError("a fan needs at least one plane")
        size = 3 * len(self.planes)
        covariance = np.zeros((size, size)) if self.covariance is None else self.covariance
        set_field(self, "covariance", frozen_array(covariance, (size, size), "covariance"))

    @property
    def lines(self) -> int:
        """Number of lines."""
        return len(self.planes)

    @property
    def pis(self) -> Array:
        """All π stacked, (N, 3) in 1/mm."""
        return np.array([plane.pi for plane in self.planes])

    @property
    def angles(self) -> tuple[float, ...]:
        """Angles between neighbouring planes, in rad; N − 1 of them."""
        return tuple(angle_between(a, b) for a, b in pairwise(self.planes))
