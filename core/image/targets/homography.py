"""Plane to picture: the homography, as OpenCV estimates it."""

from __future__ import annotations

import cv2
import numpy as np

from core.model.arrays import Array


def homography_of(xy: Array, uv: Array, *, robust: bool = False) -> Array | None:
    """The homography (3, 3) that maps `xy` (N, 2) to `uv` (N, 2); None if they do not determine one."""
    matrix = cv2.findHomography(xy, uv, cv2.LMEDS if robust else 0)[0]
    return None if matrix is None else np.asarray(matrix, dtype=np.float64)


def map_by(homography: Array, xy: Array) -> Array:
    """Images (N, 2) of `xy` (N, 2)."""
    ends = np.column_stack([xy, np.ones(len(xy))]) @ homography.T
    mapped: Array = ends[:, :2] / ends[:, 2:]
    return mapped
