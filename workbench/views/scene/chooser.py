"""Choosing points on the screen: the one that a click means, all inside a drawn outline. Numpy only."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.model.arrays import Array
from workbench.views.scene.camera import SceneCamera

REACH_PX = 14.0
"""A click takes a point no farther away: what a hand on a mouse misses a small point by."""

SAME_SPOT_PX = 3.0
"""Of points that are farther from the click than the nearest by no more than this, the one in front is taken."""

BATCH = 250_000
"""Points that are projected together: their arrays stay in the processor's cache."""


def nearest_point(points: Array, camera: SceneCamera, size: tuple[int, int], at: tuple[float, float]) -> int | None:
    """Find the index of the point (N, 3) seen nearest to the click `at` in px and not hidden by others; else None.

    None when there is none within reach.
    """
    numbers, spots, depths = [], [], []
    for start in range(0, len(points), BATCH):
        screen, depth = camera.project(points[start : start + BATCH], size)
        with np.errstate(invalid="ignore"):
            dx, dy = screen[:, 0] - at[0], screen[:, 1] - at[1]
            near = np.flatnonzero((dx * dx + dy * dy <= REACH_PX**2) & (depth > 0))
        numbers.append(near + start)
        spots.append(np.hypot(dx[near], dy[near]))
        depths.append(depth[near])
    if not any(map(len, numbers)):
        return None
    number, spot, deep = (np.concatenate(parts) for parts in (numbers, spots, depths))
    # What stands in front hides what is behind it: a face of a block hides the face below.
    around = spot <= spot.min() + SAME_SPOT_PX
    thickness = 4 * SAME_SPOT_PX / camera.pixels_per_mm(size)
    front = around & (deep <= deep[around].min() + thickness)
    return int(number[np.flatnonzero(front)[np.argmin(spot[front])]])


def points_inside(points: Array, camera: SceneCamera, size: tuple[int, int], outline: Outline) -> NDArray[np.bool_]:
    """Compute flags (N,) of the points (N, 3) that are seen inside an outline drawn on the screen."""
    inside = np.zeros(len(points), dtype=bool)
    for start in range(0, len(points), BATCH):
        screen, depth = camera.project(points[start : start + BATCH], size)
        inside[start : start + BATCH] = outline.contains(screen) & (depth > 0)
    return inside


class Outline:
    """Closed outline (K, 2) drawn on the screen; one that crosses itself counts by the even-odd rule."""

    def __init__(self, corners: ArrayLike) -> None:
        self._corners = np.asarray(corners, dtype=np.float64).reshape(-1, 2)
        self._low = np.floor(self._corners.min(axis=0)).astype(int) - 2
        width, height = np.ceil(self._corners.max(axis=0)).astype(int) - self._low + 3
        # Pixels far from the line are looked up in a mask; only spots on pixels that it touches are computed.
        self._mask = np.zeros((height, width), dtype=np.uint8)
        line = np.round((self._corners - self._low - 0.5) * 16).astype(np.int32)  # four bits of fraction
        cv2.fillPoly(self._mask, [line], 1, shift=4)
        cv2.polylines(self._mask, [line], isClosed=True, color=2, thickness=4, shift=4)

    def contains(self, spots: Array) -> NDArray[np.bool_]:
        """Compute flags (N,) of the screen places (N, 2) that lie inside the outline."""
        low, high = self._corners.min(axis=0), self._corners.max(axis=0)
        with np.errstate(invalid="ignore"):
            near = np.flatnonzero((spots >= low).all(axis=1) & (spots <= high).all(axis=1))
        column, row = (np.floor(spots[near]).astype(int) - self._low).T
        looked_up = self._mask[row, column]
        inside = np.zeros(len(spots), dtype=bool)
        inside[near] = looked_up == 1
        doubtful = near[looked_up == 2]
        inside[doubtful] = _even_odd(spots[doubtful].astype(np.float64), self._corners)
        return inside


def _even_odd(spots: Array, corners: Array) -> NDArray[np.bool_]:
    """Count the edges to the left of each spot."""
    inside = np.zeros(len(spots), dtype=bool)
    x, y = spots.T
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        crosses = (y0 > y) != (y1 > y)
        inside ^= crosses & (x > x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return inside
