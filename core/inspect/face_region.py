"""The region a face covers: its area, and the points far enough from its edge."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.scan.surface.cloud import FAN, Cloud

CELL_MM = 0.5
"""Side of a cell: below the spacing of stripes on a usual scan, so that a face's edge is found to half a cell."""
SMALLEST_GAP_MM, LARGEST_GAP_MM = 4.0, 10.0
"""Half the widest gap between two stripes that counts as covered lies between these, by how dense the stripes are."""
GAP_SHARE = 6.0
"""Half that gap over the median distance to the nearest point, which is a quarter of an even spacing of stripes."""
SMALL_PART = 0.05
"""Parts of a face smaller than this share of its largest one are clutter that happens to lie in its plane."""
STRAY_SHARE = 0.01
"""Points of sweeps on a face, over those of the fan, up to which no sweep reaches it: they are wrong ones. A sweep that
crosses a line of the fan leaves 1 mm of itself even on a plane that slants by 30° through that line, so that sweeps
that cross the lines of the fan every 100 mm have a larger share."""
MOST_CELLS = 4000
"""Along a side: on faces beyond 2 m the cells grow instead, so that a map needs 16 MB at most."""


@dataclass(frozen=True, eq=False, slots=True)
class Region:
    """Indices of the points inside the margin of a face, and the area in mm² inside that margin."""

    indices: NDArray[np.int64]
    area_mm2: float

    @classmethod
    def of(
        cls,
        points: Array,
        near: NDArray[np.int64],
        normal: Array,
        margin_mm: float,
        smallest_part: float = SMALL_PART,
    ) -> Region:
        """Compute the region, less a margin, that `points[near]` cover on the plane with the unit normal `normal` (3,).

        The points are laid out on the plane in cells of 0.5 mm and the gaps between stripes closed, the wider the
        further apart the stripes are; parts smaller than `smallest_part` of the largest are left out.
        """
        if len(near) < 3:
            return cls(near[:0], 0.0)
        laid = _Laid.out(points[near], normal, margin_mm)
        inner = laid.inner(margin_mm, smallest_part)
        return cls(near[inner[laid.row, laid.column]], float(inner.sum()) * laid.cell**2)


def most_lies_elsewhere(
    cloud: Cloud, near: NDArray[np.int64], normal: Array, margin_mm: float, elsewhere: Array
) -> bool:
    """Whether more of the sweeps' points within the region that `cloud.points[near]` cover lie `elsewhere` than on it.

    So it is with a plane that slants through treads narrower than the gaps between stripes that count as covered: on it
    are the fan's lines, one on each tread, and of the sweeps the strips beside them. A face has nothing else before it
    or behind. `elsewhere` (M, 3) are points of sweeps off the plane with this unit `normal` (3,).
    """
    if len(near) < 3 or not len(elsewhere):
        return False
    laid = _Laid.out(cloud.points[near], normal, margin_mm)
    inner = laid.inner(margin_mm, SMALL_PART)
    on = inner[laid.row, laid.column] & (cloud.sweep[near] > FAN)
    row, column = laid.places(elsewhere)
    return bool(np.count_nonzero(inner[row, column]) > np.count_nonzero(on))


def region_on(
    cloud: Cloud, near: NDArray[np.int64], normal: Array, margin_mm: float, smallest_part: float = SMALL_PART
) -> Region:
    """Compute the region, less a margin, of the face of a cloud that the points with the indices `near` (n,) cover.

    A face that no sweep reaches is known by the fan's lines alone, and these lie as far apart as the rig has them: what
    is between two of them is no edge. Where several lines see it, each is cut by the margin at its own ends, and stands
    for the narrowest gap that counts as covered. A plane that slants through lines on levels that sweeps reach has all
    of these lines, and of the sweeps narrow strips beside them: there a wide gap is an edge, as on any swept face.
    """
    lines = np.unique(cloud.sweep[near][cloud.sweep[near] <= FAN])
    if len(lines) < 2 or not _no_sweep_reaches(cloud, near):
        return Region.of(cloud.points, near, normal, margin_mm, smallest_part)
    pieces = [piece for line in lines for piece in _pieces(cloud.points, near[cloud.sweep[near] == line])]
    longest = max(float(along[-1]) for _, along in pieces)
    kept, length = [near[:0]], 0.0
    for indices, along in pieces:
        end = float(along[-1]) - margin_mm
        if along[-1] >= smallest_part * longest and end > margin_mm:
            kept.append(indices[(along >= margin_mm) & (along <= end)])
            length += end - margin_mm
    return Region(np.sort(np.concatenate(kept)), length * 2 * SMALLEST_GAP_MM)


def _no_sweep_reaches(cloud: Cloud, near: NDArray[np.int64]) -> bool:
    """Whether of sweeps there are but stray points among those of the fan."""
    of_fan = cloud.sweep[near] <= FAN
    return bool(np.count_nonzero(~of_fan) <= STRAY_SHARE * np.count_nonzero(of_fan))


def _pieces(points: Array, line: NDArray[np.int64]) -> Iterator[tuple[NDArray[np.int64], Array]]:
    """The contiguous pieces of one line of the fan, and the way in mm from the begin of each to its points."""
    steps = np.linalg.norm(np.diff(points[line], axis=0), axis=1)
    for piece in np.split(np.arange(len(line)), np.flatnonzero(steps > 2 * SMALLEST_GAP_MM) + 1):
        yield line[piece], np.concatenate([[0.0], np.cumsum(steps[piece[:-1]])])


def connected_with(
    points: Array, near: NDArray[np.int64], elsewhere: NDArray[np.int64], normal: Array, place: Array
) -> NDArray[np.int64]:
    """Select those of `points[near]` on one connected face with the one nearest to `place` (3,); return indices.

    They are laid out as for `Region.of`, seen along `normal`; gaps as wide as those between stripes are bridged unless
    points of something else, `points[elsewhere]`, lie in them.
    """
    laid = _Laid.out(points[near], normal, 0.0)
    to_mine = _distances(laid.occupied)
    bridged = to_mine <= _half_gap(laid.occupied, to_mine, laid.cell)
    others = laid.with_points(points[elsewhere])
    if others.any():
        bridged &= to_mine <= _distances(others)
    labels = cv2.connectedComponents(bridged.astype(np.uint8))[1][laid.row, laid.column]
    nearest = int(np.argmin(((points[near] - place) ** 2).sum(axis=1)))
    connected: NDArray[np.int64] = near[labels == labels[nearest]]
    return connected


@dataclass(frozen=True, eq=False, slots=True)
class _Laid:
    """Points (n, 3) laid out on a plane in cells of side `cell` mm: each one's `row` and `column`, which are occupied.

    `axes` (2, 3) span the plane; a place X is in the cell of (axes·X − low)/cell + pad.
    """

    axes: Array
    low: Array
    cell: float
    pad: int
    row: NDArray[np.int64]
    column: NDArray[np.int64]
    occupied: NDArray[np.uint8]

    @classmethod
    def out(cls, points: Array, normal: Array, room_mm: float) -> _Laid:
        """On the plane with this normal, with `room_mm` about them besides the largest gap."""
        axes = np.linalg.svd(normal[None, :])[2][1:]
        flat = points @ axes.T
        low = flat.min(axis=0)
        cell = max(CELL_MM, float((flat.max(axis=0) - low).max()) / MOST_CELLS)
        pad = int(np.ceil((LARGEST_GAP_MM + room_mm) / cell)) + 2
        column, row = (np.floor((flat - low) / cell).astype(np.int64) + pad).T
        occupied = np.zeros((int(row.max()) + pad + 1, int(column.max()) + pad + 1), dtype=np.uint8)
        occupied[row, column] = 1
        return cls(axes, low, cell, pad, row, column, occupied)

    def inner(self, margin_mm: float, smallest_part: float) -> NDArray[np.bool_]:
        """Which cells are covered, and farther from the edge of what is than the margin."""
        covered = _without_small_parts(_closed(self.occupied, self.cell), smallest_part)
        depth_in = cv2.distanceTransform(covered, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        # Distances run to the centre of the first empty cell; the edge lies half a cell nearer.
        return np.asarray((depth_in - 0.5) * self.cell >= margin_mm, dtype=np.bool_)

    def places(self, points: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Rows and columns of those of other points (m, 3) that lie in one of the cells."""
        column, row = (np.floor((points @ self.axes.T - self.low) / self.cell).astype(np.int64) + self.pad).T
        rows, columns = self.occupied.shape
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        return row[inside], column[inside]

    def with_points(self, points: Array) -> NDArray[np.uint8]:
        """Which cells hold one of other points (m, 3)."""
        cells = np.zeros_like(self.occupied)
        cells[self.places(points)] = 1
        return cells


def _closed(occupied: NDArray[np.uint8], cell: float) -> NDArray[np.uint8]:
    """Morphological closing with a disc as large as the gaps between stripes, by distances: fast for any radius."""
    to_occupied = _distances(occupied)
    radius = _half_gap(occupied, to_occupied, cell)
    to_empty = _distances(to_occupied > radius)
    return np.asarray((to_empty > radius) | (occupied > 0), dtype=np.uint8)


def _half_gap(occupied: NDArray[np.uint8], to_occupied: NDArray[np.float32], cell: float) -> float:
    """Half the widest gap between stripes that counts as covered, in cells."""
    row, column = np.nonzero(occupied)
    hull = cv2.convexHull(np.column_stack([column, row]).astype(np.int32))
    within = cv2.fillConvexPoly(np.zeros_like(occupied), hull, 1) > 0
    gap = GAP_SHARE * float(np.median(to_occupied[within]))
    return float(np.clip(gap, SMALLEST_GAP_MM / cell, LARGEST_GAP_MM / cell))


def _distances(cells: NDArray[np.uint8] | NDArray[np.bool_]) -> NDArray[np.float32]:
    """Distance, in cells, of each cell from the nearest of those that are set."""
    away = cv2.distanceTransform((cells == 0).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.asarray(away, dtype=np.float32)


def _without_small_parts(covered: NDArray[np.uint8], smallest_part: float) -> NDArray[np.uint8]:
    """Only the connected parts of at least `smallest_part` times the largest one's area."""
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(covered, connectivity=4)
    area = statistics[:, cv2.CC_STAT_AREA].astype(np.float64)
    area[0] = 0.0  # the background
    kept = np.asarray((area >= smallest_part * area.max()) & (area > 0), dtype=np.uint8)
    return np.asarray(kept[labels], dtype=np.uint8)


def inside_polygon(uv: Array, corners: Array) -> NDArray[np.bool_]:
    """Compute flags (N,) of the pixels `uv` (N, 2) inside the polygon `corners` (n, 2), by the even–odd rule."""
    inside = np.zeros(len(uv), dtype=np.bool_)
    for (u0, v0), (u1, v1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        spans = (v0 > uv[:, 1]) != (v1 > uv[:, 1])
        if v0 != v1:
            inside ^= spans & (uv[:, 0] < u0 + (u1 - u0) * (uv[:, 1] - v0) / (v1 - v0))
    return inside


def on_face(points: Array, used: Array, normal: Array, distance: float) -> NDArray[np.bool_]:
    """Compute flags (N,) of the `points` (N, 3) in mm on a face: close to its plane and to its points `used` (M, 3).

    Parameters
    ----------
    used
        (M, 3) the points the face rests on.
    normal, distance
        Its plane normal·X = distance.
    """
    on = np.zeros(len(points), dtype=np.bool_)
    if len(used) < 3:
        return on
    near = np.abs(points @ normal - distance) <= 1.5 * float(np.abs(used @ normal - distance).max())
    axes = np.linalg.svd(normal[None, :])[2][1:]
    flat, mine = points[near] @ axes.T, used @ axes.T
    low, high = mine.min(axis=0) - LARGEST_GAP_MM, mine.max(axis=0) + LARGEST_GAP_MM
    cell = max(CELL_MM, float((high - low).max()) / MOST_CELLS)
    empty = np.ones((np.ceil((high - low) / cell).astype(np.int64) + 1)[::-1], dtype=np.uint8)
    column, row = np.floor((mine - low) / cell).astype(np.int64).T
    empty[row, column] = 0
    away = cv2.distanceTransform(empty, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * cell
    within = np.all((flat >= low) & (flat < high), axis=1)
    column, row = np.floor((flat[within] - low) / cell).astype(np.int64).T
    chosen = np.flatnonzero(near)[within]
    on[chosen[away[row, column] <= SMALLEST_GAP_MM / 2]] = True
    return on
