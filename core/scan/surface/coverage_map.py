"""Coverage of the picture with measured points, cell by cell."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.float64] | NDArray[np.float32]

CELLS_ACROSS = 96
"""Cells along the picture's width: as fine as a hand can aim, coarse enough to fill between stripes."""


class CoverageMap:
    """Map of the picture, in cells that are about square, of where points were measured and where light was seen.

    `cells` (rows, columns) is True where points are; `lit` where any laser light has been seen, measured or not.
    """

    def __init__(self, image_size: tuple[int, int], columns: int = CELLS_ACROSS) -> None:
        width, height = image_size
        self._columns, self._rows = columns, max(1, round(columns * height / width))
        self._per_px = np.array([self._columns / width, self._rows / height])
        self.cells: NDArray[np.bool_] = np.zeros((self._rows, self._columns), dtype=np.bool_)
        self.lit: NDArray[np.bool_] = np.zeros_like(self.cells)

    def add(self, uv: Pixels) -> None:
        """Mark the cells of points measured at `uv` (N, 2) in px, as covered and as lit."""
        self._mark(self.cells, uv)
        self._mark(self.lit, uv)

    def add_lit(self, uv: Pixels) -> None:
        """Mark the cells of light seen at `uv` (N, 2) in px, whether it could be measured or not."""
        self._mark(self.lit, uv)

    @property
    def share(self) -> float:
        """Share (0 … 1) of the hull around all light seen that measured points cover; 0 before light is seen."""
        rows, columns = np.nonzero(self.lit)
        if not len(rows):
            return 0.0
        hull = np.zeros(self.lit.shape, dtype=np.uint8)
        corners = cv2.convexHull(np.column_stack([columns, rows]).astype(np.int32))
        cv2.fillConvexPoly(hull, corners, 1)
        return float(np.count_nonzero(self.cells & (hull > 0)) / np.count_nonzero(hull))

    def _mark(self, grid: NDArray[np.bool_], uv: Pixels) -> None:
        where = ((np.asarray(uv, dtype=np.float64) + 0.5) * self._per_px).astype(np.intp)
        grid[np.clip(where[:, 1], 0, self._rows - 1), np.clip(where[:, 0], 0, self._columns - 1)] = True
