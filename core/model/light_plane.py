"""Light plane of a laser in inverse-depth form: π·X = 1 on the plane, π in 1/mm.

A point at depth z on ray r = (x, y, 1) is X = z r, so on a light plane 1/z = π·r: everything about light planes
is linear in π. A plane through the camera's centre has no π; a laser is never there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from core.errors import WrongValue
from core.messages import Message
from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class LightPlane:
    """Light plane π·X = 1, with `pi` (3,) in 1/mm, in the camera frame."""

    pi: Array

    def __post_init__(self) -> None:
        set_field(self, "pi", frozen_array(np.ravel(self.pi), (3,), "pi"))
        if not np.isfinite(self.pi).all() or not np.any(self.pi):
            raise WrongValue(Message("model.plane_not_finite", "pi must be finite and not zero"))

    @classmethod
    def from_normal(cls, normal: ArrayLike, d_mm: float) -> LightPlane:
        """Make the light plane normal·X = d_mm, for a `normal` (3,) of any length but 0."""
        return cls(np.asarray(normal, dtype=np.float64) / d_mm)

    @property
    def normal(self) -> Array:
        """Unit normal (3,) of the plane, pointing away from the camera's centre."""
        unit: Array = self.pi / np.linalg.norm(self.pi)
        return unit

    @property
    def d_mm(self) -> float:
        """Distance of the plane from the camera's centre, in mm; positive."""
        return float(1 / np.linalg.norm(self.pi))

    def depths(self, rays: ArrayLike) -> Array:
        """Compute depths z (N,) in mm at which `rays` (N, 3) meet the plane; negative or infinite where they do not."""
        with np.errstate(divide="ignore"):
            depths: Array = 1 / (np.asarray(rays, dtype=np.float64) @ self.pi)
        return depths

    def points(self, rays: ArrayLike) -> Array:
        """Compute the points (N, 3) in mm where `rays` (N, 3), r = (x, y, 1), meet the plane."""
        directions = np.asarray(rays, dtype=np.float64)
        points: Array = directions * self.depths(directions)[:, None]
        return points

    def distances(self, points: ArrayLike) -> Array:
        """Compute signed distances (N,) in mm of `points` (N, 3) from the plane, negative on the camera's side."""
        signed: Array = np.asarray(points, dtype=np.float64) @ self.normal - self.d_mm
        return signed


def angle_between(a: LightPlane, b: LightPlane) -> float:
    """Compute the angle in rad, 0 to π/2, between two light planes."""
    sine = np.linalg.norm(np.cross(a.normal, b.normal))
    cosine = abs(a.normal @ b.normal)
    return float(np.arctan2(sine, cosine))
