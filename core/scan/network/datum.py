"""Datum of a scan: how well the fan fixes what sweeps among themselves cannot know, scale and place.

Crossings between sweeps leave π → s π + c free, four numbers that only the fan fixes, and the scale only where it
meets relief and sweeps carry it from the fan's lines to each other. So where the scale is weak, either the fan's own
points lie on one plane, or the sweeps run alike, or too few of them cross the fan at different heights.

Two figures of their covariance matter for measuring. With w = 1/z, a change s·w + c·r of the inverse depth moves the
surface at depth z on ray r by −(s·z + z² c·r), and stretches small heights there by −(s + 2 z c·r).

The four numbers of an error δπ of all sweeps are those that come nearest to it where the sweeps are crossed: the
S-transformation of geodesy with every crossing's ray as a datum point, weighted by how well the sweep is known there.

References
----------
Baarda, W., S-transformations and criterion matrices, Netherlands Geodetic Commission 5 (1973).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.findings.table import note_of
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable

WEAK_MM = 0.03
"""Standard uncertainty in mm of a height as large as the relief at which the scale alone is called weak: as much as
all other sources together make. Held by tests/scan/network/test_datum.py."""

LEAST_RELIEF_MM = 5.0
"""Height in mm by which the scale is judged on a flat scene: that of a low part."""

UNKNOWN = 0.1
"""Relative σ of the scale from which on it counts as not fixed at all."""

ALIKE = np.radians(10.0)
"""Range of the stripes' directions below which sweeps run alike and hardly cross each other: a hand that tilts the
laser has 60° to 80°, one that does not 3°."""
_TILT_QUANTILES = [0.1, 0.9]
"""Of the directions: a single frame that lies aslant does not tie the others."""

_RIDGE = 1e-13
"""Added to the normal matrix relative to its trace: a direction that the crossings do not fix stays solvable."""

ON_ONE_PLANE = 1e-3
"""Share of the depth by which points are off one plane (RMS) at least, or they tell no more than a plane does."""

MAIN_PLANE_MM = 1.0
"""Depth in mm within which a point lies on the main plane: above the noise of points, below the height of parts."""
_TRIALS = 100
"""Planes tried through three random points: if it holds 40 % of them, all of these miss it once in a thousand scans."""
_RELIEF_QUANTILES = [0.025, 0.975]
"""Of the depths about the main plane: their range is the relief, wrong points aside."""


@dataclass(frozen=True, slots=True)
class Datum:
    """Uncertainty of the scale and the depth of a scan as a whole, without what is due to camera and fan.

    `scale` is the relative standard uncertainty of heights, `depth_mm` that of the depth in the middle of the scene;
    `relief_mm` how much relief the sweeps saw; `tilt` in rad the range of the directions of 80 % of their stripes.
    """

    scale: float
    depth_mm: float
    relief_mm: float
    tilt: float

    @property
    def height_mm(self) -> float:
        """Standard uncertainty in mm, from the scale alone, of a height as large as the relief of the scan."""
        return self.scale * max(self.relief_mm, LEAST_RELIEF_MM)

    @property
    def weak(self) -> bool:
        """Whether the uncertainty from the scale of a height as large as the scan's relief exceeds WEAK_MM."""
        return self.height_mm > WEAK_MM


def note_on_datum(datum: Datum, fan_relief_mm: float | None) -> Message:
    """Make a note on how well the scale of a scan is fixed; where it is weak, with what is missing.

    `fan_relief_mm` is the relief that the fan's own points show (`relief_mm`), whether sweeps cross them or not; None:
    there is no fan, and known planes fix the scale.
    """
    percent = 100 * datum.scale
    if not datum.weak and datum.scale <= UNKNOWN:
        return note_of("scan.scale_fixed" if fan_relief_mm is not None else "scan.scale_by_planes", percent=percent)
    if fan_relief_mm is None:
        missing = Message(
            "scan.missing_boards",
            "Let more sweeps cross both boards and the part between them, and turn the boards against each other",
        )
    elif fan_relief_mm < LEAST_RELIEF_MM:
        missing = Message(
            "scan.missing_relief",
            "The fan meets no relief: let it cross part and table. A block laid beside the part gives height, too, but "
            "is a second pair of faces: outline those of the part then",
        )
    elif datum.tilt < ALIKE:
        missing = Message("scan.missing_tilt", "The sweeps run alike: tilt the laser to and fro by 30°")
    else:
        missing = Message(
            "scan.missing_sweeps",
            "Too few sweeps cross the fan at different heights: sweep more across its lines on part and table",
        )
    if datum.scale > UNKNOWN:
        return note_of("scan.scale_unknown", missing=missing)
    return note_of(
        "scan.scale_weak",
        percent=percent,
        error_mm=datum.height_mm,
        height_mm=max(datum.relief_mm, LEAST_RELIEF_MM),
        missing=missing,
    )


def datum_of(pis: Array, covariance: Array, crossings: CrossingTable, camera: Camera) -> Datum | None:
    """Compute how uncertain scale and depth of a scan are, by its planes `pis` (S, 3) with `covariance` (3S, 3S).

    None where no sweep was located. `crossings` are numbered by sweep. A sweep with too few of them to be located stays
    where it began, at infinity.
    """
    rays = camera.rays(crossings.uv)
    inverse_depths = np.einsum("mi,mi->m", rays, pis[crossings.a])
    located = inverse_depths > 0
    if not located.any():
        return None
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
    depth, ray = 1 / float(np.median(inverse_depths[located])), np.median(rays[located], axis=0)
    heights = np.concatenate([[1 / unit], 2 * depth * ray])
    place = np.concatenate([[depth / unit], depth**2 * ray])
    return Datum(
        float(np.sqrt(max(heights @ of_gauge @ heights, 0.0))),
        float(np.sqrt(max(place @ of_gauge @ place, 0.0))),
        relief_mm(rays[located], inverse_depths[located]),
        _tilt(crossings, len(pis)),
    )


def free_directions(rays: Array, inverse_depths: Array) -> int:
    """Count the directions of a sweep's plane that points at known `inverse_depths` (M,) on `rays` (M, 3) leave free.

    Points of one plane leave one: all sweeps may be stretched away from it, π → s (π − τ) + τ.
    """
    if not len(rays):
        return 3
    places = np.column_stack([inverse_depths / np.median(inverse_depths), rays])
    sizes = np.linalg.svd(places / np.sqrt(len(places)), compute_uv=False)
    return min(3, 4 - int(np.count_nonzero(sizes > ON_ONE_PLANE)))


def _tilt(crossings: CrossingTable, sweeps: int) -> float:
    """Range in rad of the directions of 80 % of the stripes, each the mean of its tangents at the crossings."""
    turned = np.zeros(sweeps, dtype=np.complex128)  # twice the angle: a stripe runs both ways
    between = ~crossings.with_fan
    for sweep, tangent in ((crossings.a, crossings.tangent_a), (crossings.b[between], crossings.tangent_b[between])):
        np.add.at(turned, sweep, (tangent[:, 0] + 1j * tangent[:, 1]) ** 2)
    turned = turned[turned != 0]
    if not len(turned):
        return 0.0
    off = np.angle(turned / np.sum(turned / np.abs(turned))) / 2
    low, high = np.quantile(off, _TILT_QUANTILES)
    return float(high - low)


def relief_mm(rays: Array, inverse_depths: Array) -> float:
    """Compute the range in mm of 95 % of the depths 1/`inverse_depths` (M,) on `rays` (M, 3) about their main plane."""
    plane, _ = main_plane(rays, inverse_depths)
    low, high = np.quantile(1 / inverse_depths - 1 / np.maximum(rays @ plane, 1e-6), _RELIEF_QUANTILES)
    return float(high - low)


def main_plane(rays: Array, inverse_depths: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Find the plane π (3,) with most of the points at `inverse_depths` (M,) on `rays` (M, 3); also return their mask.

    The best of many through three of the points, then fitted to all within `MAIN_PLANE_MM` of depth. Of all planes
    through fewer points the one that leans least.
    """
    rng = np.random.default_rng(0)
    tolerance = MAIN_PLANE_MM * inverse_depths**2
    best = np.zeros(len(rays), dtype=np.bool_)
    for _ in range(_TRIALS):
        chosen = rng.choice(len(rays), min(3, len(rays)), replace=False)
        plane = np.linalg.lstsq(rays[chosen], inverse_depths[chosen], rcond=None)[0]
        near = np.abs(rays @ plane - inverse_depths) < tolerance
        if np.count_nonzero(near) > np.count_nonzero(best):
            best = near
    pi = np.asarray(np.linalg.lstsq(rays[best], inverse_depths[best], rcond=None)[0], dtype=np.float64)
    return pi, np.abs(rays @ pi - inverse_depths) < tolerance
