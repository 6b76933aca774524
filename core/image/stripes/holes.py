"""Holes in a line: what a centreline may go on across, and where it ends.

A stripe is not seen on dark grains, on saturated pixels and where another stripe crosses it. A line goes on behind a
hole no longer than the tracer holds on over dark grains, and behind a longer one that is saturated or where another
line crosses it. Elsewhere it ends: what lies behind is another line, whatever drew both. It ends too where points do
not follow each other along it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.stripes.joining import crosses
from core.image.stripes.tracing.linking import HOLD
from core.image.stripes.tracing.pixel_state import SATURATED
from core.model.arrays import Array

_ROUNDING_PX = 3.0
"""Px between the ends of a hole beyond its length: the tracer's steps on either side."""


def longest_hole_px(filter_px: float) -> float:
    """Longest distance in px between neighbouring points of one line, where nothing hides it."""
    return HOLD * filter_px + _ROUNDING_PX


def unbroken_parts(
    run: Array, keep: NDArray[np.bool_], filter_px: float, state: NDArray[np.uint8], others: Sequence[Array]
) -> list[NDArray[np.intp]]:
    """Indices of the points of a run (N, ≥ 4) that are to be kept, those of each unbroken part in an array of its own.

    `state` (H, W) are the bits of the picture's pixels, `others` (M, ≥ 2) its other lines.
    """
    kept = np.flatnonzero(keep)
    longest = longest_hole_px(filter_px)
    ends = _suspects(run, kept, longest)
    broken = [end for end in ends.tolist() if not _is_hidden(run[kept[end - 1 : end + 1]], state, others)]
    return np.split(kept, broken) if broken else [kept]


def _is_hidden(ends: Array, state: NDArray[np.uint8], others: Sequence[Array]) -> bool:
    """Whether saturated pixels or another line hide what is between the points `ends` (2, ≥ 4) of one line."""
    if not _follow(ends[0], ends[1]):
        return False
    share = np.linspace(0, 1, math.ceil(math.dist(ends[0, :2], ends[1, :2])))[:, None]
    u, v = np.round(ends[0, :2] + share * (ends[1, :2] - ends[0, :2])).astype(np.intp).T
    saturated = int(np.count_nonzero(state[v, u] & SATURATED))
    return 2 * saturated > len(u) or any(crosses(ends, other, math.inf) for other in others if len(other) > 1)


@njit(cache=True, nogil=True, error_model="numpy")
def _suspects(run: Array, kept: NDArray[np.intp], longest: float) -> NDArray[np.intp]:
    """Positions in `kept` of the points that do not follow the one before them along the line, or not near enough."""
    found = np.empty(len(kept), dtype=np.intp)
    count = 0
    for k in range(1, len(kept)):
        before, here = run[kept[k - 1]], run[kept[k]]
        du, dv = here[0] - before[0], here[1] - before[1]
        if du * du + dv * dv > longest * longest or not _follow(before, here):
            found[count] = k
            count += 1
    return found[:count]


@njit(cache=True, nogil=True, error_model="numpy")
def _follow(before: Array, here: Array) -> bool:
    """Whether a point (≥ 4,) lies ahead of the one before it, rather than beside or behind it."""
    du, dv = here[0] - before[0], here[1] - before[1]
    nu, nv = before[2] + here[2], before[3] + here[3]
    return bool(du * -nv + dv * nu > abs(du * nu + dv * nv))
