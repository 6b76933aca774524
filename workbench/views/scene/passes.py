"""What is drawn in one pass: chunks of the cloud and parts of the mesh that fit a fraction of a frame together.

A pass draws over what is there, so a picture of any size can be made without stopping the window.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from workbench.views.scene.cloud import CHUNK
from workbench.views.scene.contents import Scene, SurfaceMesh

TRIANGLES = 25_000
"""Triangles in a part of a mesh: software OpenGL draws so many within a frame."""

COARSE_CELLS = 72
"""A coarse mesh has one vertex in each cell of a grid with so many cells along its longest side: under 25,000
triangles."""

FRESH = 3
"""Parts that may be gathered and sent to the graphics card in one pass: some 3 ms each."""


class Part(NamedTuple):
    """Part of the scene: a chunk of the cloud, a part of the mesh, or the coarse mesh shown in motion."""

    kind: Literal["cloud", "mesh", "coarse"]
    number: int


class Version(NamedTuple):
    """Version of a part: it changes when the part has to be gathered again."""

    serial: int
    size: int


@dataclass(frozen=True, slots=True)
class Pass:
    """Parts that are drawn in one go.

    `first` starts a new picture, with lines; `last` finishes it with marks and all that is transparent; `smooth`
    smooths the edges of what is there, for solid things only: small points would fade.
    """

    parts: tuple[Part, ...]
    first: bool
    last: bool
    smooth: bool = False


Made = Callable[[Part], bool]
"""Whether a part is on the graphics card as it is in the scene."""


def all_parts(scene: Scene) -> list[Part]:
    """List all parts of the scene that are drawn one by one, the mesh's before the cloud's."""
    cloud, mesh = scene.visible_cloud, scene.visible_mesh
    parts = [Part("mesh", k) for k in range(-(-len(mesh.triangles) // TRIANGLES))] if mesh is not None else []
    return parts + [Part("cloud", k) for k in range(cloud.chunks if cloud is not None else 0)]


def size(scene: Scene, part: Part) -> int:
    """Count the points or triangles of a part of the scene, which is the cost of drawing it."""
    if part.kind == "cloud":
        assert scene.cloud is not None
        return scene.cloud.size(part.number)
    assert scene.mesh is not None
    return TRIANGLES if part.kind == "coarse" else min(len(scene.mesh.triangles) - part.number * TRIANGLES, TRIANGLES)


def version(scene: Scene, part: Part) -> Version | None:
    """Return the version of a part of the scene, which changes with its content; None if the part is gone."""
    if part.kind == "cloud":
        cloud = scene.visible_cloud
        return Version(cloud.serial, cloud.size(part.number)) if cloud and part.number < cloud.chunks else None
    mesh = scene.visible_mesh
    return Version(mesh.serial, 0) if mesh and part.number * TRIANGLES < len(mesh.triangles) else None


def quick_pass(scene: Scene, allowance: float, made: Made) -> Pass:
    """Choose parts with about `allowance` points and triangles that represent the whole scene in motion."""
    parts: list[Part] = []
    left = allowance
    if (mesh := scene.visible_mesh) is not None:
        if len(mesh.triangles) <= max(allowance, TRIANGLES):
            parts = [part for part in all_parts(scene) if part.kind == "mesh"]
        else:
            parts = [Part("coarse", 0)]
        left -= sum(size(scene, part) for part in parts)
    if (cloud := scene.visible_cloud) is not None:
        parts += [Part("cloud", k) for k in cloud.spread(max(round(left / CHUNK), 1))]
    fresh = [part for part in parts if not made(part)]
    return Pass(tuple(part for part in parts if part not in fresh[FRESH:]), first=True, last=True)


def whole_passes(scene: Scene, allowance: float, made: Made) -> list[Pass]:
    """Divide all parts of the scene into passes of about `allowance` points and triangles each."""
    batches: list[list[Part]] = [[]]  # the lines are drawn with the first, alone if there is no mesh
    edges = scene.has_edges
    cost = fresh = 0
    for part in all_parts(scene):
        new = not made(part)
        begins_cloud = edges and part.kind == "cloud" and (not batches[-1] or batches[-1][0].kind == "mesh")
        if begins_cloud or (batches[-1] and (cost >= allowance or fresh + new > FRESH)):
            batches.append([])
            cost = fresh = 0
        batches[-1].append(part)
        cost += size(scene, part)
        fresh += new
    solid = [all(part.kind == "mesh" for part in batch) for batch in batches]
    return [
        Pass(
            tuple(batch),
            first=k == 0,
            last=k == len(batches) - 1,
            smooth=edges and solid[k] and not any(solid[k + 1 :]),
        )
        for k, batch in enumerate(batches)
    ]


@dataclass(frozen=True, eq=False, slots=True)
class Gathered:
    """Arrays of a part: points (n, 3) in mm, colours (n, 3), unit normals (n, 3) if shaded, triangles (t, 3)."""

    points: NDArray[np.float32]
    colours: NDArray[np.uint8]
    normals: NDArray[np.float32] | None = None
    triangles: NDArray[np.int64] | None = None


def gather(scene: Scene, part: Part) -> Gathered:
    """Collect the arrays of one part of the scene: points, colours, normals and triangles."""
    if part.kind == "cloud":
        assert scene.cloud is not None
        return Gathered(*scene.cloud.chunk(part.number))
    assert scene.mesh is not None
    if part.kind == "coarse":
        return _coarse(scene.mesh)
    return _some(scene.mesh, scene.mesh.triangles[part.number * TRIANGLES : (part.number + 1) * TRIANGLES])


def _some(mesh: SurfaceMesh, triangles: NDArray[np.int64]) -> Gathered:
    """Some triangles of a mesh with their own vertices."""
    used, inverse = np.unique(triangles, return_inverse=True)
    local = inverse.reshape(-1, 3).astype(np.int64)
    points = mesh.vertices[used].astype(np.float32)
    return Gathered(points, mesh.colours(used), _normals(points, local), local)


def _coarse(mesh: SurfaceMesh) -> Gathered:
    """The mesh with the vertices of each grid cell drawn together (vertex clustering)."""
    low, high = mesh.corners
    cell = float((high - low).max()) / COARSE_CELLS or 1.0
    x, y, z = ((mesh.vertices - low) / cell).astype(np.int64).T
    _, first, inverse = np.unique((x * 1024 + y) * 1024 + z, return_index=True, return_inverse=True)
    a, b, c = inverse.reshape(-1)[mesh.triangles].T
    open_ones = (a != b) & (b != c) & (c != a)
    return _some(mesh, first[np.column_stack([a, b, c])[open_ones]])


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
