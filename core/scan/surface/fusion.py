"""Fusion of a scan's points in the grid of the picture.

The points of one cell are averaged with weights 1/σ², but

- only points of one surface: where depths fall into layers further apart than noise and the steepest slope explain
  (a depth edge, a wrong point), the layer with most points stays, the nearer one when two have as many;
- the points of one sweep in one cell share the error of its light plane and most of its centreline's noise: they count
  as one observation with their mean weight, so a cell's σ falls with the number of sweeps, not of points.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.errors import InputError
from core.messages import Message
from core.model.arrays import Array
from core.model.small_arrays import indices_of, new_indices, row_of, zero_table
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Surface, grid_shape
from core.scan.surface.normals import ANGLE_SAMPLE, STEEPEST, pixel_angle, with_normals

__all__ = ["CELLS_ACROSS", "fuse", "with_normals"]

CELLS_ACROSS = 960
"""Cells along the picture's width when no size is asked for: about the width of a stripe."""
LARGEST_GAP = 4.0
"""Standard uncertainties (and what slope allows) between neighbouring depths of one layer at most:
tests/scan/surface/test_fusion.py holds it."""


def fuse(
    cloud: Cloud, image_size: tuple[int, int], cell_px: float | None = None, progress: Progress = silent
) -> Surface:
    """Fuse the points of a cloud to one for each cell of a grid over the picture.

    Parameters
    ----------
    cloud
        Points of a scan.
    image_size
        (width, height) of the picture in pixels.
    cell_px
        Side of a cell in pixels; None: the picture's width / 960, at least 1.
    progress
        Called with how far it is.

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
            Message("surface.no_depth", "the cloud holds no point with a depth, so there is no surface to fuse"),
            todo=Message(
                "surface.advice_check_frames", "check the stripes and crossings found in the frames of the scan"
            ),
        )
    sample = usable[:: max(1, len(usable) // ANGLE_SAMPLE)].copy()
    del usable  # a cloud may fill a good part of the memory: nothing is kept longer than it is of use
    uv = cloud.uv[sample]
    angle = pixel_angle(cloud.points[sample], uv) if np.ptp(uv, axis=0).any() else 0.0
    slope = STEEPEST * cell * angle / 2  # neighbours in depth lie about half a cell apart at most
    progress("fusion", 1, 2)
    order, starts = sorted_by_cell(cell_of, shape[0] * shape[1])
    cells = np.flatnonzero(np.diff(starts))
    measured = Measured(cloud.points, cloud.uv, cloud.intensity, cloud.sigma, cloud.sweep)
    fused = fuse_cells(order, starts, cells, measured, LARGEST_GAP, slope)
    del cell_of, order
    progress("fusion", 2, 2)
    return Surface(
        image_size=image_size,
        cell_px=cell,
        cells=cells,
        points=fused.means[:, :3],
        uv=fused.means[:, 3:5],
        sigma=1 / np.sqrt(fused.weight),
        intensity=fused.means[:, 5],
        count=fused.number,
        normals=np.zeros((len(cells), 3)),
        member=fused.member,
    )


Index = NDArray[np.int64]
_MOST_INSERTED = 64
"""Points of a cell that are sorted by insertion; with more, merging is quicker."""


@compiled()
def cells_of(points: Array, uv: Array, sigma: Array, shape: tuple[int, int], cell_px: float) -> Index:
    """Find the cell (N,) of each point in a grid of `shape` (rows, columns); −1 for points that cannot be fused.

    Positions `uv` (N, 2) on the rim belong to the outermost cells. A point needs a depth and a σ above 0.
    """
    rows, columns = shape
    found = indices_of(len(points), -1)
    for i in range(len(points)):
        place = points[i, 0] + points[i, 1] + points[i, 2] + uv[i, 0] + uv[i, 1]
        if math.isfinite(place) and points[i, 2] > 0 and sigma[i] > 0:
            row, column = float(math.floor((uv[i, 1] + 0.5) / cell_px)), float(math.floor((uv[i, 0] + 0.5) / cell_px))
            found[i] = int(min(max(row, 0.0), rows - 1.0)) * columns + int(min(max(column, 0.0), columns - 1.0))
    return found


@compiled()
def sorted_by_cell(cell_of: Index, cells: int) -> tuple[Index, Index]:
    """Sort the indices of points by cell, without those of `cell_of` −1; also return where each cell begins."""
    starts, filled = indices_of(cells + 1, 0), new_indices(cells)
    for i in range(len(cell_of)):
        if cell_of[i] >= 0:
            starts[cell_of[i] + 1] += 1
    for k in range(cells):
        filled[k] = starts[k]
        starts[k + 1] += starts[k]
    order = new_indices(starts[cells])
    for i in range(len(cell_of)):
        cell = cell_of[i]
        if cell >= 0:
            order[filled[cell]] = i
            filled[cell] += 1
    return order, starts


class Measured(NamedTuple):
    """Points, pixels, intensities, σ and sweeps of a cloud of N points, as arrays for fusing them."""

    points: Array
    uv: Array
    intensity: Array
    sigma: Array
    sweep: Index


class FusedCells(NamedTuple):
    """Fused points of the M occupied cells of the grid: weighted means, and which points they are made of.

    `means` (M, 6) weighted means of x, y, z, u, v and intensity; `weight` (M,) their sums of weights in 1/mm²; `number`
    (M,) of points; `member` (N,) for each of all N points the cell it is part of, as an index into the M, or −1.
    """

    means: Array
    weight: Array
    number: Index
    member: Index


@compiled()
def fuse_cells(order: Index, starts: Index, cells: Index, measured: Measured, gap: float, slope: float) -> FusedCells:
    """Fuse the points in each of the occupied `cells` (M,) to one weighted mean, of those in one layer of depth.

    Parameters
    ----------
    order, starts
        From `sorted_by_cell`.
    measured
        The N points.
    gap, slope
        Depths of one layer leave no gap larger than `gap` standard uncertainties plus `slope` times the depth.
    """
    points, uv, intensity, sigma, sweep = measured
    means, total = zero_table(len(cells), 6), row_of(len(cells), 0.0)
    count, member = new_indices(len(cells)), indices_of(len(sigma), -1)
    first_sweep, last_sweep = sweep[0], sweep[0]
    for i in range(len(sweep)):
        first_sweep, last_sweep = min(first_sweep, sweep[i]), max(last_sweep, sweep[i])
    of_sweep = indices_of(last_sweep - first_sweep + 1, 0)
    for m in range(len(cells)):
        inside = order[starts[cells[m]] : starts[cells[m] + 1]]
        _sort_by_depth(inside, points)
        first, last = _largest_layer(inside, points, sigma, gap, slope)
        layer = inside[first:last]
        for k in range(len(layer)):
            of_sweep[sweep[layer[k]] - first_sweep] += 1
        for n in range(len(layer)):
            i = layer[n]
            # summed over a sweep: its mean weight
            weight = 1 / (sigma[i] * sigma[i]) / of_sweep[sweep[i] - first_sweep]
            total[m] += weight
            for k in range(3):
                means[m, k] += weight * points[i, k]
            means[m, 3] += weight * uv[i, 0]
            means[m, 4] += weight * uv[i, 1]
            means[m, 5] += weight * intensity[i]
            member[i] = m
        for k in range(len(layer)):
            of_sweep[sweep[layer[k]] - first_sweep] = 0
        count[m] = len(layer)
        for k in range(6):
            means[m, k] /= total[m]
    return FusedCells(means, total, count, member)


@inlined()
def _sort_by_depth(inside: Index, points: Array) -> None:
    """Sort the few points of a cell in place, those of one depth as they came."""
    if len(inside) > _MOST_INSERTED:
        _merge_by_depth(inside, points)
        return
    for k in range(1, len(inside)):
        i, at = inside[k], k
        while at > 0 and points[inside[at - 1], 2] > points[i, 2]:
            inside[at] = inside[at - 1]
            at -= 1
        inside[at] = i


@inlined()
def _merge_by_depth(inside: Index, points: Array) -> None:
    """The same for many points: sorted runs are merged two by two."""
    count, length = len(inside), 1
    other = new_indices(count)
    while length < count:
        for start in range(0, count, 2 * length):
            middle, end = min(start + length, count), min(start + 2 * length, count)
            left, right = start, middle
            for k in range(start, end):
                if right == end or (left < middle and points[inside[left], 2] <= points[inside[right], 2]):
                    other[k] = inside[left]
                    left += 1
                else:
                    other[k] = inside[right]
                    right += 1
        for k in range(count):
            inside[k] = other[k]
        length *= 2


@inlined()
def _largest_layer(inside: Index, points: Array, sigma: Array, gap: float, slope: float) -> tuple[int, int]:
    """First and past-the-last of the points, sorted by depth, of the layer with most of them; of equals the nearest."""
    best_first, best_last, first = 0, 0, 0
    for k in range(1, len(inside) + 1):
        if k < len(inside):
            i, before = inside[k], inside[k - 1]
            gate = gap * math.hypot(sigma[i], sigma[before]) + slope * points[i, 2]
            if points[i, 2] - points[before, 2] <= gate:
                continue
        if k - first > best_last - best_first:
            best_first, best_last = first, k
        first = k
    return best_first, best_last
