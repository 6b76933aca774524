"""Centrelines prepared for crossing with many others, and the search for segments that cut each other.

Runs of 16 segments share a bounding box; only segments of overlapping boxes are compared one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.crossings.breaks import breaks
from core.image.crossings.line_bins import bin_length, binned
from core.image.stripes.centreline import Centreline
from core.image.stripes.runs import arc_length
from core.model.arrays import Array
from core.model.small_arrays import doubled_index_table, new_index_table, new_table

_SEGMENTS_PER_BOX, _BOXES_PER_GROUP = 16, 8  # chosen by speed

CELL_REACH = 3
"""Cells to either side that a local fit reaches, if the line goes on so far."""
CELLS = 2 * CELL_REACH + 1
"""Most cells that a local fit can touch."""


class StackedPiece(NamedTuple):
    """Piece of a `Stack`: its points (N, 3), the length along it (N,), its bins and which of them are broken."""

    points: Array
    arc: Array
    bins: Array
    broken: NDArray[np.bool_]
    correlation_px: float


class Stack:
    """Centrelines of one picture, prepared for crossing with those of others.

    Parameters
    ----------
    lines
        The centrelines; piece i of them has the points starts[i] … starts[i + 1] and bins[i].
    cell_px
        Length of a cell in pixels, see `core.image.crossings.line_bins`.

    Attributes
    ----------
    points, arc
        (N, 3) u, v, 1/σ² (0 where saturated) and (N,) the length along the centreline in pixels.
    boxes
        Bounding boxes of runs of segments, see `meeting_segments`.
    bins, broken
        For each piece (B, 5) and (B,) bins, and True for those with a kink or a jump in them.
    """

    __slots__ = ("arc", "bins", "boxes", "broken", "cell_px", "lines", "points", "starts")

    def __init__(self, lines: Sequence[Centreline], cell_px: float) -> None:
        self.lines, self.cell_px = lines, cell_px
        self.starts = np.cumsum([0, *map(len, lines)])
        self.points = np.empty((int(self.starts[-1]), 3))
        self.arc = np.empty(len(self.points))
        self.bins: list[Array] = []
        self.broken: list[NDArray[np.bool_]] = []
        for line, start, end in zip(lines, self.starts[:-1], self.starts[1:], strict=True):
            self.points[start:end, :2] = line.uv
            self.points[start:end, 2] = np.where(line.saturated, 0.0, 1 / line.sigma**2)
            self.arc[start:end] = arc_length(line.uv)
            correlation = line.correlation_px
            length = bin_length(cell_px, correlation)
            bins = binned(self.points[start:end], self.arc[start:end], length, correlation)
            self.bins.append(bins)
            self.broken.append(breaks(bins, CELL_REACH * cell_px))
        self.boxes = _chunks(self.points, self.starts)

    def __len__(self) -> int:
        return len(self.lines)

    def point_at(self, i: int, along: float) -> int:
        """Find the index of that point of piece `i` whose length along the piece is nearest to `along`, in px."""
        arc = self.arc[self.starts[i] : self.starts[i + 1]]
        after = min(int(np.searchsorted(arc, along)), len(arc) - 1)
        return after - 1 if after > 0 and along - arc[after - 1] < arc[after] - along else after

    def piece(self, i: int) -> StackedPiece:
        """Select piece number `i` of the centrelines, with its points, bins and breaks."""
        part = slice(self.starts[i], self.starts[i + 1])
        correlation = self.lines[i].correlation_px
        return StackedPiece(self.points[part], self.arc[part], self.bins[i], self.broken[i], correlation)


@compiled()
def _chunks(points: Array, starts: NDArray[np.int64]) -> Array:
    """Bounding boxes of up to _SEGMENTS_PER_BOX segments: (K, 7) piece, first, last point, u and v from, to."""
    count = 0
    for i in range(len(starts) - 1):
        count += max(0, (starts[i + 1] - starts[i] - 2) // _SEGMENTS_PER_BOX + 1)
    boxes = new_table(count, 7)
    k = 0
    for i in range(len(starts) - 1):
        for first in range(starts[i], starts[i + 1] - 1, _SEGMENTS_PER_BOX):
            last = min(first + _SEGMENTS_PER_BOX, starts[i + 1] - 1)
            boxes[k, 0], boxes[k, 1], boxes[k, 2] = i, first, last
            for axis in range(2):
                least, most = points[first, axis], points[first, axis]
                for p in range(first + 1, last + 1):
                    least, most = min(least, points[p, axis]), max(most, points[p, axis])
                boxes[k, 3 + axis], boxes[k, 5 + axis] = least, most
            k += 1
    return boxes[:k]


@compiled()
def meeting_segments(
    a: Array, starts_a: NDArray[np.int64], boxes_a: Array, b: Array, starts_b: NDArray[np.int64], boxes_b: Array
) -> NDArray[np.int64]:
    """Find the segments of pieces `a` that intersect those of `b`: (K, 4) piece and first point, of a and of b."""
    found, count = new_index_table(16, 4), 0
    for p, q in _overlapping(boxes_a, boxes_b):
        for k in range(int(boxes_a[p, 1]), int(boxes_a[p, 2])):
            if segment_apart(a[k], a[k + 1], boxes_b[q]):
                continue
            for m in range(int(boxes_b[q, 1]), int(boxes_b[q, 2])):
                if not segments_cut(a[k], a[k + 1], b[m], b[m + 1]):
                    continue
                if count == len(found):
                    found = doubled_index_table(found)
                i, j = int(boxes_a[p, 0]), int(boxes_b[q, 0])
                found[count, 0], found[count, 1] = i, k - starts_a[i]
                found[count, 2], found[count, 3] = j, m - starts_b[j]
                count += 1
    return found[:count]


@inlined()
def _overlapping(a: Array, b: Array) -> NDArray[np.int64]:
    """Pairs (K, 2) of boxes that have something in common; boxes of `b` are passed over by the group."""
    groups = new_table(-(-len(b) // _BOXES_PER_GROUP), 7)
    for q in range(len(b)):
        g = q // _BOXES_PER_GROUP
        for axis in range(2):
            low, high = b[q, 3 + axis], b[q, 5 + axis]
            begins = q % _BOXES_PER_GROUP == 0
            groups[g, 3 + axis] = low if begins else min(groups[g, 3 + axis], low)
            groups[g, 5 + axis] = high if begins else max(groups[g, 5 + axis], high)
    pairs, count = new_index_table(64, 2), 0
    for p in range(len(a)):
        for g in range(len(groups)):
            if boxes_apart(a[p], groups[g]):
                continue
            for q in range(g * _BOXES_PER_GROUP, min((g + 1) * _BOXES_PER_GROUP, len(b))):
                if boxes_apart(a[p], b[q]):
                    continue
                if count == len(pairs):
                    pairs = doubled_index_table(pairs)
                pairs[count, 0], pairs[count, 1] = p, q
                count += 1
    return pairs[:count]


@inlined()
def boxes_apart(one: Array, other: Array) -> bool:
    """Whether the bounding boxes of two runs of segments, rows (7,) of their tables, do not overlap."""
    return bool(one[5] < other[3] or other[5] < one[3] or one[6] < other[4] or other[6] < one[4])


@inlined()
def segment_apart(p: Array, q: Array, box: Array) -> bool:
    """Whether the segment from p (≥ 2,) to q is on the outside of one side of a bounding `box` (7,)."""
    return bool(
        max(p[0], q[0]) < box[3] or box[5] < min(p[0], q[0]) or max(p[1], q[1]) < box[4] or box[6] < min(p[1], q[1])
    )


@inlined()
def segments_cut(p: Array, q: Array, r: Array, s: Array) -> bool:
    """Whether the segment from p (≥ 2,) to q, without q itself, intersects the segment from r to s, without s."""
    du, dv, eu, ev = q[0] - p[0], q[1] - p[1], s[0] - r[0], s[1] - r[1]
    cross = du * ev - dv * eu
    if cross == 0.0:
        return False
    along_a = ((r[0] - p[0]) * ev - (r[1] - p[1]) * eu) / cross
    along_b = ((r[0] - p[0]) * dv - (r[1] - p[1]) * du) / cross
    return bool(0 <= along_a < 1 and 0 <= along_b < 1)
