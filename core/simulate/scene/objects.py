"""Objects to measure, in table coordinates: origin where they stand, z up, millimetres."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from core.errors import InputError, words_of
from core.files.stl import read_corners
from core.messages import Message
from core.model.arrays import Array
from core.simulate.scene.scene import OBJECT_ALBEDO, Mesh

# corners of each face of a box, anticlockwise seen from outside
_QUADS = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))

# The mask, shaped by eye so that it has smooth relief and undercuts; lengths in mm.
HALF_WIDTH_MM, HALF_LENGTH_MM, HEIGHT_MM = 46.0, 62.0, 36.0
"""Half axes of the bare ellipsoid, before the whole is brought to its height."""

_BUMPS = (  # Gaussians on the ellipsoid
    # height, x, y, half-width in x, half-width in y; mirrored where x is not 0
    (11.0, 0.0, -4.0, 6.5, 13.0),  # bridge and tip of the nose
    (6.0, 0.0, -11.0, 7.0, 6.0),
    (3.0, 7.5, -12.5, 4.0, 4.0),  # wings of the nose
    (-7.0, 17.0, 14.0, 9.5, 7.0),  # sockets of the eyes, and the eyes in them
    (4.5, 17.0, 13.5, 6.0, 4.5),
    (2.5, 15.0, 24.0, 12.0, 4.5),  # brows
    (3.0, 22.0, -10.0, 10.0, 11.0),  # cheeks
    (4.0, 0.0, -26.5, 11.0, 3.2),  # lips
    (4.0, 0.0, -33.5, 9.5, 3.2),
    (-2.5, 0.0, -30.0, 10.0, 1.6),
    (5.0, 0.0, -47.0, 11.0, 7.0),  # chin
)

_EAR_ROOT_MM = (43.0, 4.0, 15.0)  # x, y, z
_EAR_SIZE_MM = (13.0, 21.0)  # outwards, and along the head
_EAR_ROLL_MM = 3.2  # radius of the rolled rim
_EAR_LEAN = np.radians(35.0)  # rad


def box(low: ArrayLike, high: ArrayLike, albedo: float = OBJECT_ALBEDO) -> Mesh:
    """Make the mesh of a box between opposite corners `low` and `high` (3,) in mm: 12 triangles facing outwards."""
    (x0, y0, z0), (x1, y1, z1) = np.asarray(low, float), np.asarray(high, float)
    corners = np.array([(x, y, z) for z in (z0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))])
    triangles = [corners[[q[0], q[i], q[i + 1]]] for q in _QUADS for i in (1, 2)]
    return Mesh(np.array(triangles), albedo)


def turned(mesh: Mesh, angle: float, shift: ArrayLike = (0.0, 0.0)) -> Mesh:
    """Turn a mesh by `angle` in rad about the table's normal, z, and then shift it along the table by `shift` in mm."""
    cosine, sine = np.cos(angle), np.sin(angle)
    rotation = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    normals = None if mesh.normals is None else mesh.normals @ rotation.T
    return Mesh(mesh.triangles @ rotation.T + np.append(shift, 0.0), mesh.albedo, normals)


def gauge_block(height_mm: float, size_mm: Sequence[float] = (70.0, 60.0)) -> Mesh:
    """Make the mesh of a block of `height_mm`, its base `size_mm` centred on the origin."""
    x, y = size_mm[0] / 2, size_mm[1] / 2
    return box((-x, -y, 0), (x, y, height_mm))


def step_block(heights_mm: Sequence[float] = (40, 50, 60, 70), size_mm: Sequence[float] = (100.0, 60.0)) -> Mesh:
    """Make the mesh of one staircase, its steps of `heights_mm` side by side along x and equally wide."""
    width = size_mm[0] / len(heights_mm)
    left, y = -size_mm[0] / 2, size_mm[1] / 2
    steps = [
        box((left + i * width, -y, 0), (left + (i + 1) * width, y, height)).triangles
        for i, height in enumerate(heights_mm)
    ]
    return Mesh(np.concatenate(steps))


def cylinder(diameter_mm: float, length_mm: float = 80.0, facets: int = 720) -> Mesh:
    """Make the mesh of a cylinder lying along x on the table, its normals those of the round surface.

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
    """Read the mesh of an STL file in mm and stand it on the table: lowest point at z = 0, centred over the origin.

    Raises
    ------
    InputError
        If the file cannot be read as a mesh of triangles.
    """
    try:
        triangles = read_corners(path)
    except (OSError, ValueError) as problem:
        raise InputError(
            Message("simulate.bad_stl", "it cannot be read as an STL mesh ({why})", why=words_of(problem)), where=path
        ) from problem
    if not len(triangles) or not np.isfinite(triangles).all():
        raise InputError(
            Message("simulate.empty_stl", "the STL file holds no usable triangle"),
            where=path,
            todo=Message("simulate.advice_export", "export the part again, in mm"),
        )
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    return Mesh(triangles - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])


def face_mask(height_mm: float = 50.0) -> Mesh:
    """Make the mesh of a face-like mask with undercut ears, 50,000 triangles, its nose `height_mm` above the table.

    Smooth relief, and rims that hide what is beneath them (undercuts). The face is half an ellipsoid with brows, eyes,
    nose, lips and chin on it; each ear is a shell that rises from the side of the head and rolls back over itself.
    Shaded smoothly.
    """
    parts = [_face(), _ear(1.0), _ear(-1.0)]
    rise = height_mm / max(part[..., 2].max() for part in parts)
    parts = [part * [1.0, 1.0, rise] for part in parts]
    triangles, normals = zip(*(_woven(part) for part in parts), strict=True)
    return Mesh(np.concatenate(triangles), OBJECT_ALBEDO, np.concatenate(normals))


def _face() -> Array:
    """Points (rows, columns, 3) of the face: rings round the middle, from the top down to the table."""
    down, around = np.meshgrid(np.linspace(1e-3, np.pi / 2, 110), np.linspace(0, 2 * np.pi, 181), indexing="ij")
    x = HALF_WIDTH_MM * np.sin(down) * np.cos(around)
    y = HALF_LENGTH_MM * np.sin(down) * np.sin(around)
    relief = np.zeros_like(x)
    for height, x0, y0, wide, long in _BUMPS:
        for side in (x0, -x0) if x0 else (0.0,):
            relief += height * np.exp(-(((x - side) / wide) ** 2) - ((y - y0) / long) ** 2)
    z = HEIGHT_MM * np.cos(down) + relief * np.sqrt(np.cos(down).clip(0))
    return np.stack([x, y, z.clip(0)], axis=-1)


def _ear(side: float) -> Array:
    """Points (rows, columns, 3) of one ear: sections of a bowl with a rolled rim, set round its root."""
    bowl = np.column_stack([np.linspace(0.25, 1.0, 18), 5.0 * np.linspace(0, 1, 18) ** 2])
    roll = np.radians(np.linspace(-80, 150, 22))
    reach = np.concatenate([bowl[:, 0], np.ones(22)])
    aside = np.concatenate([np.zeros(18), _EAR_ROLL_MM * np.cos(roll)])
    rise = np.concatenate([bowl[:, 1], 5.0 + _EAR_ROLL_MM * (1 + np.sin(roll))])
    turn = np.radians(np.linspace(-125, 125, 90))[:, None]
    outwards = (_EAR_SIZE_MM[0] * reach + aside) * np.cos(turn)
    along = (_EAR_SIZE_MM[1] * reach + aside) * np.sin(turn)
    x = _EAR_ROOT_MM[0] + outwards * np.cos(_EAR_LEAN) - rise * np.sin(_EAR_LEAN)
    z = _EAR_ROOT_MM[2] + outwards * np.sin(_EAR_LEAN) + rise * np.cos(_EAR_LEAN)
    return np.stack([side * x, _EAR_ROOT_MM[1] + along, z], axis=-1)


def _woven(grid: Array) -> tuple[Array, Array]:
    """Triangles (T, 3, 3) between the points of a grid (R, C, 3), and the unit normals at their corners."""
    across = np.cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1))
    normals = across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-12)
    corners = [(slice(None, -1), slice(None, -1)), (slice(1, None), slice(None, -1))]
    corners += [(slice(1, None), slice(1, None)), (slice(None, -1), slice(1, None))]

    def split(values: Array) -> Array:
        quads = np.stack([values[rows, columns] for rows, columns in corners], axis=2).reshape(-1, 4, 3)
        return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])

    return split(grid), split(normals)
