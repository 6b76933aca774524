"""Linking: from coarse seeds in the whole picture to ordered runs of line points.

Steger links the line points of a filtered picture, strongest first, each to the neighbour that lies ahead on its
tangent. Here the points are only computed where the tangent leads, so the filter runs over the stripe and not over
the picture. Hysteresis: a run starts above a high and continues above a low threshold; it holds on through dark
speckle grains, and longer through saturated pixels, straight ahead.

Which places have been traced already is kept in lists of points, one list for each cell of the picture. A map with a
mark at every pixel near a line would be as large as the picture; touching its memory alone took longer than half of
all tracing.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930, §4.1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.stripes.tracing.interpolation import tracing_step, with_points_between
from core.image.stripes.tracing.pixel_state import IGNORED, SATURATED
from core.image.stripes.tracing.ridge import (
    COLUMNS_AT_ONCE,
    Detector,
    kernel_radius,
    kernel_table,
    ridge_at,
    ridge_response,
)
from core.image.stripes.tracing.seeds import Picture, seeds
from core.model.arrays import Array
from core.model.small_arrays import doubled_indices, new_indices, new_single_table, new_table

# Chosen for speed at the same points: tests/image/stripes/test_extraction.py and tests/image/test_rendered_lines.py
# hold them.
_MARK_EVERY = 2  # points: discs much larger than that leave no gap between them
_LONGEST_STEP = 2  # px: longer ones lose short, saturated pieces of photographed stripes at their ends
_NEAR_ENOUGH = 0.08  # filter σ from the crest: seen from there, Taylor's step errs by less than 0.0005 px
_LARGEST_TURN = math.cos(math.radians(30))  # cosine, from one point to the next: a kink or another line


HOLD = 3.0
"""Filter σ that a run goes on without response, over dark grains: tests/image/stripes/test_extraction.py (deep speckle)
holds it."""


class PointGrid(NamedTuple):
    """Grid of points by cells of the picture, as lists linked from each cell's last point; counted from 1 on.

    `last` (rows, columns) is the last point of each cell, `before` (N,) the point before each one in its cell.
    """

    last: NDArray[np.int32]
    before: NDArray[np.int32]


class _Limits(NamedTuple):
    """When a run starts and goes on: thresholds are second derivatives across the line, lengths in px."""

    filter_px: float
    high: float
    low: float
    hold_px: float
    saturated_hold_px: float
    step_px: float


class _Traced(NamedTuple):
    """The points (N, 5) of the runs traced so far, where they are, and how near to them in px no other may come."""

    points: Array
    grid: PointGrid
    reach: int


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """Thresholds as heights of a stripe in grey levels, and the length in px that a run may continue unseen.

    `noise_grey` is the scatter of a pixel in grey levels.
    """

    high: float
    low: float
    hold_px: float
    saturated_hold_px: float
    noise_grey: float


def link(
    picture: Picture, state: NDArray[np.uint8], stripe_px: float, filter_px: float, limits: Hysteresis
) -> list[Array]:
    """Trace all stripes as runs of line points, each (N, 5): u, v, n_u, n_v, response.

    Points are one px apart along the tangent (−n_v, n_u).
    The response is the second derivative across the stripe with its sign reversed. `state` (H, W) holds the bits
    SATURATED and IGNORED.
    """
    radius = kernel_radius(filter_px)
    if min(picture.shape) <= 2 * radius + 3:
        return []
    unit = ridge_response(1.0, stripe_px, filter_px)
    stride = min(tracing_step(filter_px), _LONGEST_STEP)
    flat: Any = np.ascontiguousarray(picture).reshape(-1)  # float32 or int16
    if picture.shape[1] < COLUMNS_AT_ONCE:
        flat = np.append(flat, np.zeros(COLUMNS_AT_ONCE, flat.dtype))
    points, ends = _trace_all(
        flat,
        state,
        seeds(picture, stripe_px, filter_px, limits.high, limits.noise_grey),
        kernel_table(filter_px),
        _Limits(
            filter_px, unit * limits.high, unit * limits.low, limits.hold_px, limits.saturated_hold_px, float(stride)
        ),
        radius,
        math.ceil(2 * stripe_px + 1),
    )
    runs = np.split(points, ends[:-1]) if len(ends) else []
    return [with_points_between(run, stride) for run in runs] if stride > 1 else runs


@compiled(fastmath=True)
def _trace_all(
    picture: Picture,
    state: NDArray[np.uint8],
    starts: Array,
    kernels: NDArray[np.float32],
    limits: _Limits,
    radius: int,
    reach: int,
) -> tuple[Array, NDArray[np.int64]]:
    """Trace both ways from every seed that no run has come near yet; all points and where each run ends."""
    height, width = state.shape
    high, stride = limits.high, limits.step_px
    ahead, behind = new_table(4 * (height + width), 5), new_table(4 * (height + width), 5)
    points, grid = new_table(16384, 5), empty_point_grid((height, width), reach, 16384)
    ends, detector = new_indices(64), Detector(radius, kernels, new_single_table(1, 3 * COLUMNS_AT_ONCE)[0])
    count, runs = 0, 0
    for k in range(len(starts)):
        u, v = starts[k, 0], starts[k, 1]
        found = False
        response, nu, nv = 0.0, 1.0, 0.0
        for _ in range(6):  # the coarse look is a block or two beside the crest
            if not _inside(u, v, width, height, radius):
                found = False
                break
            if state[int(v + 0.5), int(u + 0.5)] & IGNORED or is_near_point(grid, points, u, v, reach):
                found = False
                break
            across, nu, nv, offset = ridge_at(picture, width, u, v, detector)
            response = -across
            if response < 0.3 * high:
                found = False
                break
            step = min(max(offset, -1.0), 1.0)
            u += step * nu
            v += step * nv
            found = abs(offset) < 0.05 and response > high
            if found:
                break
        if not found:
            continue
        so_far = _Traced(points, grid, reach)
        backwards = _follow(picture, state, so_far, (u, v, -nu, -nv), limits, detector, behind)
        last = max(backwards - 1, 0)
        closed = backwards > 20 and math.hypot(behind[last, 0] - u, behind[last, 1] - v) < 1.5 * stride
        forwards = 0 if closed else _follow(picture, state, so_far, (u, v, nu, nv), limits, detector, ahead)
        needed = backwards + 1 + forwards
        if len(points) < count + needed:
            more = new_table(2 * (count + needed), 5)
            for i in range(count):
                for a in range(5):
                    more[i, a] = points[i, a]
            points, grid = more, enlarged_point_grid(grid, len(more))
        run = points[count : count + needed]
        for i in range(backwards):
            for a in range(5):
                there = behind[backwards - 1 - i, a]
                run[i, a] = -there if a == 2 or a == 3 else there
        run[backwards, 0], run[backwards, 1], run[backwards, 2], run[backwards, 3] = u, v, nu, nv
        run[backwards, 4] = response
        for i in range(forwards):
            for a in range(5):
                run[backwards + 1 + i, a] = ahead[i, a]
        for i in range(0, needed + _MARK_EVERY - 1, _MARK_EVERY):
            add_point(grid, points, count + min(i, needed - 1), reach)
        count += needed
        if runs == len(ends):
            ends = doubled_indices(ends)
        ends[runs] = count
        runs += 1
    return points[:count], ends[:runs]


@inlined(fastmath=True)
def _inside(u: float, v: float, width: int, height: int, radius: int) -> bool:
    margin = radius + 0.5
    return margin < u < width - 1 - margin and margin < v < height - 1 - margin


@inlined(fastmath=True)
def _follow(
    picture: Picture,
    state: NDArray[np.uint8],
    so_far: _Traced,
    start: tuple[float, float, float, float],
    limits: _Limits,
    detector: Detector,
    out: Array,
) -> int:
    """Points ahead of `start` (u, v, n_u, n_v) along its tangent, written to `out`; their number.

    `so_far` are the points of the other runs.
    """
    height, width = state.shape
    points, grid, reach = so_far
    filter_px, _, low, hold, saturated_hold, stride = limits
    u, v = start[0], start[1]
    tu, tv = -start[3], start[2]
    count, missed, blind = 0, 0.0, 0.0  # the last two in px
    while count < len(out):
        u += stride * tu
        v += stride * tv
        if not _inside(u, v, width, height, detector.radius):
            break
        here = state[int(v + 0.5), int(u + 0.5)]
        if here & IGNORED or is_near_point(grid, points, u, v, reach):
            break
        across, nu, nv, offset = ridge_at(picture, width, u, v, detector)
        far = max(0.5, 0.25 * stride) + 0.05 * (missed + blind)  # straight ahead drifts off while nothing is seen
        if across < -low and _NEAR_ENOUGH * filter_px < abs(offset) <= far:
            u2, v2 = u + offset * nu, v + offset * nv
            if not _inside(u2, v2, width, height, detector.radius):
                break
            across, nu, nv, offset = ridge_at(picture, width, u2, v2, detector)
        else:
            u2, v2 = u, v
        if nu * tv - nv * tu < 0:  # the tangent (−n_v, n_u) keeps its direction
            nu, nv, offset = -nu, -nv, -offset
        ahead = nu * tv - nv * tu
        if across < -low and abs(offset) <= 0.5 and ahead > _LARGEST_TURN:
            u, v = u2 + offset * nu, v2 + offset * nv
            tu, tv = -nv, nu
            row = out[count]
            row[0], row[1], row[2], row[3], row[4] = u, v, nu, nv, -across
            count += 1
            missed, blind = 0.0, 0.0
            if count > 20 and (u - start[0]) ** 2 + (v - start[1]) ** 2 < stride * stride:
                break  # a closed curve
            continue
        if missed + blind == 0 and count > 2:
            # a chord is steadier than the last tangent; close to a saturated patch the line itself is bent
            bent = int(2.5 * filter_px / stride) if here & SATURATED else 0
            last = max(count - 1 - bent, 1)
            first = max(last - int((4 if bent else 2) * filter_px / stride) - 1, 0)
            tu, tv = out[last, 0] - out[first, 0], out[last, 1] - out[first, 1]
            length = math.hypot(tu, tv)
            tu, tv = tu / length, tv / length
            ahead = (count - last) * stride
            u, v = out[last, 0] + ahead * tu, out[last, 1] + ahead * tv
        if here & SATURATED:
            blind += stride
        else:
            missed += stride
        if missed > hold or blind > saturated_hold:
            break
    return count


@inlined()
def empty_point_grid(shape: tuple[int, int], reach: int, count: int) -> PointGrid:
    """Make a grid for finding points within `reach` px of a pixel; room for `count` points, picture of `shape`."""
    cell = _cell(reach)
    return PointGrid(np.zeros((shape[0] // cell + 1, shape[1] // cell + 1), np.int32), np.empty(count, np.int32))


@inlined()
def enlarged_point_grid(grid: PointGrid, count: int) -> PointGrid:
    """Copy a grid of points, with room for `count` of them."""
    before = np.empty(count, np.int32)
    for k in range(len(grid.before)):
        before[k] = grid.before[k]
    return PointGrid(grid.last, before)


@inlined()
def add_point(grid: PointGrid, points: Array, number: int, reach: int) -> None:
    """Add row `number` of `points` (N, ≥ 2), u and v in px, to the grid."""
    last, before = grid
    cell = _cell(reach)
    row, column = int(points[number, 1] + 0.5) // cell, int(points[number, 0] + 0.5) // cell
    before[number] = last[row, column]
    last[row, column] = number + 1


@inlined()
def is_near_point(grid: PointGrid, points: Array, u: float, v: float, reach: int) -> bool:
    """Whether the pixel of (u, v) is within `reach` px of the pixel of one of the `points` (N, ≥ 2) in the grid."""
    last, before = grid
    cell, column, row = _cell(reach), int(u + 0.5), int(v + 0.5)
    rows, columns = last.shape
    for j in range(max(row - reach, 0) // cell, min((row + reach) // cell, rows - 1) + 1):
        for i in range(max(column - reach, 0) // cell, min((column + reach) // cell, columns - 1) + 1):
            number = last[j, i]
            while number > 0:
                du, dv = int(points[number - 1, 0] + 0.5) - column, int(points[number - 1, 1] + 0.5) - row
                if du * du + dv * dv <= reach * reach:
                    return True
                number = before[number - 1]
    return False


@inlined()
def _cell(reach: int) -> int:
    """Side of a cell in px: whatever is within `reach` of a place lies in four of them at most."""
    return 2 * reach + 1
