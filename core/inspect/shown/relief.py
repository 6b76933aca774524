"""The measured surface as a picture in the camera's own pixels: bright is near, edges are shaded. For drawing on."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from core.inspect.shown.shown_scan import Relief
from core.model.arrays import Array

CELLS_ACROSS = 640
"""Cells of the relief along the picture's width, at most."""
WIDEST_GAP = 6.0
"""Cells without points are filled from the nearest ones up to so many times their median distance from any point."""
LAMP = np.array([-0.5, -0.6, -0.62]) / np.linalg.norm([0.5, 0.6, 0.62])
"""Direction to the lamp: the upper left, from the camera's side."""
GROUND = 18
"""Grey level where nothing was measured."""


def relief(image_size: tuple[int, int], uv: Array, depth: Array, normals: Array) -> Relief:
    """Draw a grey picture of the measured points in the camera's view: shaded, near is bright, gaps filled.

    Parameters
    ----------
    image_size
        (width, height) of the camera's picture in pixels.
    uv, depth, normals
        (N, 2) pixels, (N,) depths in mm and (N, 3) unit normals towards the camera (zero where unknown).
    """
    width, height = image_size
    cell = max(1.0, width / CELLS_ACROSS)
    rows, columns = int(np.ceil(height / cell)), int(np.ceil(width / cell))
    picture = np.full((rows, columns), GROUND, dtype=np.uint8)
    column, row = np.floor((np.asarray(uv) + 0.5) / cell).astype(np.int64).T
    seen = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    if not seen.any():
        return Relief(picture, cell)
    place = row[seen] * columns + column[seen]
    count = np.bincount(place, minlength=rows * columns)
    grey = np.bincount(place, _brightness(depth[seen], normals[seen]), minlength=rows * columns)
    there = count > 0
    values = np.zeros(rows * columns)
    values[there] = grey[there] / count[there]
    return Relief(_filled(values.reshape(rows, columns), there.reshape(rows, columns)), cell)


def _brightness(depth: Array, normals: Array) -> Array:
    """Grey levels of points: from far to near by depth, less where the surface turns from the lamp."""
    near, far = np.quantile(depth, [0.005, 0.995])
    height = np.clip((far - depth) / max(far - near, 1e-6), 0.0, 1.0)
    lit = np.where(np.any(normals != 0, axis=1), np.clip(normals @ LAMP, 0.0, 1.0), 0.6)
    bright: Array = (70.0 + 165.0 * height) * (0.45 + 0.55 * lit / float(-LAMP[2]))
    return np.clip(bright, GROUND + 20, 255.0)


def _filled(values: Array, there: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """The picture with the cells between stripes filled from the nearest cell with points."""
    away, nearest = cv2.distanceTransformWithLabels(
        (~there).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
    )
    of_label = np.zeros(int(nearest.max()) + 1)
    of_label[nearest[there]] = values[there]
    hull = cv2.convexHull(np.column_stack(np.nonzero(there)[::-1]).astype(np.int32))
    within = cv2.fillConvexPoly(np.zeros(there.shape, dtype=np.uint8), hull, 1) > 0
    reach = 1.5 + WIDEST_GAP * float(np.median(away[within]))
    grey = np.where(there | (within & (away <= reach)), of_label[nearest], GROUND)
    return np.asarray(np.clip(grey, 0, 255), dtype=np.uint8)
