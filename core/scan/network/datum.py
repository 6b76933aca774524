"""How well the fan fixes what sweeps among themselves can not know: scale and place.

Crossings between sweeps leave π → s π + c free, four numbers that only the fan fixes, and the scale only where it
meets relief. Of their covariance two things matter to who measures. With w = 1/z, a change s·w + c·r of the inverse
depth moves the surface at depth z on ray r by −(s·z + z² c·r), and stretches small heights there by −(s + 2 z c·r).

The four numbers of an error δπ of all sweeps are those that come nearest to it where the sweeps are crossed: the
S-transformation of geodesy with every crossing's ray as a datum point, weighted by how well the sweep is known there.

References
----------
Baarda, W., S-transformations and criterion matrices, Netherlands Geodetic Commission 5 (1973).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.model import Camera
from core.model.arrays import Array
from core.scan.crossings import CrossingTable
from core.scan.main_plane import main_plane

WEAK_MM = 0.03
"""The scale is weak if it alone makes a height as large as the relief this uncertain: as much as all else together."""

LEAST_RELIEF_MM = 5.0
"""On a flat scene the scale is judged by what it would do to a part of this height."""

UNKNOWN = 0.1
"""Relative σ of the scale from which on it counts as not fixed at all."""

_RIDGE = 1e-13


@dataclass(frozen=True, slots=True)
class Datum:
    """How strongly scale and place of a scan are fixed, without the uncertainty of camera and fan.

    `scale` is the relative standard uncertainty of heights, `depth_mm` that of the depth in the middle of the scene;
    `relief_mm` how much relief the sweeps saw.
    """

    scale: float
    depth_mm: float
    relief_mm: float

    @property
    def height_mm(self) -> float:
        """What the scale's uncertainty does to a height as large as the relief."""
        return self.scale * max(self.relief_mm, LEAST_RELIEF_MM)

    @property
    def weak(self) -> bool:
        """Whether that is too much."""
        return self.height_mm > WEAK_MM

    @property
    def sentence(self) -> str:
        """For the technician, with advice if it is weak."""
        advice = "put a step beside the part, or let the fan meet more relief"
        if self.scale > UNKNOWN:
            return (
                f"The fan meets no relief, so nothing fixes the scale of heights; {advice}. Its own points and flat "
                "faces are right all the same."
            )
        share = f"{100 * self.scale:.2g} %"
        if not self.weak:
            return f"The relief under the fan fixes the scale to {share}."
        return (
            f"The relief under the fan fixes the scale only to {share}: {self.height_mm:.2g} mm on a height of "
            f"{max(self.relief_mm, LEAST_RELIEF_MM):.0f} mm; {advice}."
        )


def datum_of(pis: Array, covariance: Array, crossings: CrossingTable, camera: Camera) -> Datum:
    """The datum of sweeps `pis` (S, 3) with their `covariance` (3S, 3S).

    `crossings` are numbered by sweep.
    """
    rays = camera.rays(crossings.uv)
    inverse_depths = np.einsum("mi,mi->m", rays, pis[crossings.a])
    unit = float(np.abs(pis).mean())  # brings s and c to one size
    gauge = np.concatenate([pis[:, :, None] / unit, np.tile(np.eye(3), (len(pis), 1, 1))], axis=2)
    blocks = np.array([covariance[i : i + 3, i : i + 3] for i in range(0, len(covariance), 3)])
    datum_points = np.zeros((len(pis), 3, 3))
    between = ~crossings.with_fan
    for sweep, ray in ((crossings.a, rays), (crossings.b[between], rays[between])):
        variance = np.einsum("mi,mij,mj->m", ray, blocks[sweep], ray)
        np.add.at(datum_points, sweep, ray[:, :, None] * ray[:, None, :] / variance[:, None, None])
    pulled = datum_points @ gauge
    normal = np.einsum("sij,sik->jk", gauge, pulled)
    normal += _RIDGE * np.trace(normal) * np.eye(4)
    fit = np.linalg.solve(normal, pulled.transpose(2, 0, 1).reshape(4, -1))
    of_gauge = fit @ covariance @ fit.T
    depth, ray = 1 / float(np.median(inverse_depths)), np.median(rays, axis=0)
    heights = np.concatenate([[1 / unit], 2 * depth * ray])
    place = np.concatenate([[depth / unit], depth**2 * ray])
    return Datum(
        float(np.sqrt(max(heights @ of_gauge @ heights, 0.0))),
        float(np.sqrt(max(place @ of_gauge @ place, 0.0))),
        _relief(rays, inverse_depths),
    )


def _relief(rays: Array, inverse_depths: Array) -> float:
    """Range in mm of 95 % of the depths about the plane that most lie on."""
    plane, _ = main_plane(rays, inverse_depths)
    low, high = np.quantile(1 / inverse_depths - 1 / np.maximum(rays @ plane, 1e-6), [0.025, 0.975])
    return float(high - low)
