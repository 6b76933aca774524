"""Centrelines as a lens without distortion would show them.

A light plane on a flat face is a straight line there, and a local fit may be as stiff as the surface allows. In the
distorted picture all lines of one region bend the same way, too little for a line's own noise to tell (0.01 px over a
window), and that error would be common to all crossings: half a standard deviation each, but no mean gets rid of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.image.stripes.centreline import Centreline
from core.model import Camera
from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable


def straightened(pieces: Sequence[Centreline], camera: Camera) -> tuple[Centreline, ...]:
    """Map centrelines to where the same camera without its distortion would see them, in px."""
    return tuple(_straightened(piece, camera) for piece in pieces)


def bent_back(crossings: CrossingTable, camera: Camera) -> CrossingTable:
    """Map crossings of centrelines freed of distortion back to the pixels of the picture as it was taken.

    Places along centrelines, and cells, stay those of the straightened ones.
    """
    xy = _plain(crossings.uv, camera)
    forward = _jacobian(np.column_stack([xy, np.ones(len(xy))]), camera)
    jacobian = np.asarray(np.linalg.inv(forward), dtype=np.float64)
    changed: dict[str, Array] = {"uv": camera.pixels(xy)}
    for end in "ab":
        tangent = getattr(crossings, f"tangent_{end}")
        changed[f"tangent_{end}"], stretch = _turned(tangent, jacobian)
        changed[f"sigma_{end}"] = getattr(crossings, f"sigma_{end}") * stretch
        changed[f"share_{end}"] = getattr(crossings, f"share_{end}") * stretch[:, None]
    return replace(crossings, **changed)  # type: ignore[arg-type]


def _straightened(piece: Centreline, camera: Camera) -> Centreline:
    rays = camera.rays(piece.uv)
    tangent, stretch = _turned(piece.tangent, _jacobian(rays, camera))
    return replace(
        piece,
        uv=camera.matrix[:2, 2] + rays[:, :2] @ camera.matrix[:2, :2].T,
        normal=np.column_stack([tangent[:, 1], -tangent[:, 0]]),
        sigma=piece.sigma * stretch,
    )


def _plain(uv: Array, camera: Camera) -> Array:
    """Undistorted ray coordinates (N, 2) of pixels without distortion."""
    return np.asarray((uv - camera.matrix[:2, 2]) @ np.linalg.inv(camera.matrix[:2, :2]).T)


def _jacobian(rays: Array, camera: Camera) -> Array:
    """∂(pixel without distortion)/∂(pixel), (N, 2, 2)."""
    return np.asarray(camera.matrix[:2, :2] @ camera.ray_jacobian(rays))


def _turned(tangent: Array, jacobian: Array) -> tuple[Array, Array]:
    """Unit tangents (N, 2) after the map, and by how much it stretches what lies across them, (N,)."""
    moved = np.einsum("nij,nj->ni", jacobian, tangent)
    length = np.linalg.norm(moved, axis=1)
    return moved / length[:, None], np.abs(np.linalg.det(jacobian)) / length
