"""Curvature of a scanned surface, by quadrics fitted around each of its nodes.

The nodes are the cloud's points averaged over squares of the picture (`core.scan.surface.fusion`). Around each, the
others within a few squares are laid over its tangent plane, and with ξ, η in that plane and h above it

    h = h₀ + p ξ + q η + (a ξ² + 2 b ξη + c η²)/2

is fitted by Tukey's biweight, then again over the plane that p and q ask for, twice, so that the surface's normal
is h's axis and (a, b, c) its second fundamental form. A sphere is a quadric over its tangent plane at a rim as well as
on top, where the picture sees it as anything but one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.compiled import compiled, inlined
from core.model.arrays import Array, set_field
from core.model.directions import square_to
from core.model.robust import MAD_TO_SD, TUKEY
from core.model.small_arrays import invert, median_of, new_row, new_table
from core.scan.surface.cloud import Cloud
from core.scan.surface.fusion import fuse
from core.scan.surface.normals import pixel_angle
from core.threads import ordered_map

# Nodes and their neighbours. Held by tests/scan/surface/test_bends.py on a ball, a cylinder and a flat face.
NODES_ACROSS = 320
"""Squares along the picture's width."""
REACH = 8.0
"""Squares within which neighbours are looked for, as long as they are on a face that the camera looks at straight."""
MOST_NEIGHBOURS, LEAST_NEIGHBOURS = 64, 20
"""Nodes that a quadric is fitted to; it has six unknowns."""
CORRELATED = 4.0
"""Nodes that share one error: light planes, and stripes averaged along themselves, are wrong over several."""

# The fit of a quadric and what is believed of it; held by the same tests.
ROUNDS = 4
"""Rounds of reweighting a fit."""
TURNS = 2
"""Times that a fit is repeated over the plane that the one before gives."""
LEAST_COSINE = 0.2
"""Depth noise counts along the normal as if the surface were seen no flatter than this, 78°."""
LEAST_SIGMA_SHARE = 0.2
"""Of the nodes' median σ that each has at least: none outweighs all others."""
MOST_SLOPE = 5.0
"""Of the surface over the plane of the fit: with more the fit has not found the surface."""
SIGNIFICANT = 2.0
"""Standard uncertainties below which a bend is none."""
LARGEST_BEND = 2.0
"""Curvature times reach: what bends more is an edge, or a ball no larger than what it is fitted to."""
AT_A_TIME = 1000
"""Nodes, about, that one thread fits at a time."""
OFF_SURFACE_MM = 0.5
"""Distance in mm from a node's quadric beyond which a point is on another surface."""


@dataclass(frozen=True, eq=False, slots=True)
class Bends:
    """Unit normals towards the camera (M, 3) and curvature (M, 3, 3) in 1/mm of a surface, at M nodes (M, 3) in mm.

    `curvature` (M, 3, 3) in 1/mm: the normal changes by K·δX over δX, so K is positive where the surface is convex;
    all zero where no bend is sure, and less than was fitted where it is hardly. `known` (M,) where there is a normal.
    """

    points: Array
    normals: Array
    curvature: Array
    known: NDArray[np.bool_]
    _tree: cKDTree | None = field(init=False, repr=False)

    def __post_init__(self) -> None:
        set_field(self, "_tree", cKDTree(self.points[self.known]) if self.known.any() else None)

    @property
    def flat(self) -> bool:
        """Whether the surface has no significant bend anywhere."""
        return not self.curvature.any()

    def at(self, points: Array) -> tuple[Array, Array]:
        """Interpolate unit normals (N, 3) and curvature (N, 3, 3) at `points` (N, 3); zeros where no node is near."""
        normals, curvature = np.zeros((len(points), 3)), np.zeros((len(points), 3, 3))
        if self._tree is None or not len(points):
            return normals, curvature
        near = np.flatnonzero(self.known)[self._tree.query(points)[1]]
        away = points - self.points[near]
        turned = self.normals[near] + np.einsum("nij,nj->ni", self.curvature[near], away)
        turned /= np.linalg.norm(turned, axis=1)[:, None]
        height = (away * (self.normals[near] + turned)).sum(axis=1) / 2
        on = np.abs(height) < OFF_SURFACE_MM
        normals[on], curvature[on] = turned[on], self.curvature[near[on]]
        return normals, curvature


def bends_of(cloud: Cloud, image_size: tuple[int, int]) -> Bends:
    """Measure normals and curvature of the surface that a cloud shows in pictures of `image_size` (width, height)."""
    cell_px = image_size[0] / NODES_ACROSS
    nodes = fuse(cloud, image_size, cell_px)
    points, sigma = nodes.points, np.maximum(nodes.sigma, LEAST_SIGMA_SHARE * float(np.median(nodes.sigma)))
    count = len(points)
    if count <= LEAST_NEIGHBOURS or not np.ptp(nodes.uv, axis=0).any():
        return Bends(points, np.zeros((count, 3)), np.zeros((count, 3, 3)), np.zeros(count, dtype=np.bool_))
    reach = REACH * cell_px * pixel_angle(points, nodes.uv) * float(np.median(points[:, 2]))
    distance, near = cKDTree(points).query(points, min(MOST_NEIGHBOURS, count), distance_upper_bound=reach)
    inside = np.isfinite(distance)
    near = np.where(inside, near, 0)
    away = np.where(inside[..., None], points[near] - points[:, None, :], 0.0)
    taper = np.where(inside, 1 - (np.where(inside, distance, 0.0) / reach) ** 2, 0.0)
    fit = _Quadrics.over(-points / np.linalg.norm(points, axis=1)[:, None], away, taper, sigma[near], points)
    for _ in range(TURNS):
        fit = _Quadrics.over(fit.normal, away, taper, sigma[near], points)
    size = np.sqrt((fit.curvature**2).sum(axis=(1, 2)))
    known = (inside.sum(axis=1) >= LEAST_NEIGHBOURS) & fit.sound & (size * reach < LARGEST_BEND)
    sure = np.where(known, np.maximum(1 - (SIGNIFICANT * fit.sigma / np.maximum(size, 1e-12)) ** 2, 0.0), 0.0)
    return Bends(points, fit.normal, fit.curvature * sure[:, None, None], known)


@dataclass(frozen=True, eq=False, slots=True)
class _Quadrics:
    """A quadric around each of M nodes: `normal` (M, 3), `curvature` (M, 3, 3), its standard uncertainty `sigma`."""

    normal: Array
    curvature: Array
    sigma: Array
    sound: NDArray[np.bool_]

    @classmethod
    def over(cls, axis: Array, away: Array, taper: Array, sigma: Array, seen: Array) -> _Quadrics:
        """Fits over planes square to `axis` (M, 3) to neighbours that lie `away` (M, K, 3); `sigma` of their depth.

        Several at a time: each node is fitted by itself.
        """
        edges = np.linspace(0, len(axis), max(1, len(axis) // AT_A_TIME) + 1).astype(np.int64)
        parts = [slice(first, last) for first, last in pairwise(edges.tolist())]
        fits = tuple(ordered_map(lambda p: cls._of(axis[p], away[p], taper[p], sigma[p], seen[p]), parts))
        return cls(*(np.concatenate([getattr(fit, one.name) for fit in fits]) for one in fields(cls)))

    @classmethod
    def _of(cls, axis: Array, away: Array, taper: Array, sigma: Array, seen: Array) -> _Quadrics:
        first, second = np.moveaxis(square_to(axis), 2, 0)
        cosine = np.abs((axis * seen).sum(axis=1)) / np.linalg.norm(seen, axis=1)
        noise = sigma * np.maximum(cosine, LEAST_COSINE)[:, None]
        solved, variance, scale, spread, used = _fit_all(np.stack([first, second, axis], axis=1), away, taper, noise)
        p, q, a, b, c = (solved[:, k] / scale**power for k, power in zip(range(1, 6), (1, 1, 2, 2, 2), strict=True))
        normal = axis - p[:, None] * first - q[:, None] * second
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        form = a, b, c
        curvature = -_tensor(first, second, form)
        own = np.sqrt(CORRELATED * np.maximum(variance[:, 3] + 2 * variance[:, 4] + variance[:, 5], 0)) / scale**2
        sound = (np.hypot(p, q) < MOST_SLOPE) & np.isfinite(own) & (used > LEAST_NEIGHBOURS / 2)
        return cls(normal, curvature, own * spread, sound)


@compiled()
def _fit_all(frames: Array, away: Array, taper: Array, noise: Array) -> tuple[Array, Array, Array, Array, Array]:
    """A quadric for each of M nodes over a plane, of which `frames` (M, 3, 3) has two tangents and the axis.

    To K neighbours that lie `away` (M, K, 3), weighed by `taper` and `noise` (M, K). Returns the quadrics' six numbers
    (M, 6), ξ and η in units of the `scale`, with their variances; the scale; the residuals' spread; and the sum of the
    weights (M,).
    """
    nodes, most = taper.shape
    found, variance, design = new_table(nodes, 6), new_table(nodes, 6), new_table(most, 6)
    scales, spreads, used = new_row(nodes), new_row(nodes), new_row(nodes)
    height, sd, weight, robust = new_row(most), new_row(most), new_row(most), new_row(most)
    off, matrix, inverse, right = new_row(most), new_table(6, 6), new_table(6, 6), new_row(6)
    for m in range(nodes):
        count, total, square = 0, 0.0, 0.0
        for k in range(most):
            if taper[m, k] > 0:
                x, y, z = away[m, k, 0], away[m, k, 1], away[m, k, 2]
                xi = x * frames[m, 0, 0] + y * frames[m, 0, 1] + z * frames[m, 0, 2]
                eta = x * frames[m, 1, 0] + y * frames[m, 1, 1] + z * frames[m, 1, 2]
                design[count, 1], design[count, 2] = xi, eta
                height[count] = x * frames[m, 2, 0] + y * frames[m, 2, 1] + z * frames[m, 2, 2]
                sd[count], weight[count], robust[count] = noise[m, k], taper[m, k] / noise[m, k] ** 2, 1.0
                total += taper[m, k]
                square += taper[m, k] * (xi * xi + eta * eta)
                count += 1
        scale = math.sqrt(max(square / max(total, 1e-9), 1e-9))
        for k in range(count):
            xi, eta = design[k, 1] / scale, design[k, 2] / scale
            design[k, 0], design[k, 1], design[k, 2] = 1.0, xi, eta
            design[k, 3], design[k, 4], design[k, 5] = xi * xi / 2, xi * eta, eta * eta / 2
        spread = 1.0
        for _ in range(ROUNDS):
            _add_up(design, weight, robust, height, count, matrix, right)
            invert(matrix, inverse, 6)
            for i in range(6):
                found[m, i], variance[m, i] = 0.0, inverse[i, i]
                for j in range(6):
                    found[m, i] += inverse[i, j] * right[j]
            for k in range(count):
                off[k] = height[k]
                for i in range(6):
                    off[k] -= design[k, i] * found[m, i]
                off[k] = abs(off[k]) / sd[k]
            spread = max(MAD_TO_SD * (median_of(off, 0, count) if count > 0 else 1.0), 1.0)
            for k in range(count):
                robust[k] = max(1 - (off[k] / (TUKEY * spread)) ** 2, 0.0) ** 2
        scales[m], spreads[m], used[m] = scale, spread, 0.0
        for k in range(count):
            used[m] += robust[k]
    return found, variance, scales, spreads, used


@inlined()
def _add_up(
    design: Array, weight: Array, robust: Array, height: Array, count: int, matrix: Array, right: Array
) -> None:
    """Normal equations of `count` neighbours, with as much added to their diagonal as keeps them solvable."""
    for i in range(6):
        right[i] = 0.0
        for j in range(i + 1):
            matrix[i, j] = 0.0
    for k in range(count):
        for i in range(6):
            weighted = weight[k] * robust[k] * design[k, i]
            right[i] += weighted * height[k]
            for j in range(i + 1):
                matrix[i, j] += weighted * design[k, j]
    trace = 0.0
    for i in range(6):
        trace += matrix[i, i]
    for i in range(6):
        matrix[i, i] += 1e-9 * trace + 1e-12
        for j in range(i):
            matrix[j, i] = matrix[i, j]


def _tensor(first: Array, second: Array, form: tuple[Array, Array, Array]) -> Array:
    """(M, 3, 3) of a second fundamental form given in the frame of two tangents."""
    a, b, c = (one[:, None, None] for one in form)
    ff, ss = first[:, :, None] * first[:, None, :], second[:, :, None] * second[:, None, :]
    fs = first[:, :, None] * second[:, None, :]
    return np.asarray(a * ff + b * (fs + fs.transpose(0, 2, 1)) + c * ss)
