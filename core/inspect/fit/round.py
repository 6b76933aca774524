"""Spheres and cylinders: found in a cloud, fitted robustly, and as unsure as uneven light makes them.

A search makes hypotheses of two points and their normals; the one that explains most points wins, and is refined.

On a flank a stripe's section is brighter on the side turned to the laser, so its middle is off to there. A scan that is
solved twice has taken that off (`core.scan.bend_correction`), but for a part. That pulls the flanks, where surface
normal and line of sight make an angle of cosine c, against the top. Radius and centre follow, the further the less of
the surface is seen, by 1/(1 − c): the centre along the line of sight, as far as the radius grows, for the top stays
where it is.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.causes import Cause
from core.inspect.fit.plane_search import POINT_CLOUD, above_table, search_tolerance
from core.inspect.fit.shapes import Cylinder, Sphere, nearest_to
from core.inspect.fit.surface_fit import SurfaceFit
from core.inspect.uncertainty.budget import Effect
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Message
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.normals import pixel_angle, with_normals

Round = TypeVar("Round", Sphere, Cylinder)

HYPOTHESES = 600
"""Pairs of points tried. With a fifth of the points on the surface, 24 of them are two good ones."""
SEARCH_POINTS = 4000
"""Points, drawn at random, that vote: enough to tell hypotheses apart."""
REFINED = 5
"""Rounds of choosing points and fitting them again."""
LIKE_NORMALS = 0.85
"""Cosine, 32°: points whose normals are farther from the surface's are of another one."""
FEWEST_VOTES, ONE_IN = 12, 20
"""A surface that explains fewer points, or fewer than one in so many, is none."""

SPHERE_RADII_MM, CYLINDER_RADII_MM = (3.0, 150.0), (1.5, 150.0)
"""Spheres and cylinders outside are not looked for."""

SECTION = 0.8
"""How far a section of light of σ w on a surface of radius R may be off at the flanks, radially, in w²/R: 2 to 3 on
rendered spheres of 50 mm as they are seen, of which a third at most is left where the scan was solved twice."""
LEAST_SEEN = 0.1
"""1 − c of what is seen of a surface is taken to be at least this."""


def find_sphere(
    cloud: Cloud,
    *,
    radius_range_mm: tuple[float, float] = SPHERE_RADII_MM,
    on_table: bool = True,
    seed: int = 0,
    progress: Progress = silent,
) -> NDArray[np.int64]:
    """Find the sphere that fits the most of a cloud by RANSAC; return the indices (n,) of the points on it.

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
        Called with how far it is.

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
    best = _best_sphere(points[sample], normals[sample], tolerance, radius_range_mm, rng)
    if best is None:
        raise InputError(
            Message(
                "surface.no_sphere", "none of the {n} points beside the table's plane lie on a sphere", n=len(above)
            ),
            where=POINT_CLOUD,
            todo=Message("surface.advice_scan_sphere", "scan the sphere with more sweeps"),
        )
    centre, radius = best
    for _ in range(REFINED):
        on = _on_sphere(points, normals, centre, radius, tolerance)
        if on.sum() < FEWEST_VOTES:
            break
        sphere = sphere_through(points[on])
        centre, radius = sphere.centre, sphere.radius
    return above[_on_sphere(points, normals, centre, radius, tolerance)]


def too_few_for_a_sphere(count: int) -> Message:
    """Make the message that `count` points are too few to fit a sphere."""
    return Message("surface.too_few_for_sphere", "{n} points are too few for a sphere", n=count)


def sphere_through(points: Array) -> Sphere:
    """Fit a sphere to points (N, 3) in mm by linear (algebraic) least squares."""
    middle = points.mean(axis=0)
    centred = points - middle
    squares = (centred**2).sum(axis=1)
    solved = np.linalg.lstsq(np.column_stack([2 * centred, np.ones(len(points))]), squares, rcond=None)[0]
    return Sphere(middle + solved[:3], float(np.sqrt(max(solved[3] + solved[:3] @ solved[:3], 1e-12))))


def _best_sphere(
    points: Array, normals: Array, tolerance: float, radius_range: tuple[float, float], rng: np.random.Generator
) -> tuple[Array, float] | None:
    """Centre and radius with most points; None when not even a twentieth of the points agree."""
    if len(points) < FEWEST_VOTES:
        return None
    a, b = rng.integers(len(points), size=(2, HYPOTHESES))
    # X_a − ρ n_a and X_b − ρ n_b are nearest to each other at ρ = (X_a − X_b)·(n_a − n_b) / |n_a − n_b|².
    between = normals[a] - normals[b]
    size = (between**2).sum(axis=1)
    sound = size > 0.1  # directions at least 18° apart
    radius = ((points[a] - points[b]) * between).sum(axis=1)[sound] / size[sound]
    centre = (points[a] + points[b])[sound] / 2 - radius[:, None] * (normals[a] + normals[b])[sound] / 2
    best, most = None, max(float(FEWEST_VOTES), len(points) / ONE_IN)
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
    alike = (normals * outward).sum(axis=1) > LIKE_NORMALS * distance
    on: NDArray[np.bool_] = (np.abs(distance - radius) < tolerance) & (alike | ~normals.any(axis=1))
    return on


def find_cylinder(
    cloud: Cloud,
    *,
    on_table: bool = True,
    progress: Progress = silent,
) -> tuple[NDArray[np.int64], Cylinder]:
    """Find the cylinder that fits the most of a cloud; return its points' indices (n,) and an approximate cylinder.

    Two points and their normals make a hypothesis: the axis is square to both normals, and seen along it they meet in
    its centre.

    Parameters
    ----------
    cloud
        With normals.
    on_table
        Whether the largest plane is a table, and the cylinder in front of it.
    progress
        Called with how far it is.

    Raises
    ------
    InputError
        If there is no cylinder.
    """
    tolerance = search_tolerance(cloud)
    mine = above_table(cloud, tolerance, 0, progress) if on_table else np.arange(len(cloud))
    mine = mine[cloud.normals[mine].any(axis=1)]
    points, normals = cloud.points[mine], cloud.normals[mine]
    rng = np.random.default_rng(0)
    sample = rng.permutation(len(points))[:SEARCH_POINTS]
    cylinder = _best_cylinder(points[sample], normals[sample], tolerance, CYLINDER_RADII_MM, rng)
    if cylinder is None:
        raise InputError(
            Message("surface.no_cylinder", "none of its {n} points lie on a cylinder", n=len(mine)),
            todo=Message("surface.advice_sweeps_or_region", "scan it with more sweeps, or draw a region on it"),
        )
    none = np.zeros(len(points), dtype=np.int64)
    for _ in range(REFINED):
        on = _on_cylinder(points, normals, cylinder, tolerance)
        if on.sum() < FEWEST_VOTES:
            break
        cylinder = _refined(points[on], normals[on], cylinder, none[: int(on.sum())])
    return np.sort(mine[_on_cylinder(points, normals, cylinder, tolerance)]), cylinder


def _best_cylinder(
    points: Array, normals: Array, tolerance: float, radius_range: tuple[float, float], rng: np.random.Generator
) -> Cylinder | None:
    """The hypothesis with most points; None when not even a twentieth of the points agree."""
    if len(points) < FEWEST_VOTES:
        return None
    a, b = rng.integers(len(points), size=(2, HYPOTHESES))
    axis = np.cross(normals[a], normals[b])
    size = np.linalg.norm(axis, axis=1)
    sound = size > 0.3  # directions at least 17° apart
    best, most = None, max(float(FEWEST_VOTES), len(points) / ONE_IN)
    for first, second, direction in zip(a[sound], b[sound], axis[sound] / size[sound, None], strict=True):
        across = (points[first] - points[second]) - direction * (direction @ (points[first] - points[second]))
        between = normals[first] - normals[second]
        radius = float(across @ between / (between @ between))
        if not radius_range[0] <= abs(radius) <= radius_range[1]:
            continue
        foot = (points[first] + points[second]) / 2 - radius * (normals[first] + normals[second]) / 2
        cylinder = Cylinder.along(foot, direction, abs(radius))
        count = _on_cylinder(points, normals, cylinder, max(2 * tolerance, 0.05 * abs(radius))).sum()
        if count > most:
            best, most = cylinder, float(count)
    return best


def _refined(points: Array, normals: Array, cylinder: Cylinder, part: NDArray[np.int64]) -> Cylinder:
    """The axis square to the normals, its point amid the points, then least squares."""
    direction = np.linalg.eigh(normals.T @ normals)[1][:, 0]
    middle = points.mean(axis=0)
    centre = cylinder.centre + direction * (direction @ (middle - cylinder.centre))
    return nearest_to(Cylinder.along(centre, direction, cylinder.radius), points, part)


def _on_cylinder(points: Array, normals: Array, cylinder: Cylinder, tolerance: float) -> NDArray[np.bool_]:
    """Which points lie within `tolerance` of the cylinder and do not face elsewhere."""
    part = np.zeros(len(points), dtype=np.int64)
    facing = (normals * cylinder.outward(points, part)).sum(axis=1)
    side = 1.0 if np.sum(facing > LIKE_NORMALS) >= np.sum(facing < -LIKE_NORMALS) else -1.0  # a shaft, or a bore
    on: NDArray[np.bool_] = (np.abs(cylinder.misfit(points, part)) < tolerance) & (side * facing > LIKE_NORMALS)
    return on


def with_uneven_light(fit: SurfaceFit[Round], cloud: Cloud, errors: PointErrors) -> SurfaceFit[Round]:
    """Add the uncertainty by uneven light to a fitted sphere or cylinder; unchanged if the stripes' σ is not known."""
    if not errors.stripe_px > 0:
        return fit
    used = cloud.select(fit.indices)
    outward = fit.shape.outward(used.points, fit.part)
    cosine = np.abs((outward * used.points).sum(axis=1)) / np.linalg.norm(used.points, axis=1)
    width = errors.stripe_px * pixel_angle(used.points, used.uv) * float(np.median(used.points[:, 2]))
    at_flank = SECTION * width**2 / fit.shape.radius
    grown = at_flank / max(1 - float(np.quantile(cosine, 0.05)), LEAST_SEEN)
    effect = Effect(Cause.UNEVEN_LIGHT, grown * _follow(fit.shape)[:, None], shared=False, point_mm=at_flank)
    return replace(fit, effects=(*fit.effects, effect))


def _follow(shape: Sphere | Cylinder) -> Array:
    """(p,) how the parameters follow when the radius grows by 1 and the top stays where it is."""
    away = shape.centre / np.linalg.norm(shape.centre)
    if isinstance(shape, Sphere):
        return np.append(away, 1.0)
    return np.concatenate([away @ shape.axes, np.zeros(2 if shape.turns else 0), [1.0]])
