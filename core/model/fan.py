"""Fan: the fixed laser of N lines, whose light planes form one pencil through a common axis."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array, frozen_array, set_field
from core.model.light_plane import LightPlane, angle_between


@dataclass(frozen=True, eq=False, slots=True)
class Fan:
    """The calibrated light planes of the fixed laser, line 1 … N in order across the fan.

    Parameters
    ----------
    planes
        N planes; none where there is no fan.
    covariance
        (3N, 3N) of the stacked π in 1/mm²; common to every point of a scan. Zero when it is not known.
    bends
        (N, 3, 3) symmetric forms Q of light that lies in no planes: that of line k is XᵀQX mm off its plane at X. None
        for planes.
    """

    planes: tuple[LightPlane, ...]
    covariance: Array | None = None
    bends: Array | None = None

    def __post_init__(self) -> None:
        set_field(self, "planes", tuple(self.planes))
        size = 3 * len(self.planes)
        covariance = np.zeros((size, size)) if self.covariance is None else self.covariance
        set_field(self, "covariance", frozen_array(covariance, (size, size), "covariance"))
        if self.bends is not None:
            set_field(self, "bends", frozen_array(self.bends, (len(self.planes), 3, 3), "bends"))

    @property
    def lines(self) -> int:
        """Number of light planes, each of which draws one line."""
        return len(self.planes)

    @property
    def has_covariance(self) -> bool:
        """Whether the covariance is known: it is zero where it is not."""
        return self.covariance is not None and bool(self.covariance.any())

    @property
    def pis(self) -> Array:
        """Vectors π of all light planes, π·X = 1, (N, 3) in 1/mm."""
        return np.array([plane.pi for plane in self.planes]).reshape(-1, 3)

    def pis_at(self, line: NDArray[np.int64], rays: Array) -> Array:
        """Compute π (M, 3) of planes through the light of each `line` (M,) where `rays` (M, 3) meet it, bent or not."""
        pis: Array = self.pis[line]
        return pis if self.bends is None else bent_pis(pis, self.bends[line], rays)

    @property
    def angles(self) -> tuple[float, ...]:
        """Angles between neighbouring planes in rad, N − 1 of them."""
        return tuple(angle_between(a, b) for a, b in pairwise(self.planes))

    @property
    def angle_sds(self) -> tuple[float, ...]:
        """Standard deviations in rad of the N − 1 angles between neighbouring planes, by the fan's covariance."""
        assert self.covariance is not None
        pis, sds = self.pis, []
        for k in range(len(pis) - 1):
            lengths = np.linalg.norm(pis[k : k + 2], axis=1)
            a, b = pis[k] / lengths[0], pis[k + 1] / lengths[1]
            sine = np.linalg.norm(np.cross(a, b))
            gradient = np.concatenate([-(b - a * (a @ b)) / lengths[0], -(a - b * (a @ b)) / lengths[1]]) / sine
            block = self.covariance[3 * k : 3 * k + 6, 3 * k : 3 * k + 6]
            sds.append(float(np.sqrt(max(gradient @ block @ gradient, 0.0))))  # of an angle that is held, round 0
        return tuple(sds)

    @property
    def distance_sds(self) -> tuple[float, ...]:
        """Standard deviation in mm of each plane's distance from the camera's centre, by the fan's covariance."""
        assert self.covariance is not None
        sds = []
        for k, pi in enumerate(self.pis):  # d = 1/‖π‖
            gradient = pi / np.linalg.norm(pi) ** 3
            block = self.covariance[3 * k : 3 * k + 3, 3 * k : 3 * k + 3]
            sds.append(float(np.sqrt(max(gradient @ block @ gradient, 0.0))))
        return tuple(sds)


def bent_pis(pis: Array, bends: Array, rays: Array) -> Array:
    """Compute planes π (M, 3) that `rays` (M, 3) meet where they meet the light bent by XᵀQX mm off planes `pis`.

    `bends` (M, 3, 3) are the Q. On X = z r the light has π·r − 1/z = ‖π‖ z rᵀQr; with z of the plane, to first order.
    """
    off = np.linalg.norm(pis, axis=1) * np.einsum("mi,mij,mj->m", rays, bends, rays) / np.einsum("mi,mi->m", pis, rays)
    return np.asarray(pis - off[:, None] * np.array([0.0, 0.0, 1.0]), dtype=np.float64)
