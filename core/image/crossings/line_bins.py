"""Centrelines reduced to bins for a local fit: few, and each with an independent error.

A bin is the weighted mean of the points within a stretch of the line that is as long as their noise is correlated, or
eight pixels. Each bin's error is taken as independent with the variance that a mean over its length has; their own
variance is a little smaller and their neighbours' errors a little alike, which comes to the same over a few bins.

Bins tile cells of equal length, which start at the first point of each line: see
`core.scan.features.crossings.CrossingTable`.
"""

from __future__ import annotations

import math

from core.compiled import compiled, inlined
from core.model.arrays import Array
from core.model.small_arrays import first_rows, new_table, zero_table

ARC, U, V, INFORMATION, SPREAD = 0, 1, 2, 3, 4
"""Columns of a bin: length along the line, place, 1/σ² across it in px⁻², variance of its points along it in px²."""

_SHORTEST_PX = 8.0  # length of a bin, at least: about the correlation length of narrow stripes; shorter ones cost time
_LONGEST_SHARE_PX = 3.0  # of the line that a point beside a gap stands for on that side


def bin_length(cell_px: float, correlation_px: float) -> float:
    """Choose the length in px of the bins of a line, a whole fraction of `cell_px` and about `correlation_px`."""
    return cell_px / max(1, math.floor(cell_px / max(correlation_px, _SHORTEST_PX)))


@compiled()
def binned(points: Array, arc: Array, length: float, correlation: float) -> Array:
    """Average a line's `points` (N, 3) u, v, 1/σ² in bins of `length` px along it: (B, 5), empty ones left out."""
    count = len(points)
    bins = zero_table(int(arc[-1] / length) + 1, 5)
    for k in range(count):
        before = min(arc[k] - arc[k - 1], _LONGEST_SHARE_PX) if k > 0 else 0.0
        after = min(arc[k + 1] - arc[k], _LONGEST_SHARE_PX) if k + 1 < count else 0.0
        # a point stands for as much of the line as its share of the correlation length
        weight = points[k, 2] * min(1.0, 0.5 * (before + after) / max(correlation, 1e-9))
        row = bins[min(int(arc[k] / length), len(bins) - 1)]
        row[ARC] += weight * arc[k]
        row[U] += weight * points[k, 0]
        row[V] += weight * points[k, 1]
        row[INFORMATION] += weight
        row[SPREAD] += weight * arc[k] * arc[k]
    kept = 0
    for k in range(len(bins)):
        weight = bins[k, INFORMATION]
        if weight <= 0.0:
            continue
        for column in (ARC, U, V, SPREAD):
            bins[kept, column] = bins[k, column] / weight
        bins[kept, INFORMATION] = weight
        bins[kept, SPREAD] = max(0.0, bins[kept, SPREAD] - bins[kept, ARC] ** 2)
        kept += 1
    return first_rows(bins, kept)


@inlined()
def in_frame(bins: Array, first: int, behind: int, step: int, frame: tuple[float, float, float, float]) -> Array:
    """Transform some `bins` of a line into a `frame` (u, v, t_u, t_v): (N, 4) x, y, 1/σ², spread.

    Those from `first` on to before `behind`, upwards or downwards as `step` (1 or −1) says.
    """
    found = new_table(max(0, (behind - first) * step), 4)
    for k in range(len(found)):
        row = first + k * step
        du, dv = bins[row, U] - frame[0], bins[row, V] - frame[1]
        found[k, 0], found[k, 1] = du * frame[2] + dv * frame[3], dv * frame[2] - du * frame[3]
        found[k, 2], found[k, 3] = bins[row, INFORMATION], bins[row, SPREAD]
    return found
