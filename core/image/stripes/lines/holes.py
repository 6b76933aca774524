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
from numpy.typing import NDArray

from core.compiled import compiled
from core.image.stripes.lines.joining import crosses
from core.image.stripes.tracing.linking import HOLD
from core.image.stripes.tracing.pixel_state import SATURATED
from core.model.arrays import Array

_ROUNDING_PX = 3.0
"""Px between the ends of a hole beyond its length: the tracer's steps on either side."""


def longest_hole_px(filter_px: float) -> float:
    """Compute the distance in px up to which neighbouring points count as one line without a hole."""
    return HOLD * filter_px + _ROUNDING_PX


def unbroken_parts(
    lines: Sequence[Array], keep: Sequence[NDArray[np.bool_]], own: int, filter_px: float, state: NDArray[np.uint8]
) -> list[NDArray[np.intp] | slice]:
    """Select the points of line `own` that `keep` has, one array or slice for each part without a hole.

    `lines` are the runs (N, ≥ 4) of all lines of the picture, `keep` (N,) which of their points are to be kept; the
    others may cross this one. `state` (H, W) are the bits of the picture's pixels. What hides a line makes no hole.
    """
    run, kept = lines[own], np.flatnonzero(keep[own])
    ends = _suspects(run, kept, longest_hole_px(filter_px))
    if not len(ends):
        return [slice(None) if len(kept) == len(run) else kept]
    others = [line[at] for k, (line, at) in enumerate(zip(lines, keep, strict=True)) if k != own]
    broken = [end for end in ends.tolist() if not _is_hidden(run[kept[end - 1 : end + 1]], state, others)]
    return [*np.split(kept, broken)]


def _is_hidden(ends: Array, state: NDArray[np.uint8], others: Sequence[Array]) -> bool:
    """Whether saturated pixels or another line hide what is between the points `ends` (2, ≥ 4) of one line."""
    (du, dv), (nu, nv) = ends[1, :2] - ends[0, :2], ends[0, 2:4] + ends[1, 2:4]
    if dv * nu - du * nv <= abs(du * nu + dv * nv):  # beside or behind
        return False
    share = np.linspace(0, 1, math.ceil(math.dist(ends[0, :2], ends[1, :2])))[:, None]
    u, v = np.round(ends[0, :2] + share * (ends[1, :2] - ends[0, :2])).astype(np.intp).T
    saturated = int(np.count_nonzero(state[v, u] & SATURATED))
    return 2 * saturated > len(u) or any(crosses(ends, other, math.inf) for other in others if len(other) > 1)


@compiled()
def _suspects(run: Array, kept: NDArray[np.intp], longest: float) -> NDArray[np.intp]:
    """Positions in `kept` of the points that do not follow the one before them along the line, or not near enough."""
    found = np.empty(len(kept), dtype=np.intp)
    count = 0
    for k in range(1, len(kept)):
        a, b = kept[k - 1], kept[k]
        du, dv = run[b, 0] - run[a, 0], run[b, 1] - run[a, 1]
        nu, nv = run[a, 2] + run[b, 2], run[a, 3] + run[b, 3]
        if du * du + dv * dv > longest * longest or dv * nu - du * nv <= abs(du * nu + dv * nv):
            found[count] = k
            count += 1
    return found[:count]
