"""Linking: from a coarse look at the whole picture to ordered runs of line points.

Steger links the line points of a filtered picture, strongest first, each to the neighbour that lies ahead on its
tangent. Here the points are only computed where the tangent leads, so the filter runs over the stripe and not over
the picture. Hysteresis: a run starts above a high and continues above a low threshold; it holds on through dark
speckle grains, and longer through saturated pixels, straight ahead.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930, §4.1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.filling import filled, points_apart
from core.image.marks import IGNORED, SATURATED
from core.image.passed import Passed, nothing_passed, put_down, room_for, was_passed
from core.image.ridge import LANES, Detector, kernel_radius, kernel_table, ridge_at, ridge_response
from core.image.seeds import Picture, seeds
from core.model.arrays import Array

_MARK_EVERY = 2  # points: discs much larger than that leave no gap between them
_LONGEST_STEP = 2  # px: longer ones lose short, saturated pieces of photographed stripes at their ends
_NEAR_ENOUGH = 0.08  # filter σ from the crest: seen from there, Taylor's step errs by less than 0.0005 px
_LARGEST_TURN = math.cos(math.radians(30))  # from one point to the next


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """Thresholds as heights of a stripe in grey levels, and how far a run goes on without seeing it, in px.

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
    """Runs of line points, each (N, 5): u, v, n_u, n_v, response; one px apart along the tangent (−n_v, n_u).

    The response is the second derivative across the stripe with its sign reversed. `state` (H, W) holds the bits
    SATURATED and IGNORED.
    """
    radius = kernel_radius(filter_px)
    if min(picture.shape) <= 2 * radius + 3:
        return []
    unit = ridge_response(1.0, stripe_px, filter_px)
    stride = min(points_apart(filter_px), _LONGEST_STEP)
    flat: Any = np.ascontiguousarray(picture).reshape(-1)  # float32 or int16
    if picture.shape[1] < LANES:
        flat = np.append(flat, np.zeros(LANES, flat.dtype))
    points, ends = _trace_all(
        flat,
        state,
        seeds(picture, stripe_px, filter_px, limits.high, limits.noise_grey),
        kernel_table(filter_px),
        (filter_px, unit * limits.high, unit * limits.low, limits.hold_px, limits.saturated_hold_px, float(stride)),
        radius,
        math.ceil(2 * stripe_px + 1),
    )
    runs = np.split(points, ends[:-1]) if len(ends) else []
    return [filled(run, stride) for run in runs] if stride > 1 else runs


@njit(cache=True, nogil=True, error_model="numpy", fastmath=True)
def _trace_all(
    picture: Picture,
    state: NDArray[np.uint8],
    starts: Array,
    kernels: NDArray[np.float32],
    limits: tuple[float, float, float, float, float, float],
    radius: int,
    reach: int,
) -> tuple[Array, NDArray[np.int64]]:
    """Trace both ways from every seed that no run has passed yet; all points and where each run ends."""
    height, width = state.shape
    high, stride = limits[1], limits[5]
    ahead = np.empty((4 * (height + width), 5))
    behind = np.empty_like(ahead)
    points, passed = np.empty((16384, 5)), nothing_passed((height, width), reach, 16384)
    ends, detector = np.empty(64, dtype=np.int64), Detector(radius, kernels, np.empty(3 * LANES, dtype=np.float32))
    count, runs = 0, 0
    for k in range(len(starts)):
        u, v = starts[k, 0], starts[k, 1]
        found = False
        response, nu, nv = 0.0, 1.0, 0.0
        for _ in range(6):  # the coarse look is a block or two beside the crest
            if not _inside(u, v, width, height, radius):
                found = False
                break
            if state[int(v + 0.5), int(u + 0.5)] & IGNORED or was_passed(passed, points, u, v, reach):
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
        so_far = (points, passed, reach)
        backwards = _follow(picture, state, so_far, (u, v, -nu, -nv), limits, detector, behind)
        last = max(backwards - 1, 0)
        closed = backwards > 20 and math.hypot(behind[last, 0] - u, behind[last, 1] - v) < 1.5 * stride
        forwards = 0 if closed else _follow(picture, state, so_far, (u, v, nu, nv), limits, detector, ahead)
        needed = backwards + 1 + forwards
        if len(points) < count + needed:
            more = np.empty((2 * (count + needed), 5))
            more[:count] = points[:count]
            points, passed = more, room_for(passed, len(more))
        run = points[count : count + needed]
        for i in range(backwards):
            for a in range(5):
                run[i, a] = behind[backwards - 1 - i, a] if a not in (2, 3) else -behind[backwards - 1 - i, a]
        run[backwards, 0], run[backwards, 1], run[backwards, 2], run[backwards, 3] = u, v, nu, nv
        run[backwards, 4] = response
        run[backwards + 1 :] = ahead[:forwards]
        for i in range(0, needed + _MARK_EVERY - 1, _MARK_EVERY):
            put_down(passed, points, count + min(i, needed - 1), reach)
        count += needed
        if runs == len(ends):
            ends = np.concatenate((ends, np.empty_like(ends)))
        ends[runs] = count
        runs += 1
    return points[:count], ends[:runs]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=True)
def _inside(u: float, v: float, width: int, height: int, radius: int) -> bool:
    margin = radius + 0.5
    return margin < u < width - 1 - margin and margin < v < height - 1 - margin


@njit(cache=True, nogil=True, error_model="numpy", fastmath=True)
def _follow(
    picture: Picture,
    state: NDArray[np.uint8],
    so_far: tuple[Array, Passed, int],
    start: tuple[float, float, float, float],
    limits: tuple[float, float, float, float, float, float],
    detector: Detector,
    out: Array,
) -> int:
    """Points ahead of `start` (u, v, n_u, n_v) along its tangent, written to `out`; their number.

    `so_far` are the points of other runs, where they are (see `core.image.passed`), and how near to them none may come.
    """
    height, width = state.shape
    points, passed, reach = so_far
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
        if here & IGNORED or was_passed(passed, points, u, v, reach):
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
