"""A sphere found in a cloud and fitted robustly: the check of a scan's scale and form against a known radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.faces import find_planes, search_tolerance
from core.inspect.results import Contribution
from core.inspect.uncertainty import combined, point_contributions
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.cloud import Cloud
from core.scan.normals import with_normals

HYPOTHESES = 600
SEARCH_POINTS = 4000
TUKEY = 4.685
GRAZING = 0.35
"""|cos| of incidence below which a point's σ across the surface falls no further: its pixel is uncertain as well."""


@dataclass(frozen=True, eq=False, slots=True)
class SphereFit:
    """A sphere: `centre` (3,) and `radius_mm` in mm, camera frame, with `u_mm` the radius's standard uncertainty.

    `indices` into the cloud of the points used; `residuals` (mm) of these, outwards positive; `form_mm` is the spread
    of the residuals that holds 95 % of the points, their noise included; `budget` says what `u_mm` is made of.
    """

    centre: Array
    radius_mm: float
    u_mm: float
    form_mm: float
    indices: NDArray[np.int64]
    residuals: Array
    budget: tuple[Contribution, ...]


def find_sphere(
    cloud: Cloud,
    *,
    radius_range_mm: tuple[float, float] = (3.0, 150.0),
    seed: int = 0,
    progress: Progress = silent,
) -> NDArray[np.int64]:
    """Indices of the points on the sphere that explains most of a cloud once its largest plane (the table) is gone.

    Two points and their normals make a hypothesis: the centre is where the two normals meet.

    Parameters
    ----------
    cloud
        Normals are estimated when it has none.
    radius_range_mm
        Spheres outside are not taken.
    seed
        Of the random search.
    progress
        Told how far it is.

    Raises
    ------
    InputError
        If there is no sphere.
    """
    cloud = cloud if cloud.normals.any() else with_normals(cloud, progress=progress)
    tolerance = search_tolerance(cloud, None)
    above = _above_table(cloud, tolerance, seed, progress)
    points, normals = cloud.points[above], cloud.normals[above]
    rng = np.random.default_rng(seed)
    known = np.flatnonzero(normals.any(axis=1))
    sample = known[rng.permutation(len(known))[:SEARCH_POINTS]]
    best = _best_hypothesis(points[sample], normals[sample], tolerance, radius_range_mm, rng)
    if best is None:
        raise InputError(
            f"none of the {len(above)} points beside the table's plane lie on a sphere",
            where="point cloud",
            todo="scan the sphere with more sweeps",
        )
    centre, radius = best
    for _ in range(5):
        on = _on_sphere(points, normals, centre, radius, tolerance)
        if on.sum() < 12:
            break
        centre, radius = _solve(points[on], np.ones(int(on.sum())), centre)
    return above[_on_sphere(points, normals, centre, radius, tolerance)]


def fit_sphere(
    cloud: Cloud,
    indices: NDArray[np.int64] | None = None,
    *,
    sweep_covariance: Array | None = None,
    correlation_px: float = 12.0,
    speckle_px: float = 12.0,
    seed: int = 0,
) -> SphereFit:
    """Robust orthogonal fit of a sphere, weights 1/σ² across the surface, Tukey's biweight.

    Parameters
    ----------
    cloud
        The measured points.
    indices
        Of the points on the sphere; None: found by `find_sphere`.
    sweep_covariance, correlation_px, speckle_px
        As for `core.inspect.uncertainty.point_contributions`; calibrations are not part of `u_mm`.
    seed
        Of the search.

    Raises
    ------
    InputError
        If there is no sphere, or fewer than 12 points on it.
    """
    indices = find_sphere(cloud, seed=seed) if indices is None else indices
    if len(indices) < 12:
        raise InputError(f"{len(indices)} points are too few for a sphere", where="point cloud")
    points, sigma = cloud.points[indices], cloud.sigma[indices]
    # The start: the sphere of least algebraic distance, |X|² = 2 c·X + (R² − |c|²), linear in its unknowns.
    middle = points.mean(axis=0)
    centred = points - middle
    squares = (centred**2).sum(axis=1)
    start = np.linalg.lstsq(np.column_stack([2 * centred, np.ones(len(points))]), squares, rcond=None)[0][:3] + middle
    centre, radius, weights = _robust(points, sigma, start)
    outward = points - centre
    distance = np.linalg.norm(outward, axis=1)
    outward /= distance[:, None]
    design = np.column_stack([outward, np.ones(len(points))])
    normal_matrix = (design * weights[:, None]).T @ design
    gain = np.linalg.solve(normal_matrix, (design * weights[:, None]).T)[3]  # ∂R/∂(shift outwards)
    kept = weights > 0
    used = cloud.select(indices[kept])
    residuals = (distance - radius)[kept]
    noise = sigma[kept] * _incidence(points[kept], centre)
    excess = float(np.sqrt(max(np.mean((residuals / noise) ** 2), 1.0)))
    rows = tuple(
        Contribution(row.source, row.u_mm * excess)
        for row in point_contributions(
            used,
            gain[kept, None] * outward[kept],
            sweep_covariance=sweep_covariance,
            correlation_px=correlation_px,
            speckle_px=speckle_px,
        )
    )
    low, high = np.quantile(residuals, [0.025, 0.975])
    return SphereFit(centre, radius, combined(rows), float(high - low), indices[kept], residuals, rows)


def _above_table(cloud: Cloud, tolerance: float, seed: int, progress: Progress) -> NDArray[np.int64]:
    """Indices of the points in front of the largest plane, or all of them when there is no plane."""
    planes = find_planes(cloud, seed=seed, progress=progress, most=1)
    if not planes:
        return np.arange(len(cloud))
    return np.flatnonzero(cloud.points @ planes[0].normal < planes[0].distance - 3 * tolerance)


def _best_hypothesis(
    points: Array, normals: Array, tolerance: float, radius_range: tuple[float, float], rng: np.random.Generator
) -> tuple[Array, float] | None:
    """Centre and radius with most points; None when not even a twentieth of the points agree."""
    if len(points) < 12:
        return None
    a, b = rng.integers(len(points), size=(2, HYPOTHESES))
    # X_a − ρ n_a and X_b − ρ n_b are nearest to each other at ρ = (X_a − X_b)·(n_a − n_b) / |n_a − n_b|².
    between = normals[a] - normals[b]
    size = (between**2).sum(axis=1)
    sound = size > 0.1  # directions at least 18° apart
    radius = ((points[a] - points[b]) * between).sum(axis=1)[sound] / size[sound]
    centre = (points[a] + points[b])[sound] / 2 - radius[:, None] * (normals[a] + normals[b])[sound] / 2
    best, most = None, max(12.0, len(points) / 20)
    for c, r in zip(centre, radius, strict=True):
        if radius_range[0] <= r <= radius_range[1]:
            # Normals are good to degrees only, so a hypothesis is rough: twice the tolerance, and a twentieth of R.
            count = _on_sphere(points, normals, c, float(r), max(2 * tolerance, 0.05 * float(r))).sum()
            if count > most:
                best, most = (c, float(r)), float(count)
    return best


def _on_sphere(points: Array, normals: Array, centre: Array, radius: float, tolerance: float) -> NDArray[np.bool_]:
    """Which points lie within `tolerance` of the sphere and do not face elsewhere."""
    outward = points - centre
    distance = np.linalg.norm(outward, axis=1)
    alike = (normals * outward).sum(axis=1) > 0.85 * distance
    on: NDArray[np.bool_] = (np.abs(distance - radius) < tolerance) & (alike | ~normals.any(axis=1))
    return on


def _incidence(points: Array, centre: Array) -> Array:
    """|n·r| of each point: how much of an error of depth lies across the surface."""
    outward = points - centre
    cosine = np.abs((outward * points).sum(axis=1)) / np.linalg.norm(outward, axis=1) / points[:, 2]
    return np.asarray(np.maximum(cosine, GRAZING), dtype=np.float64)


def _solve(points: Array, weights: Array, centre: Array) -> tuple[Array, float]:
    """Weighted least orthogonal distances by Gauss–Newton from `centre`."""
    radius = 0.0
    for _ in range(50):
        outward = points - centre
        distance = np.linalg.norm(outward, axis=1)
        design = np.column_stack([outward / distance[:, None], np.ones(len(points))])
        scaled = design * weights[:, None]
        step = np.linalg.solve(scaled.T @ design, scaled.T @ distance)
        centre, radius = centre + step[:3], float(step[3])
        if np.abs(step[:3]).max() < 1e-9:
            break
    return centre, radius


def _robust(points: Array, sigma: Array, centre: Array) -> tuple[Array, float, Array]:
    """Iteratively reweighted fit: centre, radius and the weights, zero for points left out."""
    weights = np.maximum(sigma, 1e-6) ** -2.0
    weights /= np.median(weights)
    centre, radius = _solve(points, weights, centre)
    for _ in range(30):
        noise = np.maximum(sigma, 1e-6) * _incidence(points, centre)
        residual = (np.linalg.norm(points - centre, axis=1) - radius) / noise
        scale = max(1.4826 * float(np.median(np.abs(residual))), 1e-9)
        weights = np.clip(1 - (residual / (TUKEY * scale)) ** 2, 0, None) ** 2 / noise**2
        weights /= np.median(noise) ** -2.0
        previous = centre, radius
        centre, radius = _solve(points, weights, centre)
        if abs(radius - previous[1]) < 1e-7 and np.abs(centre - previous[0]).max() < 1e-7:
            break
    return centre, radius, weights
