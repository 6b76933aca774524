"""The points of a cloud sorted into cells, and each cell's points fused; see `core.scan.fusion`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.model.arrays import Array

Index = NDArray[np.int64]


@njit(cache=True, nogil=True)
def cells_of(points: Array, uv: Array, sigma: Array, shape: tuple[int, int], cell_px: float) -> Index:
    """Number (N,) of the cell of each point in a grid of `shape` (rows, columns); −1 for what cannot be fused.

    Positions `uv` (N, 2) on the rim belong to the outermost cells. A point needs a depth and a σ above 0.
    """
    rows, columns = shape
    found = np.full(len(points), -1, dtype=np.int64)
    for i in range(len(points)):
        place = points[i, 0] + points[i, 1] + points[i, 2] + uv[i, 0] + uv[i, 1]
        if np.isfinite(place) and points[i, 2] > 0 and sigma[i] > 0:
            row, column = np.floor((uv[i, 1] + 0.5) / cell_px), np.floor((uv[i, 0] + 0.5) / cell_px)
            found[i] = int(min(max(row, 0.0), rows - 1.0)) * columns + int(min(max(column, 0.0), columns - 1.0))
    return found


@njit(cache=True, nogil=True)
def sorted_by_cell(cell_of: Index, cells: int) -> tuple[Index, Index]:
    """Points by their cell, those of −1 left out, and where in that order each of the `cells` begins and ends."""
    starts = np.zeros(cells + 1, dtype=np.int64)
    for cell in cell_of:
        if cell >= 0:
            starts[cell + 1] += 1
    for k in range(cells):
        starts[k + 1] += starts[k]
    order, filled = np.empty(starts[-1], dtype=np.int64), starts[:-1].copy()
    for i in range(len(cell_of)):
        cell = cell_of[i]
        if cell >= 0:
            order[filled[cell]] = i
            filled[cell] += 1
    return order, starts


class Measured(NamedTuple):
    """Of all N points, as in a cloud."""

    points: Array
    uv: Array
    intensity: Array
    sigma: Array
    sweep: Index


@njit(cache=True, nogil=True)
def fuse_cells(
    order: Index, starts: Index, cells: Index, measured: Measured, gap: float, slope: float
) -> tuple[Array, Array, Index, Index]:
    """Fuse the points of each of the occupied `cells` (M,).

    Parameters
    ----------
    order, starts
        From `sorted_by_cell`.
    measured
        The N points.
    gap, slope
        Depths of one layer leave no gap larger than `gap` standard uncertainties plus `slope` times the depth.

    Returns
    -------
    Weighted means of x, y, z, u, v and intensity (M, 6), sums of weights (M,), number of points (M,), and for each
    of the N points the cell it is part of, as an index into `cells`, or −1.
    """
    points, uv, intensity, sigma, sweep = measured
    means, total = np.zeros((len(cells), 6)), np.zeros(len(cells))
    count, member = np.zeros(len(cells), dtype=np.int64), np.full(len(sigma), -1, dtype=np.int64)
    first_sweep = sweep.min()
    of_sweep = np.zeros(int(sweep.max() - first_sweep) + 1, dtype=np.int64)
    for m in range(len(cells)):
        inside = order[starts[cells[m]] : starts[cells[m] + 1]]
        _sort_by_depth(inside, points)
        first, last = _largest_layer(inside, points, sigma, gap, slope)
        layer = inside[first:last]
        for i in layer:
            of_sweep[sweep[i] - first_sweep] += 1
        for i in layer:
            # summed over a sweep: its mean weight
            weight = 1 / (sigma[i] * sigma[i]) / of_sweep[sweep[i] - first_sweep]
            total[m] += weight
            for k in range(3):
                means[m, k] += weight * points[i, k]
            means[m, 3] += weight * uv[i, 0]
            means[m, 4] += weight * uv[i, 1]
            means[m, 5] += weight * intensity[i]
            member[i] = m
        for i in layer:
            of_sweep[sweep[i] - first_sweep] = 0
        count[m] = len(layer)
        means[m] /= total[m]
    return means, total, count, member


@njit(cache=True, nogil=True)
def _sort_by_depth(inside: Index, points: Array) -> None:
    """Sort the few points of a cell in place, those of one depth as they came."""
    if len(inside) > 64:
        inside[:] = inside[np.argsort(points[inside, 2], kind="mergesort")]
        return
    for k in range(1, len(inside)):
        i, at = inside[k], k
        while at > 0 and points[inside[at - 1], 2] > points[i, 2]:
            inside[at] = inside[at - 1]
            at -= 1
        inside[at] = i


@njit(cache=True, nogil=True)
def _largest_layer(inside: Index, points: Array, sigma: Array, gap: float, slope: float) -> tuple[int, int]:
    """First and past-the-last of the points, sorted by depth, of the layer with most of them; of equals the nearest."""
    best_first, best_last, first = 0, 0, 0
    for k in range(1, len(inside) + 1):
        if k < len(inside):
            i, before = inside[k], inside[k - 1]
            gate = gap * np.hypot(sigma[i], sigma[before]) + slope * points[i, 2]
            if points[i, 2] - points[before, 2] <= gate:
                continue
        if k - first > best_last - best_first:
            best_first, best_last = first, k
        first = k
    return best_first, best_last
