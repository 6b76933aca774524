"""Room light that differs between a frame and the reference: found and taken off, frame by frame.

The hand-held laser's stripe is frame − reference, and what the room's light has changed since is in that difference,
too: lamps flicker, are switched on, hands cast shadows. Such changes are smooth but for the albedo of what is lit. With
d the difference and b the reference without the fan, both in one cell of a grid over the picture, where no stripe is::

    change(u, v) = b(u, v) · d_cell / b_cell

interpolated between the cells. d_cell is the median over the cell, and hardly more than that of the cells around
it: where a stripe fills a cell, those beside it are dark.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline

Picture = NDArray[np.uint8] | NDArray[np.uint16]
Difference = NDArray[np.int16] | NDArray[np.float32]

ROWS, COLUMNS = 96, 24
"""Cells of the grid: more rows than columns, since rows that are read out one after another see flicker as bands."""
LEAST_ROWS_PX, LEAST_COLUMNS_PX = 8, 16
"""Smaller cells would lie within a stripe."""
SAMPLES = 12
"""Rows and columns of a cell that are looked at, at most: the level is then known to a fifth of a pixel's noise."""
LEAST_CHANGE = 0.008
"""Of the full scale (2 of 255 grey levels): a smaller change matters to no stripe that can be measured."""
SHARE_OF_PICTURE = 0.1
"""A change is looked at if it is larger than LEAST_CHANGE in so much of the picture."""
FAN_REACH = 4.0
"""Widths to either side of a fan's centreline that its light covers."""
BACKGROUND_CELLS = 3
"""Cells around one, to each side, from which the background under the fan is taken."""


@dataclass(frozen=True, eq=False, slots=True)
class RoomLight:
    """Light of the room in the reference picture, by which its changes in frames are measured.

    Parameters
    ----------
    bare
        (H, W) the reference with the background in place of the fan's light.
    cells
        (rows, columns) its level in each cell of the grid.
    full_scale
        Largest possible grey level.
    """

    bare: NDArray[np.float32]
    cells: NDArray[np.float32]
    full_scale: float

    @classmethod
    def of(cls, base: Picture, fan: Sequence[Centreline], full_scale: float) -> RoomLight:
        """Separate the room's light in the picture `base` (H, W) from the light of the `fan`, given its centrelines."""
        bare = base.astype(np.float32)
        rows, columns = _grid(bare.shape)
        level = _levels(bare, rows, columns)
        for _ in range(BACKGROUND_CELLS):
            level = np.minimum(level, cv2.medianBlur(level, 3))
        lit = np.zeros(bare.shape, np.uint8)
        for piece in fan:
            for (u, v), width in zip(piece.uv, piece.width, strict=True):
                cv2.circle(lit, (round(u), round(v)), int(np.ceil(FAN_REACH * width)), 1, -1)
        background = _spread(level, bare.shape)
        bare[lit > 0] = background[lit > 0]
        return cls(bare, np.maximum(_levels(bare, rows, columns), 1.0), full_scale)

    def change(self, difference: Difference) -> tuple[NDArray[np.float32], float] | None:
        """Estimate the light (H, W) in grey levels that the room has added since the reference, and its typical size.

        `difference` (H, W) is a frame minus the reference. The size is the median where it is more than half of what a
        tenth of the picture has at least. None if it is too little to matter.
        """
        rows, columns = self.cells.shape
        levels = _levels(difference, rows, columns)
        levels = np.minimum(levels, cv2.medianBlur(levels, 5) + np.float32(LEAST_CHANGE * self.full_scale))
        low, high = np.quantile(levels, [SHARE_OF_PICTURE, 1 - SHARE_OF_PICTURE])
        most = float(max(low, high, key=abs))
        if abs(most) < LEAST_CHANGE * self.full_scale:
            return None
        typical = float(np.median(levels[levels * np.sign(most) > abs(most) / 2]))
        return _spread(levels / self.cells, difference.shape) * self.bare, typical


def _grid(shape: tuple[int, ...]) -> tuple[int, int]:
    return max(1, min(ROWS, shape[0] // LEAST_ROWS_PX)), max(1, min(COLUMNS, shape[1] // LEAST_COLUMNS_PX))


def _levels(picture: NDArray[np.generic], rows: int, columns: int) -> NDArray[np.float32]:
    """Median of the grey levels in each cell (rows, columns) of a picture (H, W)."""
    v, u = _places(picture.shape[0], rows), _places(picture.shape[1], columns)
    seen = picture[np.ix_(v.ravel(), u.ravel())].reshape(*v.shape, *u.shape).transpose(0, 2, 1, 3)
    flat = np.ascontiguousarray(seen).reshape(rows, columns, -1)
    rank = flat.shape[-1] // 2
    return np.asarray(np.partition(flat, rank, axis=-1)[..., rank], dtype=np.float32)


def _places(length: int, cells: int) -> NDArray[np.intp]:
    """(cells, samples) the pixels that are looked at along one side."""
    edges = np.linspace(0, length, cells + 1)
    samples = min(SAMPLES, int(np.diff(edges).min()))
    within = (np.arange(samples) + 0.5) / samples
    return np.asarray((edges[:-1, None] + within * np.diff(edges)[:, None]).astype(np.intp))


def _spread(levels: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float32]:
    """The levels of cells interpolated over the picture (H, W)."""
    wide = cv2.resize(levels, (shape[1], shape[0]), interpolation=cv2.INTER_LINEAR)
    return np.asarray(wide, dtype=np.float32)
