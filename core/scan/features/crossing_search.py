"""All crossings of a scan in one search: what it costs grows with the crossings, not with the pairs of frames.

Every frame compared with every other is quadratic: of 300 sweeps 45,000 pairs of pictures, most of which share but a
few places. So the centrelines of all pictures are laid on one grid, by the bounding boxes of short runs of segments,
and only runs that share a square of it are compared. What is found, and its order, is that of pictures compared two by
two.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.crossings.crossing import MEETING, REASON, SIGMAS, TANGENTS, UV, cross_segments
from core.image.crossings.local_fit import LineAt
from core.image.crossings.segments import CELL_REACH, CELLS, Stack, boxes_apart, segment_apart, segments_cut
from core.image.stripes.centreline import Centreline
from core.image.stripes.shading import shading_sigma
from core.model.arrays import Array
from core.model.small_arrays import doubled_index_table, indices_of, new_index_table, new_indices
from core.progress import Progress, silent
from core.scan.features.crossings import CrossingTable, CrossingWindow, Index
from core.stage_times import stage
from core.threads import ordered_map

_AT_ONCE = 500
"""So many meetings are fitted before it is told how far the search is: some 20 ms."""
_SQUARES = 4
"""About so many squares for each run of segments at most, however far apart they are."""


@dataclass(frozen=True, eq=False, slots=True)
class Meetings:
    """Pairs of segments of different pictures' centrelines that cut each other, in the order of the table of crossings.

    `picture`, `piece` and `point` (M, 2) are those of the sweep and of the fan or the later sweep: the picture (0: the
    fan), the piece among all, the first point of the segment among all. `compared` is how many pairs of runs of
    segments were looked at.
    """

    picture: Index
    piece: Index
    point: Index
    compared: int


def all_crossings(
    fan: Sequence[Centreline],
    sweeps: Sequence[Sequence[Centreline]],
    window: CrossingWindow,
    progress: Progress = silent,
) -> CrossingTable:
    """Find every crossing of each sweep with the fan and with each later sweep.

    A StageTimes learns what that costs on all threads.
    """
    pictures = (fan, *sweeps)
    progress("crossings", 0, len(sweeps))
    lines = Stack([piece for pieces in pictures for piece in pieces], window.half_length_px)
    picture = np.repeat(np.arange(len(pictures)), [len(pieces) for pieces in pictures])
    met = meetings_of(lines, picture)
    fitted = _Fits.of(lines, met, window.min_angle, len(sweeps), progress)
    progress("crossings", len(sweeps), len(sweeps))
    return _table(lines, picture, met, fitted, window)


def meetings_of(lines: Stack, picture: Index) -> Meetings:
    """Find where centrelines of different pictures cut each other; `picture` (P,), ascending, is that of each."""
    finite = np.isfinite(lines.boxes).all(axis=1)
    boxes = lines.boxes[finite]
    if not len(boxes):
        none = np.zeros((0, 2), dtype=np.int64)
        return Meetings(none, none, none, 0)
    low, extent = boxes[:, 3:5].min(axis=0), np.ptp(boxes[:, 3:7].reshape(-1, 2), axis=0)
    usual = float(np.median((boxes[:, 5:7] - boxes[:, 3:5]).max(axis=1)))
    most = _SQUARES * len(boxes)
    side = max(usual, math.sqrt(float(np.prod(extent)) / most), float(extent.max()) / most, 1.0)
    found, compared = _meeting_runs(lines.points, boxes, picture, low, np.ceil(extent / side) + 1, side)
    a, run_a, k, b, run_b, m = found.T
    order = np.lexsort((m, k, run_b, run_a, b, a))
    runs = np.column_stack([run_a, run_b])[order]
    return Meetings(
        np.column_stack([a, b])[order], boxes[runs, 0].astype(np.int64), np.column_stack([k, m])[order], compared
    )


@compiled()
def _meeting_runs(
    points: Array, boxes: Array, picture: Index, low: Array, squares: Array, side: float
) -> tuple[Index, int]:
    """Segments that cut each other: (M, 6) picture, run and first point of a and of b; how many runs were compared."""
    columns, rows = int(squares[0]), int(squares[1])
    reach, starts = new_index_table(len(boxes), 4), indices_of(columns * rows + 1, 0)
    for p in range(len(boxes)):
        for side_of in range(2):
            reach[p, side_of] = int((boxes[p, 3 + side_of] - low[side_of]) / side)
            reach[p, 2 + side_of] = int((boxes[p, 5 + side_of] - low[side_of]) / side)
        for row in range(reach[p, 1], reach[p, 3] + 1):
            for square in range(row * columns + reach[p, 0], row * columns + reach[p, 2] + 1):
                starts[square + 1] += 1
    filled = new_indices(columns * rows)
    for square in range(columns * rows):
        filled[square] = starts[square]
        starts[square + 1] += starts[square]
    runs = new_indices(starts[columns * rows])
    for p in range(len(boxes)):
        for row in range(reach[p, 1], reach[p, 3] + 1):
            for square in range(row * columns + reach[p, 0], row * columns + reach[p, 2] + 1):
                runs[filled[square]] = p
                filled[square] += 1
    found, count, compared = new_index_table(16, 6), 0, 0
    for square in range(len(starts) - 1):
        for first in range(starts[square], starts[square + 1]):
            p = runs[first]
            for second in range(first + 1, starts[square + 1]):
                q = runs[second]
                one, other = picture[int(boxes[p, 0])], picture[int(boxes[q, 0])]
                if one == other:
                    continue
                compared += 1
                shared = max(reach[p, 1], reach[q, 1]) * columns + max(reach[p, 0], reach[q, 0])
                if square != shared or boxes_apart(boxes[p], boxes[q]):  # two runs may share many squares
                    continue
                a, b = (q, p) if one == 0 else (p, q)  # runs ascend, and so do pictures; the fan, 0, is b
                for k in range(int(boxes[a, 1]), int(boxes[a, 2])):
                    if segment_apart(points[k], points[k + 1], boxes[b]):
                        continue
                    for m in range(int(boxes[b, 1]), int(boxes[b, 2])):
                        if not segments_cut(points[k], points[k + 1], points[m], points[m + 1]):
                            continue
                        if count == len(found):
                            found = doubled_index_table(found)
                        found[count, 0], found[count, 1], found[count, 2] = picture[int(boxes[a, 0])], a, k
                        found[count, 3], found[count, 4], found[count, 5] = picture[int(boxes[b, 0])], b, m
                        count += 1
    return found[:count], compared


@dataclass(frozen=True, eq=False, slots=True)
class _Fits:
    """The crossing (M, 10) at each meeting, see `core.image.crossings.crossing.cross_segments`, and what its table
    wants beside.

    `along` (M, 2) where on each centreline, `cell` (M, 2) the first cell of its fit, `share` (M, 2, K).
    """

    rows: Array
    along: Array
    cell: Index
    share: Array

    @classmethod
    def of(cls, lines: Stack, met: Meetings, min_angle: float, sweeps: int, progress: Progress) -> _Fits:
        """Fit both centrelines at every meeting; `progress` is told which of so many `sweeps` it has come to."""
        count = len(met.piece)
        fits = cls(
            np.empty((count, MEETING)),
            np.empty((count, 2)),
            np.empty((count, 2), np.int64),
            np.zeros((count, 2, CELLS)),
        )
        pieces = _Pieces.of(lines)

        def fit(start: int) -> int:
            part = slice(start, start + _AT_ONCE)
            into = _Into(fits.rows[part], fits.along[part], fits.cell[part], fits.share[part])
            with stage(progress, "crossings"):
                _fit(met.piece[part], met.point[part], pieces, lines.cell_px, min_angle, into)
            return start

        for start in ordered_map(fit, range(0, count, _AT_ONCE)):
            progress("crossings", int(met.picture[start, 0]) - 1, sweeps)
        return fits


class _Into(NamedTuple):
    """Where fits are put, as in `_Fits`."""

    rows: Array
    along: Array
    cell: Index
    share: Array


class _Pieces(NamedTuple):
    """The pieces of a `Stack` one behind the other: piece i has the points starts[i] … starts[i + 1], and bins so."""

    points: Array
    arc: Array
    starts: Index
    bins: Array
    broken: NDArray[np.bool_]
    bin_starts: Index
    correlation: Array

    @classmethod
    def of(cls, lines: Stack) -> _Pieces:
        """All pieces of `lines`."""
        return cls(
            lines.points,
            lines.arc,
            lines.starts,
            np.concatenate([np.zeros((0, 5)), *lines.bins]),
            np.concatenate([np.zeros(0, bool), *lines.broken]),
            np.cumsum([0, *map(len, lines.bins)]),
            np.array([line.correlation_px for line in lines.lines], dtype=np.float64),
        )


@compiled()
def _fit(piece: Index, point: Index, pieces: _Pieces, cell_px: float, min_angle: float, into: _Into) -> None:
    """Fit the centrelines at some meetings, see `Meetings`, and put what comes out `into` arrays."""
    arc = pieces.arc
    rows, along, cell, share = into
    for n in range(len(piece)):
        for end in range(2):
            k = point[n, end]
            along[n, end] = 0.5 * (arc[k] + arc[k + 1])
            cell[n, end] = max(0, math.floor(along[n, end] / cell_px) - CELL_REACH)
        a = _line_at(pieces, piece[n, 0], point[n, 0], along[n, 0], cell[n, 0])
        b = _line_at(pieces, piece[n, 1], point[n, 1], along[n, 1], cell[n, 1])
        cross_segments(a, b, cell_px, min_angle, share[n], rows[n])


@inlined()
def _line_at(pieces: _Pieces, i: int, point: int, along: float, cell: int) -> LineAt:
    """Piece `i` at the segment from a `point` among those of all pieces, `along` px from the piece's first point."""
    start, end, bins = pieces.starts[i], pieces.starts[i + 1], slice(pieces.bin_starts[i], pieces.bin_starts[i + 1])
    return LineAt(
        pieces.points[start:end],
        point - start,
        pieces.bins[bins],
        pieces.broken[bins],
        along,
        pieces.correlation[i],
        cell,
    )


def _table(lines: Stack, picture: Index, met: Meetings, fits: _Fits, window: CrossingWindow) -> CrossingTable:
    """The meetings that are crossings, each once, with what uneven brightness adds to their σ."""
    keep = _met_once(met, fits.rows, window.half_length_px)
    first = np.searchsorted(picture, picture)  # of the pieces in each piece's picture
    shading = np.concatenate([np.zeros(0), *map(shading_sigma, lines.lines)])
    named: dict[str, Any] = {}
    ends = fits.rows[keep]
    for end, name in enumerate("ab"):
        piece, k, along = met.piece[keep, end], met.point[keep, end], fits.along[keep, end]
        nearest = np.where(along - lines.arc[k] < lines.arc[k + 1] - along, k, k + 1)
        named |= {
            f"tangent_{name}": ends[:, TANGENTS + 2 * end : TANGENTS + 2 * end + 2],
            f"sigma_{name}": np.hypot(ends[:, SIGMAS + end], shading[nearest]),
            name: met.picture[keep, end] - 1,
            f"piece_{name}": piece - first[piece],
            f"along_{name}": along,
            f"cell_{name}": fits.cell[keep, end],
            f"share_{name}": fits.share[keep, end],
        }
    return CrossingTable(uv=ends[:, UV : UV + 2], half_length_px=window.half_length_px, **named)


def _met_once(met: Meetings, rows: Array, half_length_px: float) -> Index:
    """The meetings that are crossings; of one that two rough lines meet at more than once, the first."""
    crossed = np.flatnonzero(rows[:, REASON] == 0)
    kept: dict[tuple[int, int], list[int]] = {}
    keep = []
    for n, i, j in zip(crossed.tolist(), *met.piece[crossed].T.tolist(), strict=True):
        before = kept.setdefault((i, j), [])
        if not any(np.hypot(*(rows[one, UV : UV + 2] - rows[n, UV : UV + 2])) < half_length_px / 2 for one in before):
            before.append(n)
            keep.append(n)
    return np.array(keep, dtype=np.int64)
