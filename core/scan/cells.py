"""The points of a cloud sorted into cells, and each cell's points fused; see `core.scan.fusion`."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.model.arrays import Array

Index = NDArray[np.int64]


@njit(cache=True, nogil=True)
def sorted_by_cell(cell_of: Index, cells: int) -> tuple[Index, Index]:
    """Points (N,) ordered by their cell, and where in that order each of the `cells` begins and ends (cells + 1,)."""
    starts = np.zeros(cells + 1, dtype=np.int64)
    for cell in cell_of:
        starts[cell + 1] += 1
    for k in range(cells):
        starts[k + 1] += starts[k]
    order, filled = np.empty(len(cell_of), dtype=np.int64), starts[:-1].copy()
    for i in range(len(cell_of)):
        cell = cell_of[i]
        order[filled[cell]] = i
        filled[cell] += 1
    return order, starts


@njit(cache=True, nogil=True)
def fuse_cells(
    order: Index, starts: Index, cells: Index, values: Array, sigma: Array, sweep: Index, gap: float, slope: float
) -> tuple[Array, Array, Index, Index]:
    """Fuse the points of each of the occupied `cells` (M,).

    Parameters
    ----------
    order, starts
        From `sorted_by_cell`.
    values
        (N, K) of each point; the third is its depth.
    sigma, sweep
        (N,) standard uncertainty of the depth, and the number of its sweep, 0 or more.
    gap, slope
        Depths of one layer leave no gap larger than `gap` standard uncertainties plus `slope` times the depth.

    Returns
    -------
    Weighted means (M, K), sums of weights (M,), number of points (M,), and for each point the cell it is part of, as
    an index into `cells`, or −1.
    """
    means, total = np.zeros((len(cells), values.shape[1])), np.zeros(len(cells))
    count, member = np.zeros(len(cells), dtype=np.int64), np.full(len(sigma), -1, dtype=np.int64)
    of_sweep = np.zeros(int(sweep.max()) + 1, dtype=np.int64)
    for m in range(len(cells)):
        points = order[starts[cells[m]] : starts[cells[m] + 1]]
        _sort_by_depth(points, values)
        first, last = _largest_layer(points, values, sigma, gap, slope)
        layer = points[first:last]
        for i in layer:
            of_sweep[sweep[i]] += 1
        for i in layer:
            weight = 1 / (sigma[i] * sigma[i]) / of_sweep[sweep[i]]  # summed over a sweep: its mean weight
            total[m] += weight
            for k in range(values.shape[1]):
                means[m, k] += weight * values[i, k]
            member[i] = m
        for i in layer:
            of_sweep[sweep[i]] = 0
        count[m] = len(layer)
        for k in range(values.shape[1]):
            means[m, k] /= total[m]
    return means, total, count, member


@njit(cache=True, nogil=True)
def _sort_by_depth(points: Index, values: Array) -> None:
    """Sort the few points of a cell in place, those of one depth as they came."""
    if len(points) > 64:
        points[:] = points[np.argsort(values[points, 2], kind="mergesort")]
        return
    for k in range(1, len(points)):
        i, at = points[k], k
        while at > 0 and values[points[at - 1], 2] > values[i, 2]:
            points[at] = points[at - 1]
            at -= 1
        points[at] = i


@njit(cache=True, nogil=True)
def _largest_layer(points: Index, values: Array, sigma: Array, gap: float, slope: float) -> tuple[int, int]:
    """First and past-the-last of the points, sorted by depth, of the layer with most of them; of equals the nearest."""
    best_first, best_last, first = 0, 0, 0
    for k in range(1, len(points) + 1):
        if k < len(points):
            i, before = points[k], points[k - 1]
            gate = gap * np.hypot(sigma[i], sigma[before]) + slope * values[i, 2]
            if values[i, 2] - values[before, 2] <= gate:
                continue
        if k - first > best_last - best_first:
            best_first, best_last = first, k
        first = k
    return best_first, best_last
