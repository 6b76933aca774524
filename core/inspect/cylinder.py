"""A cylinder, shaft or bore, found in a cloud: points whose normals meet one axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.plane_search import above_table, search_tolerance
from core.inspect.shapes import Tube
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.cloud import Cloud

HYPOTHESES = 600
SEARCH_POINTS = 4000
REFINED = 5
LIKE_NORMALS = 0.85


def find_cylinder(
    cloud: Cloud,
    *,
    radius_range_mm: tuple[float, float] = (1.5, 150.0),
    on_table: bool = True,
    seed: int = 0,
    progress: Progress = silent,
) -> tuple[NDArray[np.int64], Tube]:
    """Indices (ascending) of the points on the cylinder that explains most of a cloud, and about where it lies.

    Two points and their normals make a hypothesis: the axis is square to both normals, and seen along it they meet in
    its centre.

    Parameters
    ----------
    cloud
        With normals.
    radius_range_mm
        Cylinders outside are not taken.
    on_table
        Whether the largest plane is a table, and the cylinder in front of it.
    seed
        Of the random search.
    progress
        Told how far it is.

    Raises
    ------
    InputError
        If there is no cylinder.
    """
    tolerance = search_tolerance(cloud)
    mine = above_table(cloud, tolerance, seed, progress) if on_table else np.arange(len(cloud))
    mine = mine[cloud.normals[mine].any(axis=1)]
    points, normals = cloud.points[mine], cloud.normals[mine]
    rng = np.random.default_rng(seed)
    sample = rng.permutation(len(points))[:SEARCH_POINTS]
    tube = _best(points[sample], normals[sample], tolerance, radius_range_mm, rng)
    if tube is None:
        raise InputError(
            f"none of its {len(mine)} points lie on a cylinder", todo="scan it with more sweeps, or draw a region on it"
        )
    none = np.zeros(len(points), dtype=np.int64)
    for _ in range(REFINED):
        on = _on(points, normals, tube, tolerance)
        if on.sum() < 12:
            break
        tube = _improved(points[on], normals[on], tube, none[: int(on.sum())])
    return np.sort(mine[_on(points, normals, tube, tolerance)]), tube


def _best(
    points: Array, normals: Array, tolerance: float, radius_range: tuple[float, float], rng: np.random.Generator
) -> Tube | None:
    """The hypothesis with most points; None when not even a twentieth of the points agree."""
    if len(points) < 12:
        return None
    a, b = rng.integers(len(points), size=(2, HYPOTHESES))
    axis = np.cross(normals[a], normals[b])
    size = np.linalg.norm(axis, axis=1)
    sound = size > 0.3  # directions at least 17° apart
    best, most = None, max(12.0, len(points) / 20)
    for first, second, direction in zip(a[sound], b[sound], axis[sound] / size[sound, None], strict=True):
        across = (points[first] - points[second]) - direction * (direction @ (points[first] - points[second]))
        between = normals[first] - normals[second]
        radius = float(across @ between / (between @ between))
        if not radius_range[0] <= abs(radius) <= radius_range[1]:
            continue
        foot = (points[first] + points[second]) / 2 - radius * (normals[first] + normals[second]) / 2
        tube = Tube.along(foot, direction, abs(radius))
        count = _on(points, normals, tube, max(2 * tolerance, 0.05 * abs(radius))).sum()
        if count > most:
            best, most = tube, float(count)
    return best


def _improved(points: Array, normals: Array, tube: Tube, part: NDArray[np.int64]) -> Tube:
    """The axis square to the normals, its point amid the points, then a step of least squares."""
    direction = np.linalg.eigh(normals.T @ normals)[1][:, 0]
    middle = points.mean(axis=0)
    centre = tube.centre + direction * (direction @ (middle - tube.centre))
    tube = Tube.along(centre, direction, tube.radius)
    for _ in range(10):
        design, misfit = tube.design(points, part), tube.misfit(points, part)
        step = np.linalg.lstsq(design, misfit, rcond=None)[0]
        size = float(np.abs(step).max())
        tube = tube.moved(np.asarray(step * min(1.0, 5.0 / max(size, 1e-12)), dtype=np.float64))
        if size < 1e-6:
            break
    return tube


def _on(points: Array, normals: Array, tube: Tube, tolerance: float) -> NDArray[np.bool_]:
    """Which points lie within `tolerance` of the cylinder and do not face elsewhere."""
    part = np.zeros(len(points), dtype=np.int64)
    facing = (normals * tube.outward(points, part)).sum(axis=1)
    side = 1.0 if np.sum(facing > LIKE_NORMALS) >= np.sum(facing < -LIKE_NORMALS) else -1.0  # a shaft, or a bore
    on: NDArray[np.bool_] = (np.abs(tube.misfit(points, part)) < tolerance) & (side * facing > LIKE_NORMALS)
    return on
