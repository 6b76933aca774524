"""A sphere found in a cloud and fitted robustly: the check of a scan's scale and form against a known radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.faces import find_planes, search_tolerance
from core.inspect.generalised import GRAZING, Sources, generalised_fit
from core.inspect.point_errors import PointErrors, patches
from core.inspect.results import Contribution
from core.inspect.uncertainty import budget, combined
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.cloud import Cloud
from core.scan.normals import with_normals

HYPOTHESES = 600
SEARCH_POINTS = 4000
TUKEY = 4.685


@dataclass(frozen=True, eq=False, slots=True)
class SphereFit:
    """A sphere: `centre` (3,) and `radius_mm` in mm, camera frame, with `u_mm` the radius's standard uncertainty.

    `indices` into the cloud of the points used; `residuals` (mm) of these, outwards positive; `form_mm` is the spread
    of the residuals that holds 95 % of the points, their noise included, and `u_form_mm` the standard uncertainty of
    that spread; `budget` says what `u_mm` is made of.
    """

    centre: Array
    radius_mm: float
    u_mm: float
    form_mm: float
    indices: NDArray[np.int64]
    residuals: Array
    budget: tuple[Contribution, ...]
    u_form_mm: float

    @property
    def diameter_mm(self) -> float:
        """Twice the radius; its standard uncertainty is twice the radius's."""
        return 2 * self.radius_mm


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
    errors: PointErrors | None = None,
    seed: int = 0,
) -> SphereFit:
    """Robust fit of a sphere by least orthogonal distances, with the true covariance of its points.

    Tukey's biweight says which points belong to it; the generalised fit of `core.inspect.generalised` follows.

    Parameters
    ----------
    cloud
        The measured points.
    indices
        Of the points on the sphere; None: found by `find_sphere`.
    errors
        How the points' errors hang together; None: each stretch of a stripe by itself.
    seed
        Of the search.

    Raises
    ------
    InputError
        If there is no sphere, or fewer than 12 points on it.
    """
    errors = errors or PointErrors()
    indices = find_sphere(cloud, seed=seed) if indices is None else indices
    if len(indices) < 12:
        raise InputError(f"{len(indices)} points are too few for a sphere", where="point cloud")
    points, sigma = cloud.points[indices], cloud.sigma[indices]
    # The start: the sphere of least algebraic distance, |X|² = 2 c·X + (R² − |c|²), linear in its unknowns.
    middle = points.mean(axis=0)
    centred = points - middle
    squares = (centred**2).sum(axis=1)
    start = np.linalg.lstsq(np.column_stack([2 * centred, np.ones(len(points))]), squares, rcond=None)[0][:3] + middle
    centre, radius, robust = _robust(points, sigma, start)
    kept = robust > 0
    used, points = cloud.select(indices[kept]), points[kept]
    one_face = np.zeros(len(points), dtype=np.int64)
    sources = Sources.of(used, _outward(points, centre), robust[kept], one_face, patches(used.uv, one_face), errors)
    for _ in range(3):
        outward = _outward(points, centre)
        misfit = np.linalg.norm(points - centre, axis=1) - radius
        design = np.column_stack([outward, np.ones(len(points))])
        fit = generalised_fit(sources.mean(design), sources.mean(misfit), sources)
        centre, radius = centre + fit.estimate[:3], radius + float(fit.estimate[3])
    rows = budget(
        fit.gains[3],
        sources,
        own=fit.own,
        form_mm=fit.form_mm,
        calibrations=() if errors.common is None else errors.common.sources,
    )
    residuals = np.linalg.norm(points - centre, axis=1) - radius
    low, high = np.quantile(residuals, [0.025, 0.975])
    form = float(high - low)
    return SphereFit(centre, radius, combined(rows), form, indices[kept], residuals, rows, _u_form(form, sources))


def _outward(points: Array, centre: Array) -> Array:
    away = points - centre
    unit: Array = away / np.linalg.norm(away, axis=1)[:, None]
    return unit


def _u_form(form: float, sources: Sources) -> float:
    """Standard uncertainty of the range that holds 95 % of normal residuals, from as many draws as there are stretches.

    A quantile q of n draws has the variance q (1 − q)/(n f²), f the density there; the two ends have the correlation
    q/(1 − q) = 0.0256.
    """
    q, sd = 0.025, form / 3.92
    density = float(np.exp(-0.5 * 1.96**2) / np.sqrt(2 * np.pi))
    end = sd * np.sqrt(q * (1 - q) / len(sources.own)) / density
    return float(end * np.sqrt(2 * (1 - q / (1 - q))))


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
    """Iteratively reweighted fit: centre, radius and the robust weights (0 … 1), zero for points left out."""
    weights = np.maximum(sigma, 1e-6) ** -2.0
    weights /= np.median(weights)
    centre, radius = _solve(points, weights, centre)
    robust = np.ones(len(points))
    for _ in range(30):
        noise = np.maximum(sigma, 1e-6) * _incidence(points, centre)
        residual = (np.linalg.norm(points - centre, axis=1) - radius) / noise
        scale = max(1.4826 * float(np.median(np.abs(residual))), 1e-9)
        robust = np.clip(1 - (residual / (TUKEY * scale)) ** 2, 0, None) ** 2
        weights = robust * np.median(noise) ** 2 / noise**2
        previous = centre, radius
        centre, radius = _solve(points, weights, centre)
        if abs(radius - previous[1]) < 1e-7 and np.abs(centre - previous[0]).max() < 1e-7:
            break
    return centre, radius, robust
