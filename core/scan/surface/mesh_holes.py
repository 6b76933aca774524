"""Holes of a mesh, filled on request and marked: a filled triangle is shown, and never measured on.

A hole is a ring of edges with one triangle each, inside the surface as the camera sees it; the outermost ring is the
edge of what was scanned. Its rim is cut into triangles ear by ear, flat, with no new vertices: no place is invented. A
rim that is no continuous surface, as round a shadow behind a step, is left open.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.surface.fused_surface import Mesh

# Rims that are filled: those of one continuous surface. tests/scan/surface/test_mesh_holes.py holds them.
LARGEST_UNEVENNESS = 0.25
"""Share of the hole's span by which a rim may leave its plane,"""
NOISE_SIGMAS = 5.0
"""or standard uncertainties of its vertices, whichever is more."""
LARGEST_TURN = np.radians(50.0)
"""rad that a rim's plane may be turned against the surface at nine tenths of the rim, as a kink in the mesh."""
MOST_EDGES = 2000
"""Edges of a rim: longer ones are not filled, for cutting ears takes time with the square of their number."""

Ring = NDArray[np.int64]


def fill_holes(mesh: Mesh, largest_mm: float, progress: Progress = silent) -> Mesh:
    """Fill the holes of a mesh up to a span of `largest_mm`, and mark the new triangles in its `filled`.

    Parameters
    ----------
    mesh
        As measured; what is filled already stays so.
    largest_mm
        Largest distance of two vertices on the rim of a hole that is filled.
    progress
        Called with how far it is.

    Returns
    -------
    Mesh
        Its vertices and measured triangles are those of `mesh`, in their order; new triangles follow.
    """
    rings = holes(mesh)
    flat = mesh.vertices[:, :2] / mesh.vertices[:, 2:]
    added: list[NDArray[np.int64]] = []
    for number, ring in enumerate(rings):
        progress("holes", number, len(rings))
        if _span(mesh.vertices[ring]) <= largest_mm and _continuous(mesh, ring):
            added += _ears(ring, flat)
    progress("holes", len(rings), len(rings))
    if not added:
        return mesh
    new = np.array(added, dtype=np.int64)
    filled = np.concatenate([mesh.filled, np.ones(len(new), dtype=np.bool_)])
    return replace(mesh, triangles=np.vstack([mesh.triangles, new]), filled=filled)


def holes(mesh: Mesh) -> list[Ring]:
    """Find the rings of vertices round the holes of a mesh, ordered so that a triangle in one faces like the others."""
    flat = mesh.vertices[:, :2] / mesh.vertices[:, 2:]
    outside = _signed_area(flat[mesh.triangles]).sum()  # triangles all run one way round in the picture
    rings = [ring for ring in _rings(mesh.triangles) if 3 <= len(ring) <= MOST_EDGES and len(set(ring)) == len(ring)]
    return [ring for ring in rings if _signed_area(flat[ring][None])[0] * outside > 0]


def border(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Find the edges (E, 2) that belong to only one triangle, in the direction in which it runs."""
    a, b = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = int(triangles.max(initial=0)) + 1
    one_sided = ~np.isin(a * count + b, b * count + a)
    return np.column_stack([a[one_sided], b[one_sided]])


def _rings(triangles: NDArray[np.int64]) -> list[Ring]:
    """Closed rings of border edges, run the way a new triangle would."""
    following: dict[int, list[int]] = {}
    for end, start in border(triangles).tolist():  # the other way round
        following.setdefault(start, []).append(end)
    rings = []
    while following:
        first = next(iter(following))
        ring, at = [first], _taken(following, first)
        while at is not None and at != first:
            ring.append(at)
            at = _taken(following, at)
        if at == first:
            rings.append(np.array(ring, dtype=np.int64))
    return rings


def _taken(following: dict[int, list[int]], start: int) -> int | None:
    """An edge's end, the edge struck off; None where none is left."""
    ends = following.get(start)
    if not ends:
        return None
    end = ends.pop()
    if not ends:
        del following[start]
    return end


def _signed_area(polygons: Array) -> Array:
    """Twice the area (K,) of polygons (K, n, 2), its sign by the way they run."""
    u, v = polygons[..., 0], polygons[..., 1]
    twice: Array = (u * np.roll(v, -1, axis=1) - v * np.roll(u, -1, axis=1)).sum(axis=1)
    return twice


def _span(rim: Array) -> float:
    """Largest distance of two places of a rim (n, 3)."""
    return float(max(np.linalg.norm(rim - place, axis=1).max() for place in rim))


def _continuous(mesh: Mesh, ring: Ring) -> bool:
    rim = mesh.vertices[ring]
    centred = rim - rim.mean(axis=0)
    normal = np.linalg.svd(centred, full_matrices=False)[2][2]
    if np.quantile(np.abs(mesh.normals[ring] @ normal), 0.1) < np.cos(LARGEST_TURN):
        return False
    off = np.abs(centred @ normal)
    return bool(off.max() <= max(LARGEST_UNEVENNESS * _span(rim), NOISE_SIGMAS * float(np.median(mesh.sigma[ring]))))


def _ears(ring: Ring, flat: Array) -> list[NDArray[np.int64]]:
    """Triangles of vertices that fill a ring, by cutting off ears; none if it crosses itself.

    Meisters, Polygons have ears, Amer. Math. Monthly 82 (1975), doi:10.2307/2319703.
    """
    left, found = ring.tolist(), []
    sign = np.sign(_signed_area(flat[ring][None])[0])
    while len(left) > 3:
        ear = next((number for number in range(len(left)) if _is_ear(left, number, flat, float(sign))), None)
        if ear is None:
            return []
        before, after = left[ear - 1], left[(ear + 1) % len(left)]
        found.append(np.array([before, left[ear], after], dtype=np.int64))
        del left[ear]
    return [*found, np.array(left, dtype=np.int64)]


def _is_ear(left: list[int], number: int, flat: Array, sign: float) -> bool:
    """Whether the corner bulges and no other vertex lies in the triangle it would cut off."""
    a, b, c = left[number - 1], left[number], left[(number + 1) % len(left)]
    corner = flat[[a, b, c]]
    if _signed_area(corner[None])[0] * sign <= 0:
        return False
    others = flat[[one for one in left if one not in (a, b, c)]]
    edge = np.roll(corner, -1, axis=0) - corner
    away = others[:, None] - corner[None]
    inside = (edge[None, :, 0] * away[..., 1] - edge[None, :, 1] * away[..., 0]) * sign > 0
    return not bool(inside.all(axis=1).any())
