"""A face-like mask with folded ears: smooth relief, and rims that hide what is beneath them (undercuts).

In table coordinates, forehead towards +y. The face is half an ellipsoid with brows, eyes, nose, lips and chin on it;
each ear is a shell that rises from the side of the head and rolls back over itself at its rim.
"""

from __future__ import annotations

import numpy as np

from core.model.arrays import Array
from core.simulate.scene import OBJECT_ALBEDO, Mesh

HALF_WIDTH_MM = 46.0
HALF_LENGTH_MM = 62.0
HEIGHT_MM = 36.0
"""Of the bare ellipsoid, before the whole is brought to its height."""

_BUMPS = (
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

_EAR_ROOT_MM = (43.0, 4.0, 15.0)
_EAR_SIZE_MM = (13.0, 21.0)  # outwards, and along the head
_EAR_LEAN = np.radians(35.0)
_EAR_ROLL_MM = 3.2


def face_mask(height_mm: float = 50.0) -> Mesh:
    """The mask, its nose `height_mm` above the table, shaded smoothly; about 50,000 triangles."""
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
