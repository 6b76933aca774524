"""A mesh of fewer triangles, with the error that this makes: stated, not promised.

Edges are collapsed in the order of their quadric error. That measure says nothing of millimetres, so afterwards every
vertex of the old mesh is held against the new one.

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
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.mesh import vertex_normals
from core.scan.mesh_holes import border
from core.scan.surface import Mesh
from core.scan.triangles import Surroundings, Triangles

FEWEST = 4
ON_EDGE_MM = 1e-4
ROUNDS = 7
"""Halvings of the number of triangles looked for when an error is given."""


@dataclass(frozen=True, eq=False, slots=True)
class Decimated:
    """A decimated mesh and how far the vertices of the whole one lie from it.

    Parameters
    ----------
    mesh
        With the normals of its own triangles, and the σ of the nearest vertices before.
    largest_mm, most_mm
        The farthest vertex over the new mesh, and what 95 % of all do not exceed.
    edge_mm
        The farthest vertex beside the new mesh: collapsing edges takes from the outer edge too.
    """

    mesh: Mesh
    largest_mm: float
    most_mm: float
    edge_mm: float


def decimate(mesh: Mesh, triangles: int, progress: Progress = silent) -> Decimated:
    """A mesh of about so many triangles (or as it is, if it has no more).

    Raises
    ------
    InputError
        If fewer than 4 triangles are asked for.
    """
    if triangles < FEWEST:
        raise InputError(f"{triangles} triangles are no surface", where="decimation", todo=f"ask for {FEWEST} or more")
    progress("decimation", 0, 2)
    fewer = mesh if triangles >= len(mesh.triangles) else _collapsed(mesh, triangles)
    progress("decimation", 1, 2)
    result = _stated(mesh, fewer)
    progress("decimation", 2, 2)
    return result


def decimate_to(mesh: Mesh, largest_mm: float, progress: Progress = silent) -> Decimated:
    """The mesh of fewest triangles found whose largest error over it stays below `largest_mm`.

    Raises
    ------
    InputError
        If the error is not above 0.
    """
    if not largest_mm > 0:
        raise InputError(f"an error of {largest_mm:g} mm leaves every triangle", where="decimation", todo="allow more")
    best = Decimated(mesh, 0.0, 0.0, 0.0)
    low, high = np.log(FEWEST), np.log(max(len(mesh.triangles), FEWEST + 1))
    for round_ in range(ROUNDS):
        progress("decimation", round_, ROUNDS)
        middle = (low + high) / 2
        tried = _stated(mesh, _collapsed(mesh, int(np.exp(middle))))
        if tried.largest_mm <= largest_mm:
            best, high = tried, middle
        else:
            low = middle
    progress("decimation", ROUNDS, ROUNDS)
    return best


def _collapsed(mesh: Mesh, triangles: int) -> Mesh:
    import fast_simplification  # type: ignore[import-untyped]  # only this function needs it

    points, faces = fast_simplification.simplify(
        mesh.vertices.astype(np.float32), mesh.triangles.astype(np.int32), target_count=triangles
    )
    corners = np.asarray(faces, dtype=np.int64)
    used, corners = np.unique(corners, return_inverse=True)
    vertices = np.asarray(points, dtype=np.float64)[used]
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
    near = Surroundings(Triangles(fewer.vertices[fewer.triangles])).nearest(mesh.vertices)
    away = np.abs(near.distance)
    order = np.argsort(-away)
    beside = np.zeros(len(away), dtype=np.bool_)
    ends = fewer.vertices[border(fewer.triangles)]
    for chunk in np.array_split(order[: max(1, len(order) // 20)], max(1, len(order) // 10_000)):
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
