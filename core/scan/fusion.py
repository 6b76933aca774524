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
from core.scan.cells import fuse_cells, sorted_by_cell
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
    progress("fusion", 1, 2)
    surface = _average(cloud, index, cell_of, image_size, cell)
    progress("fusion", 2, 2)
    return surface


def _cell_index(uv: Array, image_size: tuple[int, int], cell_px: float) -> NDArray[np.int64]:
    """Flat index of the cell of each pixel position; positions on the rim belong to the outermost cells."""
    rows, columns = grid_shape(image_size, cell_px)
    column, row = (np.floor((uv[:, axis] + 0.5) / cell_px).astype(np.int64) for axis in range(2))
    flat: NDArray[np.int64] = np.clip(row, 0, rows - 1) * columns + np.clip(column, 0, columns - 1)
    return flat


def _average(
    cloud: Cloud, index: NDArray[np.int64], cell_of: NDArray[np.int64], image_size: tuple[int, int], cell_px: float
) -> Surface:
    """Weighted means per cell of the points `index` of the layer that stays there, each sweep one observation."""
    usable = index if len(index) < len(cloud) else slice(None)
    points, uv, sigma = cloud.points[usable], cloud.uv[usable], cloud.sigma[usable]
    angle = pixel_angle(points, uv) if np.ptp(uv, axis=0).any() else 0.0
    slope = STEEPEST * cell_px * angle / 2  # neighbours in depth lie about half a cell apart at most
    sweep = cloud.sweep[usable]
    sweep = sweep - sweep.min()
    order, starts = sorted_by_cell(cell_of, int(np.prod(grid_shape(image_size, cell_px))))
    cells = np.flatnonzero(np.diff(starts))
    values = np.column_stack([points, uv, cloud.intensity[usable]])
    means, total, count, fused = fuse_cells(order, starts, cells, values, sigma, sweep, GAP, slope)
    member = np.full(len(cloud), -1, dtype=np.int64)
    member[index] = fused
    return Surface(
        image_size=image_size,
        cell_px=cell_px,
        cells=cells,
        points=means[:, :3],
        uv=means[:, 3:5],
        sigma=1 / np.sqrt(total),
        intensity=means[:, 5],
        count=count,
        normals=np.zeros((len(cells), 3)),
        member=member,
    )
