"""Two surfaces of one part compared, before and after: the deviation at many places, and whether it is significant.

The pattern is M3C2: core points on the surface, a normal for each at a larger scale, and the points of both surfaces
within a cylinder about it, whose mean places along the normal are compared; a deviation counts beyond the level of
detection at 95 %.

Stripes of hand-moved light are millimetres apart, so the points of two scans do not lie beside each other, and plain
means would compare other places with other places where the surface slants or curves. So both are fitted together: one
common slant and curvature, which are held near those the normals show, and a place each. And points of one sweep share
its light plane's error, so what averages out are sweeps, not points. With a slant and a curvature of zero and every
point a sweep of its own this is the published form, 1.96·√(σ₁²/n₁ + σ₂²/n₂ + reg²).

References
----------
Lague, Brodu, Leroux, Accurate 3D comparison of complex topography with terrestrial laser scanner, ISPRS Journal of
Photogrammetry and Remote Sensing 82 (2013), doi:10.1016/j.isprsjprs.2013.04.009.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.errors import InputError
from core.messages import Message, label
from core.model import Pose
from core.model.arrays import Array
from core.model.directions import square_to
from core.model.robust import MAD_TO_SD
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.triangles import Triangles
from core.wings.geometry.comparison.shown import Changed

DETECTED = 1.96
"""Standard uncertainties that a deviation exceeds by chance in 5 % of the places."""
DIAMETERS_MM = (0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 30.0)
"""Of the cylinder, where none is asked for: the first that holds enough of both surfaces."""
ENOUGH_SWEEPS, ENOUGH_POINTS = 3, 12
"""Of either surface in half of the cylinders: so many let a wrong sweep be seen, and determine slant and curvature."""
FEWEST = 4
"""Points of either surface in a cylinder that is used, as Lague et al. have it."""
CORES_EACH = 2.0
"""Core points to a diameter along the surface."""
THINNED = 16.0
"""Points to a diameter that count: nearer ones of one sweep add nothing but time."""
NORMAL_SCALE = 2.0
"""Diameters over which normals are averaged."""
ALIKE = 0.5
"""Points whose surface faces more than 60° elsewhere are of another side."""
LEAST_TILT = 0.002
"""Radians that a normal may be wrong by at least."""
PATCH = 4.0
"""Diameters of the patches that tell how well both surfaces lie on each other."""
FEWEST_PATCHES = 8
"""That tell it at all."""
AT_ONCE = 1000
"""Core points taken together: their pairs with points fill about 100 MB."""
UNEVEN = 4.0
"""Times the usual scatter that points of one surface have about the fit where it has an edge or lies upon another."""
SAMPLE = 400
"""Core points that the diameter is chosen by."""

_STEP = label("comparing surfaces")


@dataclass(frozen=True, eq=False, slots=True)
class SurfacePoints:
    """Points of a surface, measured here or by anything else.

    Parameters
    ----------
    points
        (N, 3) in mm.
    normals
        (N, 3) unit, outwards; zero where unknown.
    sigma
        (N,) standard uncertainty of each in mm across the surface; zero where unknown: then the scatter tells it.
    sweep
        (N,) points of one number share their error.
    common
        (N,) standard uncertainty in mm that all points share.
    """

    points: Array
    normals: Array
    sigma: Array
    sweep: NDArray[np.int64]
    common: Array

    def __len__(self) -> int:
        return len(self.points)

    @classmethod
    def of_cloud(cls, cloud: Cloud) -> SurfacePoints:
        """Make surface points of a scan's cloud; each σ of depth is projected on the normal of the surface."""
        known = cloud.normals.any(axis=1)
        across = np.abs((cloud.normals * cloud.points).sum(axis=1)) / np.linalg.norm(cloud.points, axis=1)
        share = np.where(known, across, 1.0)
        sweep = np.unique(cloud.sweep, return_inverse=True)[1].astype(np.int64)
        return cls(cloud.points, cloud.normals, cloud.sigma * share, sweep, cloud.sigma_common * share)

    @classmethod
    def bare(cls, points: Array, normals: Array | None = None, sigma: Array | None = None) -> SurfacePoints:
        """Make points (N, 3) in mm of another program, with independent errors of σ `sigma` (N,) in mm, or 0."""
        zero = np.zeros(len(points))
        return cls(
            points,
            np.zeros_like(points) if normals is None else normals,
            zero if sigma is None else sigma,
            np.arange(len(points)),
            zero,
        )

    def select(self, keep: NDArray[np.int64] | NDArray[np.bool_]) -> SurfacePoints:
        """Select the points that `keep` numbers by index or marks by a flag (N,)."""
        return SurfacePoints(
            self.points[keep], self.normals[keep], self.sigma[keep], self.sweep[keep], self.common[keep]
        )

    def moved(self, pose: Pose) -> SurfacePoints:
        """Transform the points and their normals into another frame."""
        return replace(self, points=pose.apply(self.points), normals=self.normals @ pose.rotation.T)

    def without_common(self) -> SurfacePoints:
        """Return the points with a common uncertainty of 0, as where it cancels or an alignment absorbs it."""
        return replace(self, common=np.zeros(len(self)))


def sampled_surface(surface: Triangles, spacing_mm: float, most: int = 1_000_000) -> SurfacePoints:
    """Sample at most `most` points on triangles, evenly by area and about `spacing_mm` apart, with no uncertainty."""
    corners = surface.corners
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    count = int(np.clip(area.sum() / spacing_mm**2, min(1000, most), most))
    rng = np.random.default_rng(0)
    which = np.sort(rng.choice(len(corners), count, p=area / area.sum()))
    a, b = np.sqrt(rng.random(count))[:, None], rng.random(count)[:, None]
    one, two, three = corners[which, 0], corners[which, 1], corners[which, 2]
    return SurfacePoints.bare((1 - a) * one + a * (1 - b) * two + a * b * three, surface.normals[which])


@dataclass(frozen=True, slots=True)
class ComparisonScales:
    """Scales that surfaces are compared at, in mm.

    Parameters
    ----------
    diameter_mm
        Of the cylinders; 0: the smallest that holds enough of both surfaces.
    reach_mm
        Largest deviation that is looked for; what is farther away is another surface.
    registration_mm
        Standard uncertainty of how both lie on each other; None: by what most of the surface shows.
    """

    diameter_mm: float = 0.0
    reach_mm: float = 2.0
    registration_mm: float | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Comparison:
    """Deviations of a surface from another one at N core points.

    Parameters
    ----------
    points, normals
        (N, 3) in mm, and outward unit vectors, in the frame of the surface.
    deviation
        (N,) in mm along the normal: positive where the surface lies outside the other one, has more material.
    u
        (N,) its standard uncertainty in mm, without the registration's.
    counts
        (N, 2) points of the surface and of the other one in the cylinder.
    diameter_mm, reach_mm, registration_mm
        As they were used.
    """

    points: Array
    normals: Array
    deviation: Array
    u: Array
    counts: NDArray[np.int64]
    diameter_mm: float
    reach_mm: float
    registration_mm: float

    def __len__(self) -> int:
        return len(self.points)

    @property
    def sigma(self) -> Array:
        """Standard uncertainty (N,) of the deviation in mm, the registration's included."""
        return np.hypot(self.u, self.registration_mm)

    @property
    def detectable(self) -> Array:
        """Smallest deviation (N,) in mm that is significant at 95 %, at each core point."""
        return np.asarray(DETECTED * self.sigma)

    @property
    def significant(self) -> NDArray[np.bool_]:
        """Flags (N,) of the core points whose deviation is larger than its level of detection at 95 %."""
        return np.asarray(np.abs(self.deviation) > self.detectable)

    @property
    def lower(self) -> Changed:
        """Share of the core points where material is significantly missing, and their deviations in mm."""
        return self._changed(-1)

    @property
    def higher(self) -> Changed:
        """Share of the core points where there is significantly more material, and their deviations in mm."""
        return self._changed(1)

    def _changed(self, side: int) -> Changed:
        there = self.deviation[self.significant & (side * self.deviation > 0)]
        if not len(there):
            return Changed(0.0, np.nan, np.nan)
        return Changed(len(there) / len(self), float(there.mean()), float(there[np.argmax(side * there)]))

    def at(self, points: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Look up the deviation (M,) in mm at points (M, 3) in mm, NaN if far off, and if it is significant (M,).

        The deviation is that of the nearest core point within a diameter.
        """
        away, nearest = cKDTree(self.points).query(points, distance_upper_bound=self.diameter_mm)
        known = np.isfinite(away)
        nearest = np.where(known, nearest, 0)
        return np.where(known, self.deviation[nearest], np.nan), known & self.significant[nearest]


def compare(
    surface: SurfacePoints, other: SurfacePoints, scales: ComparisonScales, progress: Progress = silent
) -> Comparison:
    """Compute the deviations in mm of one surface from another one in the same frame, along the normals of `surface`.

    Raises
    ------
    InputError
        If the two have nothing in common.
    """
    with_normals = np.flatnonzero(surface.normals.any(axis=1))
    if not len(with_normals) or not len(other):
        raise _nothing_common(scales.reach_mm)
    diameter = scales.diameter_mm or _diameter(surface, other, with_normals, scales.reach_mm)
    cores = with_normals[_thinned(surface.points[with_normals], diameter / CORES_EACH)]
    ours, theirs = (_per_sweep(one, diameter / THINNED) for one in (surface, other))
    places, normals, tilts = _normals(surface, cores, NORMAL_SCALE * diameter / 2)
    clouds = tuple((one, cKDTree(one.points)) for one in (ours, theirs))
    found: list[_Fitted] = []
    for start in range(0, len(places), AT_ONCE):
        progress(_STEP, start, len(places))
        part = slice(start, start + AT_ONCE)
        cylinders = _Cylinders(places[part], normals[part], tilts[part], diameter, scales.reach_mm)
        found.append(_fitted(cylinders, clouds))
    progress(_STEP, len(places), len(places))
    kept = np.concatenate([one.kept for one in found])
    if not kept.any():
        raise _nothing_common(scales.reach_mm)
    deviation, u = np.concatenate([one.deviation for one in found]), np.concatenate([one.u for one in found])
    counts, scatter = np.concatenate([one.counts for one in found]), np.concatenate([one.scatter for one in found])
    places, deviation, u = places[kept], deviation[kept], np.hypot(u[kept], _mixed(scatter[kept]))
    registration = scales.registration_mm
    if registration is None:
        registration = _registration(places, deviation, u, PATCH * diameter)
    return Comparison(places, normals[kept], deviation, u, counts[kept], diameter, scales.reach_mm, registration)


def _nothing_common(reach_mm: float) -> InputError:
    return InputError(
        Message(
            "comparison.nothing_common",
            "nowhere do both surfaces lie within {reach_mm:g} mm of each other",
            reach_mm=reach_mm,
        ),
        todo=Message(
            "comparison.advice_align", "align them by best fit, allow a larger reach, or check that the unit is mm"
        ),
    )


def _thinned(points: Array, spacing_mm: float, *of: NDArray[np.int64]) -> NDArray[np.int64]:
    """The first of the points (N, 3) in each cube of that edge, and of each number of `of`; ascending."""
    cubes = np.floor((points - points.min(axis=0)) / spacing_mm).astype(np.int64)
    return np.sort(np.unique(np.column_stack([cubes, *of]), axis=0, return_index=True)[1])


def _per_sweep(surface: SurfacePoints, spacing_mm: float) -> SurfacePoints:
    """Thinned, each sweep by itself; where each point is a sweep of its own, all together."""
    own = len(np.unique(surface.sweep)) == len(surface)
    return surface.select(_thinned(surface.points, spacing_mm, *(() if own else (surface.sweep,))))


def _diameter(surface: SurfacePoints, other: SurfacePoints, cores: NDArray[np.int64], reach_mm: float) -> float:
    """The smallest diameter at which half of the core points have enough of both surfaces about them."""
    places = surface.points[np.random.default_rng(0).permutation(cores)]
    trees = [(one, cKDTree(one.points)) for one in (surface, other)]
    away = trees[1][1].query(places, distance_upper_bound=np.hypot(DIAMETERS_MM[-1] / 2, reach_mm))[0]
    places = places[np.isfinite(away)][:SAMPLE]
    if not len(places):
        raise _nothing_common(reach_mm)
    for diameter in DIAMETERS_MM:
        if all(_enough(one, tree, places, diameter / 2) for one, tree in trees):
            return diameter
    return DIAMETERS_MM[-1]


def _enough(surface: SurfacePoints, tree: cKDTree, places: Array, radius: float) -> bool:
    inside = cast(Sequence[list[int]], tree.query_ball_point(places, radius))
    enough = [len(one) >= ENOUGH_POINTS and len(np.unique(surface.sweep[one])) >= ENOUGH_SWEEPS for one in inside]
    return bool(np.mean(enough) >= 0.5)


def _normals(surface: SurfacePoints, cores: NDArray[np.int64], radius: float) -> tuple[Array, Array, Array]:
    """Places of the core points, mean normals (N, 3) about them, and how the normals scatter (N,) in rad."""
    known = surface.select(np.flatnonzero(surface.normals.any(axis=1)))
    known = known.select(_thinned(known.points, radius / THINNED))
    places, own = surface.points[cores], surface.normals[cores]
    owner, which = _pairs(cKDTree(known.points), places, radius)
    alike = (known.normals[which] * own[owner]).sum(axis=1) > ALIKE
    owner, which = owner[alike], which[alike]
    count = len(places)
    total = np.column_stack([np.bincount(owner, known.normals[which, axis], count) for axis in range(3)]) + own
    mean = total / np.linalg.norm(total, axis=1, keepdims=True)
    off = np.linalg.norm(known.normals[which] - mean[owner], axis=1)
    scatter = np.sqrt(np.bincount(owner, off**2, count) / np.maximum(np.bincount(owner, minlength=count), 1))
    return places, mean, np.maximum(scatter, LEAST_TILT)


def _pairs(tree: cKDTree, places: Array, radius: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Every place with every point of the tree within `radius`: numbers of both."""
    found = cast(Sequence[list[int]], tree.query_ball_point(places, radius))
    owner = np.repeat(np.arange(len(places)), [len(one) for one in found])
    which = np.concatenate([np.asarray(one, dtype=np.int64) for one in found])
    return owner, which


@dataclass(frozen=True, eq=False, slots=True)
class _Cylinders:
    """Core points taken together: places and normals (C, 3), scatter of the normals (C,)."""

    places: Array
    normals: Array
    tilts: Array
    diameter_mm: float
    reach_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class _Inside:
    """Points of one surface inside the cylinders, P pairs: whose they are, along the normal, design of the shape."""

    owner: NDArray[np.int64]
    along: Array
    shape: Array
    sigma: Array
    common: Array
    sweep: NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class _Fitted:
    """Of C cylinders: whether there is enough in them, deviation and u in mm, points of both (C, 2).

    `scatter` (C, 2) is the variance in mm² of both surfaces' points about the fit.
    """

    kept: NDArray[np.bool_]
    deviation: Array
    u: Array
    counts: NDArray[np.int64]
    scatter: Array


def _inside(cylinders: _Cylinders, surface: SurfacePoints, tree: cKDTree) -> _Inside:
    radius = cylinders.diameter_mm / 2
    owner, which = _pairs(tree, cylinders.places, float(np.hypot(radius, cylinders.reach_mm)))
    from_core = surface.points[which] - cylinders.places[owner]
    normal = cylinders.normals[owner]
    along = (from_core * normal).sum(axis=1)
    sides = square_to(cylinders.normals)[owner]
    across = np.einsum("pk,pkj->pj", from_core, sides) / radius
    facing = (surface.normals[which] * normal).sum(axis=1)
    alike = (facing > ALIKE) | ~surface.normals[which].any(axis=1)
    kept = alike & (np.abs(along) <= cylinders.reach_mm) & ((across**2).sum(axis=1) <= 1.0)
    x, y = across[kept].T
    shape = np.column_stack([x, y, x**2 + y**2, x**2 - y**2, 2 * x * y])
    which, owner = which[kept], owner[kept]
    return _Inside(owner, along[kept], shape, surface.sigma[which], surface.common[which], surface.sweep[which])


def _fitted(cylinders: _Cylinders, clouds: tuple[tuple[SurfacePoints, cKDTree], ...]) -> _Fitted:
    """Both surfaces in each cylinder: a place each, one slant and one curvature.

    Slant and curvature are drawn towards zero by how the normals scatter. What that does to the deviation is in its
    uncertainty, beside what the sweeps state and what the points show about the fit.
    """
    count = len(cylinders.places)
    both = [_inside(cylinders, *one) for one in clouds]
    counts = np.column_stack([np.bincount(one.owner, minlength=count) for one in both])
    kept = np.asarray((counts >= FEWEST).all(axis=1))
    owner = np.concatenate([one.owner for one in both])
    of_other = np.repeat([0, 1], [len(one.owner) for one in both])
    place = np.eye(2)[of_other]
    design = np.hstack([place, np.concatenate([one.shape for one in both])])
    along = np.concatenate([one.along for one in both])
    noise = _noise(both, counts)
    loose = cylinders.tilts * cylinders.diameter_mm / 2
    prior = np.zeros((count, 7))
    prior[:, 2:] = 1.0 / np.column_stack([loose, loose, loose / 2, loose / 2, loose / 2]) ** 2
    information = np.zeros((count, 7, 7))
    for row in range(7):
        for column in range(row, 7):
            summed = np.bincount(owner, design[:, row] * design[:, column], count) / noise
            information[:, row, column] = information[:, column, row] = summed
    information[:, np.arange(7), np.arange(7)] += prior
    information[~kept] = np.eye(7)
    right = np.column_stack([np.bincount(owner, column * along, count) for column in design.T]) / noise[:, None]
    apart = np.zeros((count, 7, 1))
    apart[:, 0], apart[:, 1] = 1.0, -1.0
    solved = np.linalg.solve(information, np.concatenate([right[:, :, None], apart], axis=2))
    fit, gain = solved[:, :, 0], solved[:, :, 1]
    weight = (design * gain[owner]).sum(axis=1) / noise[owner]
    left = along - (design * fit[owner]).sum(axis=1)
    variance = (gain**2 * prior).sum(axis=1)
    scatter = np.zeros((count, 2))
    for number, one in enumerate(both):
        mine = of_other == number
        scatter[:, number] = np.bincount(one.owner, left[mine] ** 2, count) / np.maximum(counts[:, number] - 1, 1)
        variance += _variance(one, weight[mine], scatter[:, number])
    return _Fitted(kept, fit[:, 0] - fit[:, 1], np.sqrt(variance), counts, scatter)


def _mixed(scatter: Array) -> Array:
    """(C,) uncertainty in mm where points of one surface lie on different sides of the part, by their scatter (C, 2).

    Such points are of no one place, and more of them tell it no better; only points without normals are mixed so.
    """
    usual = UNEVEN**2 * np.median(scatter, axis=0)
    return np.asarray(np.sqrt(np.maximum(scatter - usual, 0.0).sum(axis=1)))


def _noise(both: list[_Inside], counts: NDArray[np.int64]) -> Array:
    """(C,) variance in mm² that one point stands for, sweeps taken as one: it only sets how far the shape is held."""
    count = len(counts)
    sigma = np.concatenate([one.sigma for one in both])
    owner = np.concatenate([one.owner for one in both])
    usual = float(np.mean(sigma**2)) or 1e-4
    mean = np.bincount(owner, sigma**2, count) / np.maximum(counts.sum(axis=1), 1)
    sweeps = sum(np.bincount(_groups(one)[1], minlength=count) for one in both)
    return np.asarray(np.where(mean > 0, mean, usual) * counts.sum(axis=1) / np.maximum(sweeps, 1) + 1e-12)


def _groups(one: _Inside) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Which pieces of sweeps in cylinders the pairs are of, and which cylinder each piece is in."""
    span = int(one.sweep.max(initial=0)) + 1
    keys, piece = np.unique(one.owner * span + one.sweep, return_inverse=True)
    return piece, keys // span


def _variance(one: _Inside, weight: Array, scatter: Array) -> Array:
    """(C,) what one surface adds: its sweeps' stated errors, or what its points' scatter (C,) in mm² shows if more.

    What all its points share comes on top.
    """
    count = len(scatter)
    piece, owner = _groups(one)
    number = len(owner)
    stated = np.bincount(owner, np.bincount(piece, weight * one.sigma, number) ** 2, count)
    together = np.bincount(owner, np.bincount(piece, weight, number) ** 2, count)
    alone = np.bincount(one.owner, weight**2, count)
    shared = np.bincount(one.owner, weight * one.common, count)
    return np.asarray(np.maximum(stated, scatter * np.maximum(together, alone)) + shared**2)


def _registration(places: Array, deviation: Array, u: Array, patch_mm: float) -> float:
    """How badly both lie on each other, in mm: by how patches scatter beyond their own u, as far as most agree.

    What has changed, as long as that is less than half of the surface, does not count.
    """
    patch = np.unique(np.floor(places / patch_mm).astype(np.int64), axis=0, return_inverse=True)[1].ravel()
    order = np.argsort(patch, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(patch[order])) + 1)
    if len(parts) < FEWEST_PATCHES:
        return 0.0
    level = np.array([np.median(deviation[part]) for part in parts])
    own = np.array([np.mean(u[part] ** 2) for part in parts])
    scatter = (MAD_TO_SD * float(np.median(np.abs(level - np.median(level))))) ** 2
    return float(np.sqrt(max(scatter - float(np.median(own)), 0.0)))
