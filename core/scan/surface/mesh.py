"""Mesh over a fused surface: Delaunay triangulation in the picture, cut where the surface is not continuous.

Between stripes the grid is empty, so neighbours are found by Delaunay's triangulation of the pixel positions. A
triangle is left out when one of its edges

- is long in the picture: nothing was seen between its ends;
- is a depth jump: its ends differ by more than their σ explain, and the edge is either too steep to have been seen at
  all (the angle at which the camera would look along it) or leaves the tangent planes of both its ends (a step between
  two parallel faces does; a kink leaves at most one of them by much).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.errors import InputError
from core.messages import Message
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.surface.delaunay import delaunay
from core.scan.surface.fused_surface import Mesh, Surface
from core.scan.surface.normals import pixel_angle

# What is one continuous surface. Held by tests/scan/surface/test_mesh.py on steps and on noise.
JUMP_SIGMAS = 5.0
"""Standard uncertainties below which a depth difference is no jump."""
STEEPEST_EDGE = np.radians(80.0)
"""rad between an edge and the picture's plane above which it is a depth jump: 2° more than a surface that is seen."""
LARGEST_KINK = np.radians(50.0)
"""rad above which an edge that leaves the tangent planes of both its ends is a depth jump."""
LONGEST_EDGE = 3.0
"""Times the longest edge of nine triangles in ten: longer edges span what was not seen."""


def build_mesh(
    surface: Surface,
    *,
    max_edge_px: float | None = None,
    progress: Progress = silent,
) -> Mesh:
    """Triangulate the fused points of a surface, without triangles across steps.

    Parameters
    ----------
    surface
        With normals (`core.scan.surface.normals.with_normals`) steps between parallel faces are cut too.
    max_edge_px
        Longest edge in the picture; None: three times the longest edge of nine triangles in ten.
    progress
        Called with how far it is.

    Returns
    -------
    Mesh
        Only vertices that a triangle uses; normals are the surface's own where known, else their triangles'. The same
        surface always gives the same mesh.

    Raises
    ------
    InputError
        If no triangle is left.
    """
    progress("mesh", 0, 3)
    triangles = delaunay(surface.uv)
    progress("mesh", 1, 3)
    if len(triangles):
        triangles = _continuous(surface, triangles, max_edge_px)
    if not len(triangles):
        raise InputError(
            Message(
                "surface.no_triangle",
                "the {n} fused points leave no triangle between them, so there is no mesh",
                n=len(surface),
            ),
            todo=Message("surface.advice_more_sweeps", "scan with more sweeps or allow longer edges"),
        )
    progress("mesh", 2, 3)
    mesh = _compact(surface, _canonical(triangles))
    progress("mesh", 3, 3)
    return mesh


def _continuous(surface: Surface, triangles: NDArray[np.int64], max_edge_px: float | None) -> NDArray[np.int64]:
    """The triangles that lie on one continuous surface, turned so that the camera sees their front."""
    limit = (
        LONGEST_EDGE * float(np.quantile(_longest(surface.uv, triangles), 0.9)) if max_edge_px is None else max_edge_px
    )
    known = (surface.normals != 0).any(axis=1)
    facing = np.where(known[:, None], surface.normals, [0.0, 0.0, -1.0])  # unknown: as if it faced the camera
    steep = pixel_angle(surface.points, surface.uv) * np.tan(STEEPEST_EDGE)
    turned = triangles.copy()
    vertices = _Vertices(surface.points, surface.uv, surface.sigma, facing)
    kept = _kept(vertices, turned, _Limits(limit, steep, float(np.sin(LARGEST_KINK))))
    return np.asarray(turned[kept], dtype=np.int64)


@compiled()
def _longest(uv: Array, triangles: NDArray[np.int64]) -> Array:
    """Length (T,) in pixels of the longest edge of each triangle."""
    longest = np.empty(len(triangles))
    for t in range(len(triangles)):
        squared = 0.0
        for k in range(3):
            a, b = triangles[t, k], triangles[t, (k + 1) % 3]
            squared = max(squared, (uv[b, 0] - uv[a, 0]) ** 2 + (uv[b, 1] - uv[a, 1]) ** 2)
        longest[t] = np.sqrt(squared)
    return longest


class _Vertices(NamedTuple):
    """Of V vertices: places (V, 3) and (V, 2) in the picture, σ (V,) and the unit normal (V, 3) each may have."""

    points: Array
    uv: Array
    sigma: Array
    facing: Array


class _Limits(NamedTuple):
    """An edge's length in pixels, its depth by length in pixels and depth, and the sine of its angle to the surface."""

    length_px: float
    steep: float
    kink: float


@compiled()
def _kept(vertices: _Vertices, triangles: NDArray[np.int64], limits: _Limits) -> NDArray[np.bool_]:
    """Which triangles stay; each is turned in place towards the camera, and those seen edge-on are left out."""
    points = vertices.points
    kept = np.zeros(len(triangles), dtype=np.bool_)
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
        away = (
            (uy * vz - uz * vy) * points[a, 0] + (uz * vx - ux * vz) * points[a, 1] + (ux * vy - uy * vx) * points[a, 2]
        )
        if away > 0:
            triangles[t, 1], triangles[t, 2] = c, b
        kept[t] = away != 0
        for k in range(3):
            one, other = (a, b) if k == 0 else ((b, c) if k == 1 else (c, a))
            kept[t] &= _joins(vertices, one, other, limits)
    return kept


@inlined()
def _joins(vertices: _Vertices, a: int, b: int, limits: _Limits) -> bool:
    """Whether the edge from a to b lies on one continuous surface; see the module's docstring."""
    points, uv, sigma, facing = vertices
    length_px = np.hypot(uv[b, 0] - uv[a, 0], uv[b, 1] - uv[a, 1])
    x, y, z = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    noise = JUMP_SIGMAS * np.hypot(sigma[a], sigma[b])
    steep = limits.steep * length_px * 0.5 * (points[a, 2] + points[b, 2])
    if length_px > limits.length_px or (abs(z) > noise and abs(z) > steep):
        return False
    off_a = abs(x * facing[a, 0] + y * facing[a, 1] + z * facing[a, 2])
    off_b = abs(x * facing[b, 0] + y * facing[b, 1] + z * facing[b, 2])
    off = min(off_a, off_b)
    return bool(off <= noise or off <= limits.kink * np.sqrt(x * x + y * y + z * z))


def _canonical(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Each triangle from its smallest vertex on, the triangles in ascending order."""
    first = triangles.argmin(axis=1)
    rolled = np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
    ordered: NDArray[np.int64] = rolled[np.lexsort(rolled.T[::-1])]
    return ordered


def _compact(surface: Surface, triangles: NDArray[np.int64]) -> Mesh:
    """The mesh of the vertices that `triangles` use."""
    is_used = np.zeros(len(surface), dtype=np.bool_)
    is_used[triangles] = True
    used, triangles = np.flatnonzero(is_used), (np.cumsum(is_used) - 1)[triangles]
    vertices = surface.points[used]
    known = np.linalg.norm(surface.normals[used], axis=1) > 0
    normals = np.where(known[:, None], surface.normals[used], vertex_normals(vertices, triangles))
    return Mesh(vertices, normals, surface.sigma[used], triangles)


def vertex_normals(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    """Compute vertex normals (V, 3): the unit sum of the area-weighted normals of each vertex's triangles."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    area = np.cross(b - a, c - a)
    summed = np.zeros_like(vertices)
    for axis in range(3):
        summed[:, axis] = np.bincount(triangles.ravel(), np.repeat(area[:, axis], 3), minlength=len(vertices))
    size = np.linalg.norm(summed, axis=1, keepdims=True)
    return np.asarray(summed / np.where(size > 0, size, 1.0), dtype=np.float64)
