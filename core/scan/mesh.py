"""Triangles over a fused surface: Delaunay in the picture, cut where the surface is not continuous.

Between stripes the grid is empty, so neighbours are found by Delaunay's triangulation of the pixel positions. A
triangle is left out when one of its edges

- is long in the picture: nothing was seen between its ends;
- is a depth jump: its ends differ by more than their σ explain, and the edge is either too steep to have been seen at
  all (the angle at which the camera would look along it) or leaves the tangent planes of both its ends (a step between
  two parallel faces does; a kink leaves at most one of them by much).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError

from core.errors import InputError
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.normals import pixel_angle
from core.scan.surface import Mesh, Surface

JUMP_SIGMAS = 5.0
"""A depth difference below this many standard uncertainties is no jump."""


def build_mesh(
    surface: Surface,
    *,
    max_edge_px: float | None = None,
    steepest: float = np.radians(80.0),
    largest_kink: float = np.radians(50.0),
    progress: Progress = silent,
) -> Mesh:
    """Triangulate a fused surface.

    Parameters
    ----------
    surface
        With normals (`core.scan.normals.with_normals`) steps between parallel faces are cut too.
    max_edge_px
        Longest edge in the picture; None: three times the longest edge of nine triangles in ten.
    steepest
        Angle in rad between an edge and the picture's plane above which it is a depth jump.
    largest_kink
        Angle in rad above which an edge that leaves the tangent planes of both its ends is a depth jump.
    progress
        Told how far it is.

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
    triangles = _delaunay(surface.uv)
    progress("mesh", 1, 3)
    if len(triangles):
        triangles = triangles[_continuous(surface, triangles, max_edge_px, steepest, largest_kink)]
        triangles = _towards_camera(surface.points, triangles)
    if not len(triangles):
        raise InputError(
            f"the {len(surface)} fused points leave no triangle between them, so there is no mesh",
            todo="scan with more sweeps or allow longer edges",
        )
    progress("mesh", 2, 3)
    mesh = _compact(surface, _canonical(triangles))
    progress("mesh", 3, 3)
    return mesh


def _delaunay(uv: Array) -> NDArray[np.int64]:
    """Triangles (T, 3) over `uv` (M, 2); none when the points do not span a plane."""
    if len(uv) < 3:
        return np.empty((0, 3), dtype=np.int64)
    try:
        return np.asarray(Delaunay(uv - uv.mean(axis=0)).simplices, dtype=np.int64)
    except QhullError:  # all points on one line: what Qhull calls a flat initial simplex
        return np.empty((0, 3), dtype=np.int64)


def _continuous(
    surface: Surface, triangles: NDArray[np.int64], max_edge_px: float | None, steepest: float, largest_kink: float
) -> NDArray[np.bool_]:
    """Which triangles lie on one continuous surface."""
    a, b = triangles, np.roll(triangles, -1, axis=1)
    length_px = np.linalg.norm(surface.uv[b] - surface.uv[a], axis=2)
    longest = length_px.max(axis=1)
    limit = 3 * float(np.quantile(longest, 0.9)) if max_edge_px is None else max_edge_px
    edge = surface.points[b] - surface.points[a]
    length = np.linalg.norm(edge, axis=2)
    noise = JUMP_SIGMAS * np.hypot(surface.sigma[a], surface.sigma[b])
    across = length_px * pixel_angle(surface.points, surface.uv) * surface.points[a, 2]
    jump = np.abs(edge[:, :, 2])
    steep = (jump > noise) & (jump > across * np.tan(steepest))
    known = np.linalg.norm(surface.normals, axis=1) > 0
    facing = np.where(known[:, None], surface.normals, [0.0, 0.0, -1.0])  # unknown: as if it faced the camera
    off = np.minimum(*(np.abs((edge * facing[end]).sum(axis=2)) for end in (a, b)))
    step = (off > noise) & (off > length * np.sin(largest_kink))
    continuous: NDArray[np.bool_] = (longest <= limit) & ~(steep | step).any(axis=1)
    return continuous


def _towards_camera(points: Array, triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Triangles turned so that the camera sees their front; edge-on ones left out."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    facing = (np.cross(b, c) * a).sum(axis=1)  # n·a with n = (b − a) × (c − a): negative when seen from its front
    turned = triangles.copy()
    away = facing > 0
    turned[away, 1], turned[away, 2] = triangles[away, 2], triangles[away, 1]
    seen: NDArray[np.int64] = turned[facing != 0]
    return seen


def _canonical(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Each triangle from its smallest vertex on, the triangles in ascending order."""
    first = triangles.argmin(axis=1)
    rolled = np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
    ordered: NDArray[np.int64] = rolled[np.lexsort(rolled.T[::-1])]
    return ordered


def _compact(surface: Surface, triangles: NDArray[np.int64]) -> Mesh:
    """The mesh of the vertices that `triangles` use."""
    used, renumbered = np.unique(triangles, return_inverse=True)
    triangles = renumbered.reshape(-1, 3).astype(np.int64)
    vertices = surface.points[used]
    known = np.linalg.norm(surface.normals[used], axis=1) > 0
    normals = np.where(known[:, None], surface.normals[used], vertex_normals(vertices, triangles))
    return Mesh(vertices, normals, surface.sigma[used], triangles)


def vertex_normals(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    """Unit sum (V, 3) of the area-weighted normals of each vertex's triangles."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    area = np.cross(b - a, c - a)
    summed = np.zeros_like(vertices)
    for axis in range(3):
        summed[:, axis] = np.bincount(triangles.ravel(), np.repeat(area[:, axis], 3), minlength=len(vertices))
    size = np.linalg.norm(summed, axis=1, keepdims=True)
    return np.asarray(summed / np.where(size > 0, size, 1.0), dtype=np.float64)
