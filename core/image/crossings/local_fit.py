"""Local fit of a centreline where another crosses it, in a window that ends at kinks and jumps."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import inlined
from core.image.crossings.kriging import INFORMATION, X, Y, influence, krige, straight_sigma
from core.image.crossings.line_bins import ARC, U, V, in_frame
from core.model.arrays import Array
from core.model.small_arrays import first_rows, new_indices

T_U, T_V, PLACE, SLOPE, BEND, SIGMA, REACH = 0, 1, 2, 3, 4, 5, 6
"""Of a fit: unit tangent of its frame; y, y' and y''/2 at the origin; σ of y; how far its window reaches. In pixels."""
FIT = 7
"""Number of these figures."""

_CHORD = 2
"""Bins on either side that say which way the frame lies."""
_STEEPEST = 0.6
"""Slope dy/dx, 31°: a line that leaves its frame more steeply is hardly a function of x; the window ends there."""


class LineAt(NamedTuple):
    """A centreline at one of its segments, ready for a local fit.

    Parameters
    ----------
    points
        (N, 3) u, v in px and 1/σ² in px⁻²; 0 where saturated.
    segment
        The first point of the segment.
    bins, broken
        (B, 5) and (B,) its bins, and which of them a kink or a jump is in: see `core.image.crossings.segments.Stack`.
    arc
        Length along the line up to the middle of the segment, in px.
    correlation_px
        Length over which the noise of its points counts as one.
    first_cell
        Number of the first cell that the fit can touch.
    """

    points: Array
    segment: int
    bins: Array
    broken: NDArray[np.bool_]
    arc: float
    correlation_px: float
    first_cell: int


@inlined()
def local_fit(line: LineAt, origin: tuple[float, float], reach: float, cell: float, fit: Array, share: Array) -> bool:
    """Fit a curve to a line within ± `reach` px of its segment, into `fit` (FIT,); False if that is not possible.

    The frame's origin is at `origin`, u and v. Into `share` (K,) goes what the errors of the cells of `cell` px do to
    the line's place, in pixels for one standard deviation of the mean of a cell's bins.
    """
    bins, broken, arc = line.bins, line.broken, line.arc
    count = len(bins)
    if count < 2:
        return False
    middle = 1
    while middle < count - 1 and bins[middle, ARC] < arc:
        middle += 1
    if broken[middle if bins[middle, ARC] - arc < arc - bins[middle - 1, ARC] else middle - 1]:
        return False
    low, high = _window(bins, broken, arc, middle, reach)
    start, end = max(low, middle - _CHORD), min(high, middle - 1 + _CHORD)
    tu, tv = bins[end, U] - bins[start, U], bins[end, V] - bins[start, V]
    chord = math.hypot(tu, tv)
    if high - low < 1 or chord == 0.0:
        return False
    frame = (origin[0], origin[1], tu / chord, tv / chord)
    split = _first_ahead(bins, low, high, frame)
    right, left = in_frame(bins, split, high + 1, 1, frame), in_frame(bins, split - 1, low - 1, -1, frame)
    right, left = right[: _graph(right)], left[: _graph(left)]
    if min(len(right), len(left)) == 0:
        return False
    widest = max(right[-1, X], -left[-1, X])
    found = krige(right, left, widest)
    fit[T_U], fit[T_V], fit[PLACE], fit[SLOPE], fit[BEND] = frame[2], frame[3], found[0], found[1], 0.5 * found[2]
    fit[SIGMA], fit[REACH] = math.sqrt(found[3]), widest
    cells_right, cells_left = new_indices(len(right)), new_indices(len(left))
    for k in range(len(right)):
        cells_right[k] = math.floor(bins[split + k, ARC] / cell) - line.first_cell
    for k in range(len(left)):
        cells_left[k] = math.floor(bins[split - 1 - k, ARC] / cell) - line.first_cell
    _share(right, left, cells_right, cells_left, found, widest, share)
    return True


@inlined()
def _first_ahead(bins: Array, low: int, high: int, frame: tuple[float, float, float, float]) -> int:
    """The first of the bins from `low` to `high` that is at x ≥ 0 in the frame, found by halving."""
    behind = high + 1
    while low < behind:
        middle = (low + behind) // 2
        if (bins[middle, U] - frame[0]) * frame[2] + (bins[middle, V] - frame[1]) * frame[3] < 0.0:
            low = middle + 1
        else:
            behind = middle
    return low


@inlined()
def _window(bins: Array, broken: NDArray[np.bool_], arc: float, middle: int, reach: float) -> tuple[int, int]:
    """First and last of the bins within `reach` and on this side of every kink and jump."""
    low, high = middle, middle - 1
    while low > 0 and not broken[low - 1] and arc - bins[low - 1, ARC] <= reach:
        low -= 1
    while high + 1 < len(bins) and not broken[high + 1] and bins[high + 1, ARC] - arc <= reach:
        high += 1
    return low, high


@inlined()
def _graph(bins: Array) -> int:
    """How many of the bins from the origin outwards are the graph of a function of x."""
    for k in range(1, len(bins)):
        dx, dy = abs(bins[k, X]) - abs(bins[k - 1, X]), abs(bins[k, 1] - bins[k - 1, 1])
        if dx <= 0.0 or dy > _STEEPEST * dx:
            return k
    return len(bins)


@inlined()
def _share(
    right: Array,
    left: Array,
    cells_right: NDArray[np.int64],
    cells_left: NDArray[np.int64],
    found: Array,
    reach: float,
    share: Array,
) -> None:
    """Compute how far the error of each cell moves the place: its influence times the σ of its mean.

    What the place owes to the choice and to the curvature is as common to neighbours as the noise: it is shared alike.
    """
    sigma = straight_sigma(right, left)
    whole = math.sqrt(found[3] / found[5])
    one, other = first_rows(right, len(right)), first_rows(left, len(left))
    for cell in range(len(share)):
        information = _only(one, cells_right, cell) + _only(other, cells_left, cell)
        share[cell] = 0.0
        if information > 0:
            share[cell] = whole * influence(one, other, reach, sigma, int(found[4])) / math.sqrt(information)


@inlined()
def _only(bins: Array, cells: NDArray[np.int64], cell: int) -> float:
    """Put y of the bins to 1 in one cell and to 0 elsewhere; how much information that cell has."""
    information = 0.0
    for k in range(len(bins)):
        bins[k, Y] = 1.0 if cells[k] == cell else 0.0
        information += bins[k, Y] * bins[k, INFORMATION]
    return information
