"""Things to measure, in table coordinates: origin where they stand, z up, millimetres."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from core.errors import InputError
from core.model.arrays import Array
from core.simulate.scene import OBJECT_ALBEDO, Mesh

_QUADS = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def box(low: ArrayLike, high: ArrayLike, albedo: float = OBJECT_ALBEDO) -> Mesh:
    """A box between two opposite corners, 12 triangles facing outwards."""
    (x0, y0, z0), (x1, y1, z1) = np.asarray(low, float), np.asarray(high, float)
    corners = np.array([(x, y, z) for z in (z0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))])
    triangles = [corners[[q[0], q[i], q[i + 1]]] for q in _QUADS for i in (1, 2)]
    return Mesh(np.array(triangles), albedo)


def turned(mesh: Mesh, angle: float, shift: ArrayLike = (0.0, 0.0)) -> Mesh:
    """The mesh turned by `angle` (rad) about the table's normal, then shifted along the table."""
    cosine, sine = np.cos(angle), np.sin(angle)
    rotation = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    normals = None if mesh.normals is None else mesh.normals @ rotation.T
    return Mesh(mesh.triangles @ rotation.T + np.append(shift, 0.0), mesh.albedo, normals)


def gauge_block(height_mm: float, size_mm: Sequence[float] = (70.0, 60.0)) -> Mesh:
    """A gauge block of one height, its base centred on the origin."""
    x, y = size_mm[0] / 2, size_mm[1] / 2
    return box((-x, -y, 0), (x, y, height_mm))


def step_block(heights_mm: Sequence[float] = (40, 50, 60, 70), size_mm: Sequence[float] = (100.0, 60.0)) -> Mesh:
    """Steps side by side along x, each as wide as the next, highest last: one closed staircase."""
    width = size_mm[0] / len(heights_mm)
    left, y = -size_mm[0] / 2, size_mm[1] / 2
    steps = [
        box((left + i * width, -y, 0), (left + (i + 1) * width, y, height)).triangles
        for i, height in enumerate(heights_mm)
    ]
    return Mesh(np.concatenate(steps))


def cylinder(diameter_mm: float, length_mm: float = 80.0, facets: int = 720) -> Mesh:
    """A cylinder lying along x on the table, shaded as if it were round.

    Its facets leave the true surface by at most r π²/(4 n²) to either side: 0.12 µm for r = 25 mm.
    """
    step = 2 * np.pi / facets
    angle = np.arange(facets) * step
    outward = np.column_stack([np.zeros(facets), np.cos(angle), np.sin(angle)])
    radius = diameter_mm / 2
    rim = radius * (1 + step**2 / 16) * outward + [0.0, 0.0, radius]  # corners outside, middles inside by as much
    half = np.array([length_mm / 2, 0.0, 0.0])
    near, far = rim - half, rim + half
    on, following = np.arange(facets), np.roll(np.arange(facets), -1)
    middle = np.broadcast_to([0.0, 0.0, radius], (facets, 3))
    sides = [np.stack([near[on], near[following], far[following]], 1), np.stack([near[on], far[following], far[on]], 1)]
    ends = [
        np.stack([middle - half, near[following], near[on]], 1),
        np.stack([middle + half, far[on], far[following]], 1),
    ]
    round_ = [np.stack([outward[on], outward[following], outward[following]], 1)]
    round_ += [np.stack([outward[on], outward[following], outward[on]], 1)]
    flat = [np.broadcast_to([side, 0.0, 0.0], (facets, 3, 3)) for side in (-1.0, 1.0)]
    return Mesh(np.concatenate([*sides, *ends]), normals=np.concatenate([*round_, *flat]))


def stl(path: Path) -> Mesh:
    """The mesh of an STL file in mm, stood on the table: lowest point at z = 0, centred over the origin.

    Raises
    ------
    InputError
        If the file cannot be read as a mesh of triangles.
    """
    import trimesh  # slow to import, and only this function needs it

    try:
        loaded = trimesh.load_mesh(str(path), file_type="stl")
        triangles: Array = np.asarray(loaded.triangles, dtype=np.float64)
    except (OSError, ValueError, AttributeError, IndexError, KeyError) as problem:
        raise InputError(f"it cannot be read as an STL mesh ({problem})", where=path) from problem
    if not len(triangles) or not np.isfinite(triangles).all():
        raise InputError("the STL file holds no usable triangle", where=path, todo="export the part again, in mm")
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    return Mesh(triangles - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
