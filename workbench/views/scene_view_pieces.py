"""What is drawn in one go: chunks of the cloud, pieces of the mesh, each small enough for a fraction of a frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from workbench.views.scene_view_cloud import CHUNK
from workbench.views.scene_view_contents import Scene, SurfaceMesh

TRIANGLES = 25_000
"""Triangles in a piece of a mesh."""

COARSE_CELLS = 72
"""A coarse mesh has one vertex in each cell of a grid with so many cells along its longest side."""


class Key(NamedTuple):
    """Names a piece: of the cloud, of the mesh, or the coarse mesh that stands for it in motion."""

    kind: Literal["cloud", "mesh", "coarse"]
    number: int


Version = tuple[int, int, int]


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """Points (n, 3) in mm with colours (n, 3); for a mesh also unit normals (n, 3) and triangles (t, 3)."""

    points: NDArray[np.float32]
    colours: NDArray[np.uint8]
    normals: NDArray[np.float32] | None = None
    triangles: NDArray[np.int64] | None = None


def whole(scene: Scene) -> list[Key]:
    """All pieces that make the whole picture."""
    cloud, mesh = scene.visible_cloud, scene.visible_mesh
    keys = [Key("mesh", k) for k in range(-(-len(mesh.triangles) // TRIANGLES))] if mesh is not None else []
    return keys + [Key("cloud", k) for k in range(cloud.chunks if cloud is not None else 0)]


def fair_part(scene: Scene, elements: int) -> list[Key]:
    """Pieces that stand for the whole with about so many points and triangles, at least one of each."""
    keys = []
    if (mesh := scene.visible_mesh) is not None:
        if len(mesh.triangles) <= max(elements, TRIANGLES):
            keys = [key for key in whole(scene) if key.kind == "mesh"]
            elements -= len(mesh.triangles)
        else:
            keys = [Key("coarse", 0)]
            elements -= TRIANGLES
    if (cloud := scene.visible_cloud) is not None:
        keys += [Key("cloud", k) for k in cloud.spread(max(round(elements / CHUNK), 1))]
    return keys


def version(scene: Scene, key: Key) -> Version | None:
    """Changes when the piece has to be made again; None when there is no such piece any more."""
    if key.kind == "cloud":
        cloud = scene.visible_cloud
        if cloud is None or key.number >= cloud.chunks:
            return None
        return cloud.serial, cloud.generation, cloud.version(key.number)
    mesh = scene.visible_mesh
    return None if mesh is None or key.number * TRIANGLES >= len(mesh.triangles) else (mesh.serial, 0, 0)


def elements(scene: Scene, key: Key) -> int:
    """How many points or triangles a piece has, which is what it costs."""
    if key.kind == "cloud":
        assert scene.cloud is not None
        return scene.cloud.version(key.number)
    assert scene.mesh is not None
    return TRIANGLES if key.kind == "coarse" else min(len(scene.mesh.triangles) - key.number * TRIANGLES, TRIANGLES)


def make(scene: Scene, key: Key) -> Piece:
    """Gather a piece."""
    if key.kind == "cloud":
        assert scene.cloud is not None
        points, colours = scene.cloud.chunk(key.number)
        return Piece(points, colours)
    assert scene.mesh is not None
    if key.kind == "coarse":
        return _coarse(scene.mesh)
    return _part(scene.mesh, scene.mesh.triangles[key.number * TRIANGLES : (key.number + 1) * TRIANGLES])


def _part(mesh: SurfaceMesh, triangles: NDArray[np.int64]) -> Piece:
    """Some triangles of a mesh with their own vertices."""
    used, inverse = np.unique(triangles, return_inverse=True)
    local = inverse.reshape(-1, 3).astype(np.int64)
    points = mesh.vertices[used].astype(np.float32)
    return Piece(points, mesh.colours(used), _normals(points, local), local)


def _coarse(mesh: SurfaceMesh) -> Piece:
    """The mesh with the vertices of each grid cell drawn together (vertex clustering)."""
    low, high = mesh.corners
    cell = float((high - low).max()) / COARSE_CELLS or 1.0
    x, y, z = ((mesh.vertices - low) / cell).astype(np.int64).T
    _, first, inverse = np.unique((x * 1024 + y) * 1024 + z, return_index=True, return_inverse=True)
    a, b, c = inverse.reshape(-1)[mesh.triangles].T
    open_ones = (a != b) & (b != c) & (c != a)
    return _part(mesh, first[np.column_stack([a, b, c])[open_ones]])


def _normals(points: NDArray[np.float32], triangles: NDArray[np.int64]) -> NDArray[np.float32]:
    """Unit normals at the vertices, by the areas of the triangles round them."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    face = np.cross(b - a, c - a)
    corners = triangles.ravel(order="F")
    summed = np.column_stack(
        [np.bincount(corners, np.tile(face[:, axis], 3), minlength=len(points)) for axis in range(3)]
    )
    length = np.linalg.norm(summed, axis=1, keepdims=True)
    unit: NDArray[np.float32] = (summed / np.where(length > 0, length, 1)).astype(np.float32)
    return unit
