"""Decimation of a mesh, with the error that it makes measured and stated.

Edges are collapsed in the order of their quadric error. That measure says nothing of millimetres, so afterwards every
vertex of the old mesh is held against the new one.

The quadrics of a flat surface say nothing against moving its border inwards, and the library has no weights for border
edges. So the mesh is given a low wall along every border, square to the surface: the wall's planes hold the border as
those of the surface hold the rest, and it is taken off again afterwards. The library collapses vertices of the wall's
outer rim among themselves only, so which triangles are the wall's is known.

References
----------
Garland, Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997, doi:10.1145/258734.258849.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.errors import InputError
from core.messages import Message
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.surface.fused_surface import Mesh
from core.scan.surface.mesh import vertex_normals
from core.scan.surface.mesh_holes import border
from core.scan.surface.triangles import AT_ONCE, ProximityQuery, Triangles

LEAST_TRIANGLES = 4
"""Triangles of the smallest body, a tetrahedron."""
ON_EDGE_MM = 1e-4
"""Distance in mm of a foot point that lies on a border edge: rounding of float32 coordinates at 500 mm."""

# The search for a number of triangles. Chosen by the time a try takes: tests/scan/surface/test_mesh_holes.py holds
# them.
TRIES = 6
"""Tries to meet a number of triangles."""
CLOSE_ENOUGH = 0.03
"""Share of the number asked for within which it is met."""
LARGEST_CORRECTION = 2.0
"""Factor by which a try changes the number at most."""
HALVINGS = 7
"""Of the (logarithmic) range of numbers searched when an error is given: a hundred-and-twenty-eighth of it is left."""


@dataclass(frozen=True, eq=False, slots=True)
class Decimated:
    """Decimated mesh, and the distances of the original's vertices from it.

    Parameters
    ----------
    mesh
        With the normals of its own triangles, and the σ of the nearest vertices before.
    largest_mm, most_mm
        The farthest vertex over the new mesh, and what 95 % of all do not exceed.
    edge_mm
        The farthest vertex beside the new mesh: how far its border has drawn back.
    """

    mesh: Mesh
    largest_mm: float
    most_mm: float
    edge_mm: float


def decimate(mesh: Mesh, triangles: int, progress: Progress = silent) -> Decimated:
    """Decimate a mesh to about `triangles` triangles; one that has no more than that stays as it is.

    Raises
    ------
    InputError
        If fewer than 4 triangles are asked for.
    """
    if triangles < LEAST_TRIANGLES:
        raise InputError(
            Message("surface.few_triangles", "{n} triangles are no surface", n=triangles),
            where="decimation",
            todo=Message("surface.advice_more_triangles", "ask for {least} or more", least=LEAST_TRIANGLES),
        )
    progress("decimation", 0, 2)
    fewer = mesh if triangles >= len(mesh.triangles) else _of_about(mesh, triangles)
    progress("decimation", 1, 2)
    result = _stated(mesh, fewer)
    progress("decimation", 2, 2)
    return result


def decimate_to(mesh: Mesh, largest_mm: float, progress: Progress = silent) -> Decimated:
    """Decimate a mesh as far as every vertex of the original lies within `largest_mm` of the result.

    Raises
    ------
    InputError
        If the error is not above 0.
    """
    if not largest_mm > 0:
        raise InputError(
            Message(
                "surface.no_error_allowed", "an error of {error_mm:g} mm leaves every triangle", error_mm=largest_mm
            ),
            where="decimation",
            todo=Message("surface.advice_allow_more", "allow more"),
        )
    best, walled = Decimated(mesh, 0.0, 0.0, 0.0), _walled(mesh)
    low, high = np.log(LEAST_TRIANGLES), np.log(max(len(walled.triangles), LEAST_TRIANGLES + 1))
    for round_ in range(HALVINGS):
        progress("decimation", round_, HALVINGS)
        middle = (low + high) / 2
        fewer = _collapsed(mesh, walled, int(np.exp(middle)))
        tried = _stated(mesh, fewer) if len(fewer.triangles) else None
        if tried and max(tried.largest_mm, tried.edge_mm) <= largest_mm:
            best, high = tried, middle
        else:
            low = middle
    progress("decimation", HALVINGS, HALVINGS)
    return best


@dataclass(frozen=True, eq=False, slots=True)
class _Walled:
    """A mesh with a wall along its border: `surface` (V,) is True for the vertices that its own triangles use."""

    vertices: Array
    triangles: NDArray[np.int64]
    surface: NDArray[np.bool_]


def _walled(mesh: Mesh) -> _Walled:
    edges, count = border(mesh.triangles), len(mesh.vertices)
    rim, number = np.unique(edges, return_inverse=True)
    a, b = edges.T
    below_a, below_b = (number.reshape(-1, 2) + count).T
    height = float(np.linalg.norm(mesh.vertices[b] - mesh.vertices[a], axis=1).mean()) if len(edges) else 0.0
    wall = np.vstack([np.column_stack([b, a, below_a]), np.column_stack([b, below_a, below_b])])
    surface = np.zeros(count + len(rim), dtype=np.bool_)
    surface[mesh.triangles] = True
    return _Walled(
        np.vstack([mesh.vertices, mesh.vertices[rim] - height * mesh.normals[rim]]),
        np.vstack([mesh.triangles, wall]),
        surface,
    )


def _of_about(mesh: Mesh, triangles: int) -> Mesh:
    """The mesh decimated to about so many triangles; how many more the wall takes is found by trying."""
    walled = _walled(mesh)
    best, total = mesh, triangles * len(walled.triangles) / len(mesh.triangles)
    for _ in range(TRIES):
        fewer = _collapsed(mesh, walled, round(total))
        found = len(fewer.triangles)
        if found and abs(found - triangles) < abs(len(best.triangles) - triangles):
            best = fewer
        if abs(found - triangles) <= CLOSE_ENOUGH * triangles:
            break
        total *= float(np.clip(triangles / max(found, 1), 1 / LARGEST_CORRECTION, LARGEST_CORRECTION))
    return best


def _collapsed(mesh: Mesh, walled: _Walled, total: int) -> Mesh:
    """The mesh after its edges were collapsed until with the wall `total` triangles were left; it may have none."""
    import fast_simplification  # type: ignore[import-untyped]  # only this function needs it

    middle = walled.vertices.mean(axis=0)
    points, faces = (walled.vertices - middle).astype(np.float32), walled.triangles.astype(np.int32)
    _, _, collapses = fast_simplification.simplify(points, faces, target_count=total, return_collapses=True)
    points, faces, number = fast_simplification.replay_simplification(points, faces, collapses)
    on_surface = np.zeros(len(points), dtype=np.bool_)
    on_surface[number[walled.surface]] = True
    corners = np.asarray(faces, dtype=np.int64)
    used, corners = np.unique(corners[on_surface[corners].all(axis=1)], return_inverse=True)
    vertices = np.asarray(points, dtype=np.float64)[used] + middle
    corners = corners.reshape(-1, 3)
    nearest = cKDTree(mesh.vertices).query(vertices)[1]
    filled = _filled(mesh, vertices, corners)
    return Mesh(vertices, vertex_normals(vertices, corners), mesh.sigma[nearest], corners, filled)


def _filled(mesh: Mesh, vertices: Array, corners: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which triangles lie over a filled hole: those whose middle is nearest to a filled triangle's."""
    if not mesh.filled.any():
        return np.zeros(len(corners), dtype=np.bool_)
    old = cKDTree(mesh.vertices[mesh.triangles].mean(axis=1))
    return np.asarray(mesh.filled[old.query(vertices[corners].mean(axis=1))[1]])


def _stated(mesh: Mesh, fewer: Mesh) -> Decimated:
    if fewer is mesh:
        return Decimated(mesh, 0.0, 0.0, 0.0)
    used = np.unique(mesh.triangles)
    near = ProximityQuery(Triangles(fewer.vertices[fewer.triangles])).nearest(mesh.vertices[used])
    away = np.abs(near.distance)
    worst = np.argsort(-away)[: max(1, len(away) // 20)]
    beside = np.zeros(len(away), dtype=np.bool_)
    ends = fewer.vertices[border(fewer.triangles)]
    for chunk in np.array_split(worst, 1 + len(worst) * len(ends) // AT_ONCE):
        beside[chunk] = _on_edges(near.foot[chunk], ends)
    largest, edge = (float(away[which].max(initial=0.0)) for which in (~beside, beside))
    return Decimated(fewer, largest, float(np.quantile(away, 0.95)), edge)


def _on_edges(places: Array, ends: Array) -> NDArray[np.bool_]:
    """Which of `places` (N, 3) lie on one of the edges `ends` (E, 2, 3)."""
    along = ends[:, 1] - ends[:, 0]
    from_start = places[:, None] - ends[None, :, 0]
    share = np.clip((from_start * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-30), 0.0, 1.0)
    off = np.linalg.norm(from_start - share[..., None] * along, axis=2)
    return np.asarray(off.min(axis=1, initial=np.inf) < ON_EDGE_MM)
