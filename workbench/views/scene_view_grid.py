"""The millimetre grid under the scene, and the camera's pyramid: lines that the view draws by itself."""

from __future__ import annotations

import numpy as np

from core.model.arrays import Array
from workbench.views.scene_view_camera import Orientation
from workbench.views.scene_view_colours import Rgb, nice_step
from workbench.views.scene_view_contents import Labels, Lines

GREY: Rgb = (128, 134, 142)
PYRAMID: Rgb = (74, 134, 220)


def ground_grid(points: Array, orientation: Orientation) -> tuple[Lines, float]:
    """Lines under `points` (N, 3) along east and north, and the distance between them in mm."""
    axes = np.array([orientation.east, orientation.north, orientation.up])
    local = points @ axes.T
    low, high = local.min(axis=0), local.max(axis=0)
    step = nice_step(max(float((high - low)[:2].max()), 1e-6) / 12)
    floor = low[2] - 0.02 * max(float((high - low).max()), step)
    first, last = np.floor(low[:2] / step), np.ceil(high[:2] / step)
    lines = []
    for axis in (0, 1):
        for k in np.arange(first[axis], last[axis] + 1):
            ends = np.empty((2, 3))
            ends[:, axis] = k * step
            ends[:, 1 - axis] = first[1 - axis] * step, last[1 - axis] * step
            ends[:, 2] = floor
            lines.append(ends @ axes)
    return Lines(tuple(lines), (GREY,) * len(lines), 1.0), step


def camera_pyramid(corners: Array, name: str) -> tuple[Lines, Labels]:
    """Edges of a pyramid from its centre and four corners (5, 3), and its name at the centre."""
    edges = [np.array([corners[0], corner]) for corner in corners[1:]]
    lines = Lines((*edges, corners[[1, 2, 3, 4, 1]]), (PYRAMID,) * 5, 1.6)
    return lines, Labels(corners[:1], (name,), None)
