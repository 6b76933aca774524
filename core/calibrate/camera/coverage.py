"""Coverage of target views, in the picture and in tilts, and the disagreement of two cameras."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from core.calibrate.camera.bundle import NO_PARAMETERS, Bundle, Observed, refine, residuals
from core.messages import Message
from core.model import Camera, Pose
from core.model.arrays import Array

MAP_COLUMNS = 16
"""Cells across the picture in the map of what live views cover."""
_COLUMNS = 8
"""Cells across the picture in the share that is covered and its map: coarser, for a board has gaps between its
corners."""
_GRID, _DEPTHS = (16, 12), 3
"""Pixels across and down, and depths, at which two cameras are compared; a few hundred points of a smooth field."""
REGIONS = (
    Message("picture.upper_left", "upper left"),
    Message("picture.top", "top"),
    Message("picture.upper_right", "upper right"),
    Message("picture.left", "left"),
    Message("picture.middle", "middle"),
    Message("picture.right", "right"),
    Message("picture.lower_left", "lower left"),
    Message("picture.bottom", "bottom"),
    Message("picture.lower_right", "lower right"),
)
"""The ninths of a picture, row by row."""


def picture_cells(uv: Array, image_size: tuple[int, int], columns: int, rows: int) -> NDArray[np.bool_]:
    """Flag which of `rows` × `columns` equal cells of the picture hold a point of `uv` (N, 2): (rows, columns)."""
    width, height = image_size
    column = np.clip((uv[:, 0] + 0.5) * columns // width, 0, columns - 1).astype(np.intp)
    row = np.clip((uv[:, 1] + 0.5) * rows // height, 0, rows - 1).astype(np.intp)
    cells = np.zeros((rows, columns), dtype=np.bool_)
    cells[row, column] = True
    return cells


def covered_cells(uv: Array, image_size: tuple[int, int]) -> NDArray[np.bool_]:
    """Flag which of the picture's nearly square cells, 8 in a row, hold a point of `uv` (N, 2): (rows, 8)."""
    return picture_cells(uv, image_size, _COLUMNS, max(1, round(_COLUMNS * image_size[1] / image_size[0])))


def coverage(uv: Array, image_size: tuple[int, int]) -> float:
    """Compute the share (0 … 1) of the picture's cells, 8 in a row, that hold a point of `uv` (N, 2)."""
    return float(covered_cells(uv, image_size).mean())


def empty_regions(uv: Array, image_size: tuple[int, int], names: Sequence[Message] = REGIONS) -> tuple[Message, ...]:
    """Name the ninths of the picture without a point of `uv` (N, 2), as "upper left"; () if all have one."""
    cells = picture_cells(uv, image_size, 3, 3)
    return tuple(name for name, seen in zip(names, cells.ravel(), strict=True) if not seen)


def tilt(pose: Pose) -> float:
    """Compute the angle in rad, 0 to π/2, between the normal of the target at `pose` and the camera's optical axis."""
    normal = pose.rotation[:, 2]
    return float(np.arctan2(np.hypot(normal[0], normal[1]), abs(normal[2])))


def tilt_range(poses: Sequence[Pose]) -> float:
    """Compute the largest angle in rad between the target's planes at any two of these `poses`."""
    normals = [pose.rotation[:, 2] for pose in poses]
    angles = [np.arctan2(np.linalg.norm(np.cross(a, b)), abs(a @ b)) for a, b in combinations(normals, 2)]
    return float(max(angles, default=0.0))


def disagreement_mm(first: Camera, second: Camera, uv: Array, depths: tuple[float, float]) -> float:
    """Compute the RMS distance in mm between the points that two cameras see in the same pixels, over a work volume.

    The volume is what the pixels inside the hull of `uv` (N, 2) see between the two `depths` in mm. Each camera
    has a frame of its own, so the second is first moved to where the rays of both fit best; what is left is the
    distance across the ray. NaN where the cameras have no such rays.
    """
    low, high = uv.min(axis=0), uv.max(axis=0)
    grid = np.stack(np.meshgrid(*(np.linspace(low[i], high[i], _GRID[i]) for i in range(2))), axis=-1).reshape(-1, 2)
    grid = grid[Delaunay(uv).find_simplex(grid) >= 0]
    seen = np.isfinite(first.undistort(grid)).all(axis=1) & np.isfinite(second.undistort(grid)).all(axis=1)
    pixels = np.tile(grid[seen], (_DEPTHS, 1))
    depth = np.repeat(np.linspace(*depths, _DEPTHS), seen.sum())
    if len(pixels) < _DEPTHS * 4:
        return float("nan")
    view = Observed(first.rays(pixels) * depth[:, None], pixels, depth**2)
    pose = refine(Bundle(second, (Pose.identity(),)), [view], NO_PARAMETERS).poses[0]
    across = second.ray_jacobian(second.rays(pixels)) @ residuals(second, pose, view)[:, :, None]
    return float(np.sqrt(np.mean(np.sum((across[:, :, 0] * depth[:, None]) ** 2, axis=1))))
