"""Points of a scan fused in the grid of the picture.

The points of one cell are averaged with weights 1/σ², but

- only points of one surface: where depths fall into layers further apart than noise and the steepest slope explain
  (a depth edge, a wrong point), the layer with most points stays, the nearer one when two have as many;
- the points of one sweep in one cell share the error of its light plane and most of its centreline's noise: they count
  as one observation with their mean weight, so a cell's σ falls with the number of sweeps, not of points.
"""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.progress import Progress, silent
from core.scan.cells import Measured, cells_of, fuse_cells, sorted_by_cell
from core.scan.cloud import Cloud
from core.scan.normals import ENOUGH, STEEPEST, pixel_angle, with_normals
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
    shape = grid_shape(image_size, cell)
    progress("fusion", 0, 2)
    cell_of = cells_of(cloud.points, cloud.uv, cloud.sigma, shape, cell)
    usable = np.flatnonzero(cell_of >= 0)
    if not len(usable):
        raise InputError(
            "the cloud holds no point with a depth, so there is no surface to fuse",
            todo="check the stripes and crossings found in the frames of the scan",
        )
    sample = usable[:: max(1, len(usable) // ENOUGH)].copy()
    del usable  # a cloud may fill a good part of the memory: nothing is kept longer than it is of use
    uv = cloud.uv[sample]
    angle = pixel_angle(cloud.points[sample], uv) if np.ptp(uv, axis=0).any() else 0.0
    slope = STEEPEST * cell * angle / 2  # neighbours in depth lie about half a cell apart at most
    progress("fusion", 1, 2)
    order, starts = sorted_by_cell(cell_of, shape[0] * shape[1])
    cells = np.flatnonzero(np.diff(starts))
    measured = Measured(cloud.points, cloud.uv, cloud.intensity, cloud.sigma, cloud.sweep)
    means, total, count, member = fuse_cells(order, starts, cells, measured, GAP, slope)
    del cell_of, order
    progress("fusion", 2, 2)
    return Surface(
        image_size=image_size,
        cell_px=cell,
        cells=cells,
        points=means[:, :3],
        uv=means[:, 3:5],
        sigma=1 / np.sqrt(total),
        intensity=means[:, 5],
        count=count,
        normals=np.zeros((len(cells), 3)),
        member=member,
    )
