"""Surface normals from the neighbours in the picture.

On a plane 1/z = π·r is linear in the ray, so a plane through the neighbours of a point is a small linear fit of the
inverse depth over the ray, and the normal towards the camera is −π/|π|. Neighbours beyond a depth edge are left out by
the steepest slope a surface can show, the rest by Tukey's biweight.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.compiled import compiled, inlined
from core.model.arrays import Array
from core.model.robust import TUKEY
from core.model.small_arrays import new_row, new_table, zero_table
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Surface

Points = TypeVar("Points", Cloud, Surface)

# Held by tests/scan/surface/test_fusion.py (normals) on tilted planes, beside a step and against wrong points.
STEEPEST = np.tan(np.radians(78.0))
"""Steepest slope dz/dx of one surface; light along a steeper one is not extracted."""
MOST_NEIGHBOURS, LEAST_NEIGHBOURS = 80, 6
"""Neighbours that one fit takes: more cost time and add nothing to a normal, fewer do not determine it."""
CORRELATED = 8.0
"""Neighbours that share one error: points along one stripe are not independent."""
WORST_TILT = 0.15
"""Standard uncertainty of a normal's direction in rad up to which it counts as determined."""
LEAST_SIGMA_SHARE = 0.2
"""Of the points' median σ that each has at least: none outweighs all others."""
LEAST_WIDTH_SHARE = 0.2
"""Of the radius: neighbours whose standard deviation across is less lie along one stripe."""
LAYER_SIGMAS = 4.0
"""Standard uncertainties (and what slope allows) within which a neighbour in depth is on the same surface."""
ANGLE_SAMPLE = 100_000
"""Points that tell the angle of a pixel as well as all of them."""

# The radius within which neighbours are taken, in px.
SMALLEST_RADIUS_PX, LARGEST_RADIUS_PX, RADIUS_STEP = 4.0, 40.0, 1.35
"""From and up to which it grows, and by which factor."""
WIDE_SHARE, MOST_POINTS = 0.3, 0.8
"""It is enough where neighbours spread by this share of it across their stripe, for this share of the points,"""
RADIUS_SAMPLE = 300
"""of so many of them."""


def pixel_angle(points: Array, uv: Array) -> float:
    """Measure the change of x/z per pixel, about 1/focal length in px, of `points` (N, 3) seen at `uv` (N, 2).

    Raises
    ------
    ValueError
        If all points were seen at one pixel.
    """
    thin = slice(None, None, max(1, len(points) // ANGLE_SAMPLE))
    points, uv = points[thin], uv[thin]
    rays = points[:, :2] / points[:, 2:]
    spread = float(np.var(uv, axis=0).sum())
    if not spread > 0:
        raise ValueError("points seen at one pixel give no angle per pixel")
    return float(np.sqrt(np.var(rays, axis=0).sum() / spread))


def with_normals(points: Points, progress: Progress = silent) -> Points:
    """Estimate a unit normal towards the camera for each point of a cloud or surface.

    Neighbours are taken within the smallest distance in the picture that reaches across several stripes for most
    points.

    Parameters
    ----------
    points
        A cloud or a fused surface.
    progress
        Called with how far it is.

    Returns
    -------
    Cloud or Surface
        Normals are zero where the neighbours do not determine them: fewer than 6, all along one stripe, or the
        direction's standard uncertainty above 0.15 rad.
    """
    normals = np.zeros((len(points), 3))
    if len(points) >= LEAST_NEIGHBOURS and np.var(points.uv, axis=0).sum() > 0:
        progress("normals", 0, 2)
        radius = reach(points.uv)
        progress("normals", 1, 2)
        normals = _estimate(points.points, points.uv, points.sigma, radius)
        progress("normals", 2, 2)
    return replace(points, normals=normals)


def reach(uv: Array) -> float:
    """Find the radius in px at which most points of `uv` (N, 2) have neighbours on both sides of their own stripe."""
    sample = np.linspace(0, len(uv) - 1, min(len(uv), RADIUS_SAMPLE)).astype(np.int64)
    tree = cKDTree(uv)
    radius = SMALLEST_RADIUS_PX
    while radius < LARGEST_RADIUS_PX:
        around = tree.query_ball_point(uv[sample], radius)
        across = np.array([_narrow_spread(uv[np.asarray(near)]) for near in around])
        if np.mean(across > WIDE_SHARE * radius) > MOST_POINTS:
            break
        radius *= RADIUS_STEP
    return radius


def _narrow_spread(uv: Array) -> float:
    """Standard deviation of `uv` (n, 2) across the direction it spreads least in."""
    if len(uv) <= 2:
        return 0.0
    off = uv - np.add.reduce(uv, axis=0) / len(uv)  # np.cov gives the same bits, and is asked some thousand times
    (a, b), (_, c) = (off.T @ off) * (1 / len(uv))
    return float(np.sqrt(max((a + c) / 2 - np.hypot((a - c) / 2, b), 0.0)))


def _estimate(xyz: Array, uv: Array, sigma: Array, radius: float) -> Array:
    """Normals (N, 3) of points sorted into square buckets of side `radius`."""
    column, row = np.floor((uv - uv.min(axis=0)) / radius).astype(np.int64).T
    columns, rows = int(column.max()) + 1, int(row.max()) + 1
    bucket = row * columns + column
    order = np.argsort(bucket, kind="stable")
    starts = np.searchsorted(bucket[order], np.arange(rows * columns + 1))
    normals = np.empty((len(xyz), 3))
    floor = LEAST_SIGMA_SHARE * float(np.median(sigma)) + 1e-9
    points = _PointGrid(
        np.ascontiguousarray(xyz[order]),
        np.ascontiguousarray(uv[order]),
        np.maximum(sigma[order], floor),
        xyz[order, 2] ** 2 / np.maximum(sigma[order], floor),
        bucket[order],
        starts,
        columns,
        rows,
        radius,
        pixel_angle(xyz, uv),
    )
    normals[order] = _fit_all(points)
    return normals


class _PointGrid(NamedTuple):
    """N points sorted into square buckets of side `radius` px, `columns` × `rows` of them.

    `sharpness` (N,) is 1/σ of the inverse depths; `bucket` (N,) of each point; `starts` where in the points each bucket
    begins, and ends at the next one's begin; `angle` is that of one pixel.
    """

    xyz: Array
    uv: Array
    sigma: Array
    sharpness: Array
    bucket: NDArray[np.int64]
    starts: NDArray[np.int64]
    columns: int
    rows: int
    radius: float
    angle: float


@compiled()
def _fit_all(points: _PointGrid) -> Array:
    """A robust plane in inverse depth around each point; see the module's docstring."""
    xyz, sigma, radius, angle = points.xyz, points.sigma, points.radius, points.angle
    normals, near, weights = zero_table(len(xyz), 3), new_table(4, 4 * MOST_NEIGHBOURS), new_row(4 * MOST_NEIGHBOURS)
    for i in range(len(xyz)):
        count = _neighbours(i, points, near)
        if count < LEAST_NEIGHBOURS:
            continue
        for k in range(count):
            weights[k] = 1.0
        scale = 1.0
        a = b = c = 0.0
        narrow = 0.0
        for _ in range(3):
            a, b, c, narrow = _inverse_depth_plane(near, weights, count)
            if narrow < (LEAST_WIDTH_SHARE * radius) ** 2:
                break
            scale = _reweight(near, weights, count, (a, b, c))
        if narrow < (LEAST_WIDTH_SHARE * radius) ** 2:
            continue
        # 1/z = a + b du + c dv  →  π over the ray coordinates, of which one pixel is `angle`.
        x, y, z = xyz[i, 0], xyz[i, 1], xyz[i, 2]
        px, py = b / angle, c / angle
        pz = a - px * x / z - py * y / z
        size = math.sqrt(px * px + py * py + pz * pz)
        effective = max(count / CORRELATED, 1.0)
        tilt = scale * sigma[i] / (z * z) / math.sqrt(effective * narrow) / angle / size
        if tilt < WORST_TILT:
            normals[i, 0], normals[i, 1], normals[i, 2] = -px / size, -py / size, -pz / size
    return normals


@inlined()
def _neighbours(i: int, points: _PointGrid, near: Array) -> int:
    """Neighbours of point i on its own surface into `near`, evenly thinned to about MOST_NEIGHBOURS; how many.

    Of each, one below the other: how far it is along u and v, its inverse depth, and 1/σ of that.
    """
    xyz, uv, sigma, starts = points.xyz, points.uv, points.sigma, points.starts
    columns, rows = points.columns, points.rows
    row, column = points.bucket[i] // columns, points.bucket[i] % columns
    left, right = max(column - 1, 0), min(column + 1, columns - 1)
    candidates = 0
    for r in range(max(row - 1, 0), min(row + 1, rows - 1) + 1):
        candidates += starts[r * columns + right + 1] - starts[r * columns + left]
    stride = max(1, candidates // (3 * MOST_NEIGHBOURS))  # the disc covers a third of the nine buckets
    count = 0
    for r in range(max(row - 1, 0), min(row + 1, rows - 1) + 1):
        for j in range(starts[r * columns + left], starts[r * columns + right + 1], stride):
            du, dv = uv[j, 0] - uv[i, 0], uv[j, 1] - uv[i, 1]
            apart = math.sqrt(du * du + dv * dv)
            if apart > points.radius:
                continue
            noise = math.sqrt(sigma[i] ** 2 + sigma[j] ** 2)
            if abs(xyz[j, 2] - xyz[i, 2]) > LAYER_SIGMAS * noise + STEEPEST * apart * points.angle * xyz[i, 2]:
                continue
            if count < near.shape[1]:
                near[0, count], near[1, count] = du, dv
                near[2, count], near[3, count] = 1 / xyz[j, 2], points.sharpness[j]
                count += 1
    return count


@inlined(fastmath={"reassoc"})
def _inverse_depth_plane(near: Array, weights: Array, count: int) -> tuple[float, float, float, float]:
    """Weighted fit 1/z = a + b du + c dv about a point, and the variance (px²) of the neighbours across."""
    sw = su = sv = sq = 0.0
    for k in range(count):
        w = weights[k] * near[3, k] ** 2
        sw += w
        su += w * near[0, k]
        sv += w * near[1, k]
        sq += w * near[2, k]
    if sw <= 0:
        return 0.0, 0.0, 0.0, 0.0
    mu, mv, mq = su / sw, sv / sw, sq / sw
    uu = vv = cross = uq = vq = 0.0
    for k in range(count):
        w = weights[k] * near[3, k] ** 2
        du, dv, dq = near[0, k] - mu, near[1, k] - mv, near[2, k] - mq
        uu += w * du * du
        vv += w * dv * dv
        cross += w * du * dv
        uq += w * du * dq
        vq += w * dv * dq
    uu, vv, cross, uq, vq = uu / sw, vv / sw, cross / sw, uq / sw, vq / sw
    half = math.sqrt(((uu - vv) / 2) ** 2 + cross * cross)
    narrow = (uu + vv) / 2 - half
    determinant = uu * vv - cross * cross
    if narrow <= 0 or determinant <= 0:
        return mq, 0.0, 0.0, 0.0
    b = (vv * uq - cross * vq) / determinant
    c = (uu * vq - cross * uq) / determinant
    return mq - b * mu - c * mv, b, c, narrow


@inlined(fastmath={"reassoc"})
def _reweight(near: Array, weights: Array, count: int, plane: tuple[float, float, float]) -> float:
    """Tukey's weights from the residuals in units of σ; returns the residuals' scale, at least 1."""
    a, b, c = plane
    total = squares = 0.0
    for k in range(count):
        e = (near[2, k] - (a + b * near[0, k] + c * near[1, k])) * near[3, k]
        total += weights[k]
        squares += weights[k] * e * e
    scale = max(math.sqrt(squares / total), 1.0) if total > 0 else 1.0
    for k in range(count):
        e = (near[2, k] - (a + b * near[0, k] + c * near[1, k])) * near[3, k] / (TUKEY * scale)
        weights[k] = (1 - e * e) ** 2 if abs(e) < 1 else 0.0
    return scale
