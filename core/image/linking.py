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

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.ridge import kernel_radius, ridge_at, ridge_response
from core.model.arrays import Array

SATURATED, IGNORED, VISITED = 1, 2, 4
"""Bits of the picture's state map."""

_COARSE_BLUR = 1.0  # blocks
_COARSE_SHARE = 0.55  # a crest between two blocks keeps at least this share of its response
_LARGEST_TURN = math.cos(math.radians(30))  # from one point to the next


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """Thresholds as heights of a stripe in grey levels, and how far a run goes on without seeing it, in px."""

    high: float
    low: float
    hold_px: float
    saturated_hold_px: float


def link(
    picture: NDArray[np.float32], state: NDArray[np.uint8], stripe_px: float, filter_px: float, limits: Hysteresis
) -> list[Array]:
    """Runs of line points, each (N, 5): u, v, n_u, n_v, response; one px apart along the tangent (−n_v, n_u).

    The response is the second derivative across the stripe with its sign reversed. `state` (H, W) holds the bits
    SATURATED and IGNORED and is marked VISITED along what was found.
    """
    radius = kernel_radius(filter_px)
    if min(picture.shape) <= 2 * radius + 3:
        return []
    seeds = _seeds(picture, stripe_px, limits.high)
    unit = ridge_response(1.0, stripe_px, filter_px)
    points, ends = _trace_all(
        picture,
        state,
        seeds,
        (filter_px, unit * limits.high, unit * limits.low, limits.hold_px, limits.saturated_hold_px),
        radius,
        math.ceil(2 * stripe_px + 1),
    )
    return np.split(points, ends[:-1]) if len(ends) else []


def _seeds(picture: NDArray[np.float32], stripe_px: float, high: float) -> Array:
    """Places (K, 2) in pixels worth a closer look, strongest first: crests of the picture averaged over blocks."""
    block = max(1, round(stripe_px))
    expected = ridge_response(high, stripe_px / block, math.hypot(_COARSE_BLUR, 12**-0.5))
    found = coarse_crests(picture, block, _COARSE_SHARE * expected)
    order = np.argsort(-found[:, 2], kind="stable")
    places: Array = (found[order, :2] + 0.5) * block - 0.5
    return places


def coarse_crests(picture: NDArray[np.float32], block: int, threshold: float) -> Array:
    """Crests of the picture averaged over blocks of `block` px and blurred by one: (K, 3) column, row, response."""
    height, width = (size // block for size in picture.shape)
    whole = picture[: height * block, : width * block]
    blocks = np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), dtype=np.float32)
    blocks = np.asarray(cv2.GaussianBlur(blocks, (0, 0), _COARSE_BLUR), dtype=np.float32)
    crests: Array = _crests(blocks, np.float32(threshold))
    return crests


@njit(cache=True, nogil=True, fastmath=True)
def _crests(blocks: NDArray[np.float32], threshold: np.float32) -> Array:
    """Blocks that are a ridge stronger than `threshold` and a maximum across it: (K, 3) column, row, response."""
    height, width = blocks.shape
    found = np.empty((1024, 3))
    count = 0
    for j in range(1, height - 1):
        for i in range(1, width - 1):
            here = blocks[j, i]
            uu = blocks[j, i - 1] + blocks[j, i + 1] - 2 * here
            vv = blocks[j - 1, i] + blocks[j + 1, i] - 2 * here
            if uu + vv > -threshold:
                continue
            uv = 0.25 * (blocks[j - 1, i - 1] + blocks[j + 1, i + 1] - blocks[j - 1, i + 1] - blocks[j + 1, i - 1])
            half = 0.5 * (uu - vv)
            response = math.sqrt(half * half + uv * uv) - 0.5 * (uu + vv)
            if response < threshold:
                continue
            if uu < vv:  # the line is closer to upright
                if blocks[j, i - 1] > here or blocks[j, i + 1] > here:
                    continue
            elif blocks[j - 1, i] > here or blocks[j + 1, i] > here:
                continue
            if count == len(found):
                found = np.concatenate((found, np.empty_like(found)))
            found[count, 0] = i
            found[count, 1] = j
            found[count, 2] = response
            count += 1
    return found[:count]


@njit(cache=True, nogil=True, fastmath=True)
def _trace_all(
    picture: NDArray[np.float32],
    state: NDArray[np.uint8],
    seeds: Array,
    limits: tuple[float, float, float, float, float],
    radius: int,
    reach: int,
) -> tuple[Array, NDArray[np.int64]]:
    """Trace both ways from every seed that no run has passed yet; all points and where each run ends."""
    height, width = picture.shape
    filter_px, high = limits[0], limits[1]
    kernels = np.empty((2, 3, 2 * radius + 1))
    ahead = np.empty((4 * (height + width), 5))
    points = np.empty((4096, 5))
    ends = np.empty(64, dtype=np.int64)
    count, runs = 0, 0
    for k in range(len(seeds)):
        u, v = seeds[k, 0], seeds[k, 1]
        found = False
        response, nu, nv = 0.0, 1.0, 0.0
        for _ in range(6):  # the coarse look is a block or two beside the crest
            if not _inside(u, v, width, height, radius):
                found = False
                break
            if state[int(v + 0.5), int(u + 0.5)] & (IGNORED | VISITED):
                found = False
                break
            across, nu, nv, offset = ridge_at(picture, u, v, filter_px, radius, kernels)
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
        needed = 0
        while len(points) < count + 2 * len(ahead) + 1:
            points = np.concatenate((points, np.empty_like(points)))
        backwards = _follow(picture, state, (u, v, -nu, -nv), limits, radius, kernels, ahead)
        for i in range(backwards):
            row = points[count + needed]
            row[:] = ahead[backwards - 1 - i]
            row[2] = -row[2]
            row[3] = -row[3]
            needed += 1
        points[count + needed] = np.array([u, v, nu, nv, response])
        needed += 1
        closed = backwards > 20 and math.hypot(points[count, 0] - u, points[count, 1] - v) < 1.5
        if not closed:
            forwards = _follow(picture, state, (u, v, nu, nv), limits, radius, kernels, ahead)
            for i in range(forwards):
                points[count + needed] = ahead[i]
                needed += 1
        for i in range(needed):
            _mark(state, points[count + i, 0], points[count + i, 1], reach)
        count += needed
        if runs == len(ends):
            ends = np.concatenate((ends, np.empty_like(ends)))
        ends[runs] = count
        runs += 1
    return points[:count].copy(), ends[:runs].copy()


@njit(cache=True, nogil=True, fastmath=True)
def _inside(u: float, v: float, width: int, height: int, radius: int) -> bool:
    margin = radius + 0.5
    return margin < u < width - 1 - margin and margin < v < height - 1 - margin


@njit(cache=True, nogil=True, fastmath=True)
def _follow(
    picture: NDArray[np.float32],
    state: NDArray[np.uint8],
    start: tuple[float, float, float, float],
    limits: tuple[float, float, float, float, float],
    radius: int,
    kernels: Array,
    out: Array,
) -> int:
    """Points ahead of `start` (u, v, n_u, n_v) along its tangent, written to `out`; their number."""
    height, width = picture.shape
    filter_px, _, low, hold, saturated_hold = limits
    u, v = start[0], start[1]
    tu, tv = -start[3], start[2]
    count, missed, blind = 0, 0, 0
    while count < len(out):
        u += tu
        v += tv
        if not _inside(u, v, width, height, radius):
            break
        here = state[int(v + 0.5), int(u + 0.5)]
        if here & (IGNORED | VISITED):
            break
        across, nu, nv, offset = ridge_at(picture, u, v, filter_px, radius, kernels)
        far = 0.5 + 0.05 * (missed + blind)  # straight ahead drifts off while nothing is seen
        if across < -low and abs(offset) <= far and abs(offset) > 0.1:
            moved = offset
            u2, v2 = u + moved * nu, v + moved * nv
            if not _inside(u2, v2, width, height, radius):
                break
            across, nu, nv, offset = ridge_at(picture, u2, v2, filter_px, radius, kernels)
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
            missed, blind = 0, 0
            if count > 20 and math.hypot(u - start[0], v - start[1]) < 1.0:
                break  # a closed curve
            continue
        if missed + blind == 0 and count > 2:
            # a chord is steadier than the last tangent; close to a saturated patch the line itself is bent
            bent = int(2.5 * filter_px) if here & SATURATED else 0
            last = max(count - 1 - bent, 1)
            first = max(last - int((4 if bent else 2) * filter_px) - 1, 0)
            tu, tv = out[last, 0] - out[first, 0], out[last, 1] - out[first, 1]
            length = math.hypot(tu, tv)
            tu, tv = tu / length, tv / length
            u, v = out[last, 0] + (count - last) * tu, out[last, 1] + (count - last) * tv
        if here & SATURATED:
            blind += 1
        else:
            missed += 1
        if missed > hold or blind > saturated_hold:
            break
    return count


@njit(cache=True, nogil=True)
def _mark(state: NDArray[np.uint8], u: float, v: float, reach: int) -> None:
    """Mark a disc VISITED."""
    height, width = state.shape
    column, row = int(u + 0.5), int(v + 0.5)
    for j in range(max(row - reach, 0), min(row + reach + 1, height)):
        for i in range(max(column - reach, 0), min(column + reach + 1, width)):
            if (i - u) ** 2 + (j - v) ** 2 <= reach * reach:
                state[j, i] |= VISITED
