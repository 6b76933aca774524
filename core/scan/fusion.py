"""Points of a scan fused in the grid of the picture.

The points of one cell are averaged with weights 1/σ², but

- only points of one surface: where depths fall into layers further apart than noise and the steepest slope explain
  (a depth edge, a wrong point), the layer with most points stays, the nearer one when two have as many;
- the points of one sweep in one cell share the error of its light plane and most of its centreline's noise: they count
  as one observation with their mean weight, so a cell's σ falls with the number of sweeps, not of points.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.cloud import Cloud
from core.scan.normals import STEEPEST, pixel_angle, with_normals
from core.scan.surface import Surface, grid_shape

__all__ = ["CELLS_ACROSS", "fuse", "with_normals"]

CELLS_ACROSS = 960
"""Cells along the picture's width when no size is asked for: about the width of a stripe."""
GAP = 4.0
"""Depths of one layer leave no gap larger than this many standard uncertainties (and what slope allows)."""


def fuse(
    cloud: Cloud, image_size: tuple[int, int], cell_px: float | None = None, progress: Progress = silent
) -> Surface:
    """Fuse a cloud in the picture's grid.

    Parameters
    ----------
    cloud
        Points of a scan.
    image_size
        (width, height) of the picture in pixels.
    cell_px
        Side of a cell in pixels; None: the picture's width / 960, at least 1.
    progress
        Told how far it is.

    Returns
    -------
    Surface
        Without normals; see `with_normals`. Its σ holds what differs between sweeps; what is common to all of them
        (camera, fan) is not in it, nor are correlations between the sweeps.

    Raises
    ------
    InputError
        If the cloud holds no point with finite depth and positive σ.
    """
    cell = max(1.0, image_size[0] / CELLS_ACROSS) if cell_px is None else float(cell_px)
    usable = np.isfinite(cloud.points).all(axis=1) & (cloud.points[:, 2] > 0) & (cloud.sigma > 0)
    if not usable.any():
        raise InputError(
            "the cloud holds no point with a depth, so there is no surface to fuse",
            todo="check the stripes and crossings found in the frames of the scan",
        )
    progress("fusion", 0, 2)
    index = np.flatnonzero(usable)
    cell_of = _cell_index(cloud.uv[index], image_size, cell)
    kept = _kept_layer(cloud, index, cell_of, cell)
    index, cell_of = index[kept], cell_of[kept]
    progress("fusion", 1, 2)
    surface = _average(cloud, index, cell_of, image_size, cell)
    progress("fusion", 2, 2)
    return surface


def _cell_index(uv: Array, image_size: tuple[int, int], cell_px: float) -> NDArray[np.int64]:
    """Flat index of the cell of each pixel position; positions on the rim belong to the outermost cells."""
    rows, columns = grid_shape(image_size, cell_px)
    column, row = np.floor((uv + 0.5) / cell_px).astype(np.int64).T
    flat: NDArray[np.int64] = np.clip(row, 0, rows - 1) * columns + np.clip(column, 0, columns - 1)
    return flat


def _kept_layer(
    cloud: Cloud, index: NDArray[np.int64], cell_of: NDArray[np.int64], cell_px: float
) -> NDArray[np.bool_]:
    """Which of the points `index` belong to the layer that stays in their cell."""
    if len(index) == 1:
        return np.ones(1, dtype=np.bool_)
    depth, sigma = cloud.points[index, 2], cloud.sigma[index]
    order = np.lexsort((depth, cell_of))
    depth, sigma, cells = depth[order], sigma[order], cell_of[order]
    angle = pixel_angle(cloud.points[index], cloud.uv[index]) if np.ptp(cloud.uv[index], axis=0).any() else 0.0
    slope = STEEPEST * cell_px * angle * depth[1:] / 2  # neighbours in depth lie about half a cell apart at most
    gate = GAP * np.hypot(sigma[1:], sigma[:-1]) + slope
    starts = (np.diff(cells) != 0) | (np.diff(depth) > gate)
    layer = np.concatenate([[0], np.cumsum(starts)])
    size = np.bincount(layer)
    first = np.searchsorted(layer, np.arange(len(size)))  # a layer's nearest point
    ranked = np.lexsort((depth[first], -size, cells[first]))
    best = ranked[np.concatenate([[True], np.diff(cells[first][ranked]) != 0])]
    chosen = np.zeros(len(size), dtype=np.bool_)
    chosen[best] = True
    kept = np.empty(len(index), dtype=np.bool_)
    kept[order] = chosen[layer]
    return kept


def _average(
    cloud: Cloud, index: NDArray[np.int64], cell_of: NDArray[np.int64], image_size: tuple[int, int], cell_px: float
) -> Surface:
    """Weighted means per cell, each sweep one observation."""
    sweep = cloud.sweep[index] - cloud.sweep[index].min()
    _, group = np.unique(cell_of * (sweep.max() + 1) + sweep, return_inverse=True)
    in_group = np.bincount(group)
    weight = 1 / cloud.sigma[index] ** 2 / in_group[group]  # summed over a group: its mean weight
    cells, fused = np.unique(cell_of, return_inverse=True)
    total = np.bincount(fused, weight)

    def mean(values: Array) -> Array:
        summed: Array = np.bincount(fused, weight * values) / total
        return summed

    member = np.full(len(cloud), -1, dtype=np.int64)
    member[index] = fused
    return Surface(
        image_size=image_size,
        cell_px=cell_px,
        cells=cells,
        points=np.column_stack([mean(cloud.points[index, axis]) for axis in range(3)]),
        uv=np.column_stack([mean(cloud.uv[index, axis]) for axis in range(2)]),
        sigma=1 / np.sqrt(total),
        intensity=mean(cloud.intensity[index]),
        count=np.bincount(fused),
        normals=np.zeros((len(cells), 3)),
        member=member,
    )
