"""A sphere found in a cloud and fitted robustly: the check of a scan's scale and form against a known radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.plane_search import above_table, search_tolerance
from core.inspect.point_errors import PointErrors
from core.inspect.results import Contribution
from core.inspect.shapes import Ball
from core.inspect.surface_fit import FEWEST, SurfaceFit, fit_surface
from core.inspect.uncertainty import combined
from core.inspect.uneven_light import with_uneven_light
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.cloud import Cloud
from core.scan.normals import with_normals

HYPOTHESES = 600
SEARCH_POINTS = 4000


@dataclass(frozen=True, eq=False, slots=True)
class SphereFit:
    """A sphere: `centre` (3,) and `radius_mm` in mm, camera frame, with `u_mm` the radius's standard uncertainty.

    `indices` into the cloud of the points used; `residuals` (mm) of these, outwards positive; `form_mm` is the spread
    of the residuals that holds 95 % of the points, their noise included, and `u_form_mm` the standard uncertainty of
    that spread; `budget` says what `u_mm` is made of, and `fit` all that is known of the fitted surface.
    """

    centre: Array
    radius_mm: float
    u_mm: float
    form_mm: float
    indices: NDArray[np.int64]
    residuals: Array
    budget: tuple[Contribution, ...]
    u_form_mm: float
    fit: SurfaceFit[Ball]

    @property
    def diameter_mm(self) -> float:
        """Twice the radius; its standard uncertainty is twice the radius's."""
        return 2 * self.radius_mm


def find_sphere(
    cloud: Cloud,
    *,
    radius_range_mm: tuple[float, float] = (3.0, 150.0),
    on_table: bool = True,
    seed: int = 0,
    progress: Progress = silent,
) -> NDArray[np.int64]:
    """Indices (n,) of the points on the sphere that explains most of a cloud.

    Two points and their normals make a hypothesis: the centre is where the two normals meet.

    Parameters
    ----------
    cloud
        Normals are estimated when it has none.
    radius_range_mm
        Spheres outside are not taken.
    on_table
        Whether the largest plane is a table, and the sphere in front of it.
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
    tolerance = search_tolerance(cloud)
    above = above_table(cloud, tolerance, seed, progress) if on_table else np.arange(len(cloud))
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
        ball = through(points[on])
        centre, radius = ball.centre, ball.radius
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
    indices = find_sphere(cloud, seed=seed) if indices is None else indices
    if len(indices) < FEWEST:
        raise InputError(f"{len(indices)} points are too few for a sphere", where="point cloud")
    errors = errors or PointErrors()
    fit = with_uneven_light(fit_surface(cloud, indices, through(cloud.points[indices]), errors), cloud, errors)
    rows = fit.budget(np.array([0.0, 0.0, 0.0, 1.0]))
    ball = fit.shape
    return SphereFit(
        ball.centre, ball.radius, combined(rows), fit.form.value, fit.indices, fit.residuals, rows, fit.form.u, fit
    )


def through(points: Array) -> Ball:
    """The sphere through points (N, 3) of least algebraic distance: |X|² = 2 c·X + (R² − |c|²) is linear."""
    middle = points.mean(axis=0)
    centred = points - middle
    squares = (centred**2).sum(axis=1)
    solved = np.linalg.lstsq(np.column_stack([2 * centred, np.ones(len(points))]), squares, rcond=None)[0]
    return Ball(middle + solved[:3], float(np.sqrt(max(solved[3] + solved[:3] @ solved[:3], 1e-12))))


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
