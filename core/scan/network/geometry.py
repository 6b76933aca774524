"""Geometry of a crossing of two light planes: their inverse depths must agree there, and with what uncertainty.

At a crossing with ray r the two planes meet the surface at one depth, π_a·r = π_b·r. A centreline that is off by
ε across itself moves the crossing along the other's tangent; with D = ∂(π_a − π_b)·r/∂(u, v), unit tangents t_a, t_b
meeting at θ, and centreline noises σ_a, σ_b (pixels)::

    σ² = [(t_b·D)² σ_a² + (t_a·D)² σ_b²] / sin² θ
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model import Camera
from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable


@dataclass(frozen=True, eq=False, slots=True)
class CrossingRays:
    """Rays (M, 3) of the crossings, and the derivatives ∂(x, y)/∂(u, v) of each by its pixel, (M, 2, 2)."""

    rays: Array
    jacobians: Array

    @classmethod
    def of(cls, crossings: CrossingTable, camera: Camera) -> CrossingRays:
        """Compute the rays of all `crossings` as `camera` sees them."""
        rays = camera.rays(crossings.uv)
        return cls(rays, camera.ray_jacobian(rays))

    def select(self, keep: NDArray[np.bool_] | NDArray[np.int64]) -> CrossingRays:
        """Select the crossings by a mask (M,), or by the numbers of their rows."""
        return CrossingRays(self.rays[keep], self.jacobians[keep])

    def followed_by(self, other: CrossingRays) -> CrossingRays:
        """Append the rays of the crossings in `other` to these."""
        return CrossingRays(np.concatenate([self.rays, other.rays]), np.concatenate([self.jacobians, other.jacobians]))


def inverse_depth_gradient(pi_difference: Array, jacobians: Array) -> Array:
    """Compute D = ∂(π_a − π_b)·r/∂(u, v), (M, 2) in 1/(mm px), of plane differences (M, 3)."""
    gradient: Array = np.einsum("mi,mij->mj", pi_difference[:, :2], jacobians)
    return gradient


def noise_gains(crossings: CrossingTable, gradient: Array) -> tuple[Array, Array]:
    """Compute the derivatives of (π_a − π_b)·r by an offset of a's and b's centreline; (M,) each in 1/(mm px).

    The sign follows the normals n = (t_v, −t_u).
    """
    t_a, t_b = crossings.tangent_a, crossings.tangent_b
    sine = t_a[:, 0] * t_b[:, 1] - t_a[:, 1] * t_b[:, 0]
    gain_a = np.einsum("mi,mi->m", t_b, gradient) / -sine
    gain_b = np.einsum("mi,mi->m", t_a, gradient) / sine
    return gain_a, gain_b


def floored(gradient: Array, floor: float) -> Array:
    """Lengthen to the length `floor` the vectors of `gradient` (M, 2) that are shorter, keeping their directions.

    Near a solution in which all planes fall together the gradient vanishes and weights run away; the rig's own
    geometry, not the current solution, sets how small it can be. One that has vanished has no direction: those of
    sweeps that cross each other and never the fan, whose planes stay zero; any will do.
    """
    length = np.linalg.norm(gradient, axis=1)
    gone = length == 0
    longer: Array = gradient * (np.maximum(length, floor) / np.where(gone, 1.0, length))[:, None]
    longer[gone] = floor / np.sqrt(2)
    return longer
