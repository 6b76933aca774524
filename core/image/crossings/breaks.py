"""Kinks and jumps of a line, which no local fit may cross.

Extraction cuts a stripe at the kinks and jumps that a few points show. Seen over a hundred pixels much smaller ones
matter, and they are looked for here, bin by bin: first by least squares, with and without a jump and a kink in a
parabola on either side, which is quick; and where that finds one, by the likelihoods of two lines and of one, of any
curvature (`core.image.crossings.kriging`), so that a bend is not taken for a kink.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.crossings.kriging import log_odds_of_break
from core.image.crossings.line_bins import ARC, INFORMATION, U, V, in_frame
from core.model.arrays import Array
from core.model.small_arrays import first_rows, invert, new_flags, new_row, new_table, row_of, zero_table

# All in bins, about 8 px long. Held by tests/image/crossings/test_crossing_bound.py (ridge of a roof, step) on roofs
# and steps of several sizes.
_ARMS = (4, 10)
"""Fitted on either side by least squares: a short arm for sharp breaks, a long one for slight ones."""
_LEAST_BINS = 3
"""On either side of a break that can be judged."""
_NEIGHBOURS = 4
"""On either side: of suspects so near to each other only the likeliest is one."""
_SUSPECT = 16.0
"""χ² that a jump and a kink must explain, both together, before the likelihoods are compared."""
_PRIOR = math.log(1 / 50 / (0.6 * 0.15))
"""Log of: a break in one bin of 50, jump and kink spread over 0.6 px and 0.15 rad. Larger ones are cut before."""


@compiled()
def breaks(bins: Array, reach: float) -> NDArray[np.bool_]:
    """Flag those `bins` (B, 5) of a line that have a kink or a jump, judged within ± `reach` px: (B,) True there."""
    count = len(bins)
    broken, suspected = new_flags(count), new_flags(count)
    best = row_of(count, math.inf)  # misfit of the broken curve where a break explains much
    for at in range(_LEAST_BINS, count - _LEAST_BINS):
        for arm in _ARMS:
            explained, misfit = _explained(bins, at, arm, reach)
            if explained > _SUSPECT:
                best[at] = min(best[at], misfit)
    while True:
        at = -1  # the likeliest suspect that was not looked at yet
        for k in range(count):
            if not suspected[k] and best[k] < (best[at] if at >= 0 else math.inf):
                at = k
        if at < 0:
            return broken
        suspected[at] = True
        # a fit beside the break is spoilt by it too: the break is where the broken curve fits best
        likeliest = True
        for k in range(max(_LEAST_BINS, at - _NEIGHBOURS), min(count - _LEAST_BINS, at + _NEIGHBOURS + 1)):
            likeliest &= best[at] <= best[k]
        for k in range(max(0, at - _LEAST_BINS), min(count, at + _LEAST_BINS + 1)):
            likeliest &= not broken[k]
        if not likeliest:
            continue
        for place in range(max(_LEAST_BINS, at - 1), min(count - _LEAST_BINS, at + 2)):
            broken[at] |= _is_break(bins, place, broken, reach)


@inlined()
def _is_break(bins: Array, at: int, broken: NDArray[np.bool_], reach: float) -> bool:
    first, last = at, at
    while first > 0 and not broken[first - 1] and bins[at, ARC] - bins[first - 1, ARC] <= reach:
        first -= 1
    while last + 1 < len(bins) and not broken[last + 1] and bins[last + 1, ARC] - bins[at, ARC] <= reach:
        last += 1
    frame = _frame(bins, first, last, at)
    left = in_frame(bins, at - 1, first - 1, -1, frame)
    right = in_frame(bins, at + 1, last + 1, 1, frame)
    left, right = left[: _outwards(left, -1.0)], right[: _outwards(right, 1.0)]
    if min(len(left), len(right)) < _LEAST_BINS:
        return False
    widest = max(right[-1, 0], -left[-1, 0])
    return bool(log_odds_of_break(right, left, widest) + _PRIOR - math.log(widest) > 0)


@inlined()
def _outwards(bins: Array, side: float) -> int:
    """How many of the first bins (N, 4) of a `side` (1 or −1) go outwards from 0 on: beyond, the line turns back."""
    before = 0.0
    for k in range(len(bins)):
        if side * bins[k, 0] <= before:
            return k
        before = side * bins[k, 0]
    return len(bins)


@inlined()
def _frame(bins: Array, first: int, last: int, at: int) -> tuple[float, float, float, float]:
    first, last = max(first, at - _LEAST_BINS), min(last, at + _LEAST_BINS)
    tu, tv = bins[last, U] - bins[first, U], bins[last, V] - bins[first, V]
    length = math.hypot(tu, tv)
    return bins[at, U], bins[at, V], tu / length, tv / length


@inlined()
def _explained(bins: Array, at: int, arm: int, reach: float) -> tuple[float, float]:
    """χ² that a jump and a kink in bin `at` take off a parabola over ± `arm` bins, and χ² per bin that is left.

    Nothing where too few of the bins are within `reach` on either side, as beside a long saturated stretch.
    """
    first, last = max(0, at - arm), min(len(bins) - 1, at + arm)
    frame = _frame(bins, first, last, at)
    normal, rhs, row = zero_table(5, 5), row_of(5, 0.0), new_row(5)
    square, used, before = 0.0, 0, 0
    for k in range(first, last + 1):
        if k == at or abs(bins[k, ARC] - bins[at, ARC]) > reach:
            continue
        du, dv = bins[k, U] - frame[0], bins[k, V] - frame[1]
        x, y = (du * frame[2] + dv * frame[3]) / reach, dv * frame[2] - du * frame[3]
        side = 0.5 if k > at else -0.5
        row[0], row[1], row[2], row[3], row[4] = 1.0, x, x * x, side, side * x
        square += bins[k, INFORMATION] * y * y
        used += 1
        before += k < at
        for i in range(5):
            rhs[i] += bins[k, INFORMATION] * row[i] * y
            for j in range(5):
                normal[i, j] += bins[k, INFORMATION] * row[i] * row[j]
    if min(before, used - before) < _LEAST_BINS:
        return 0.0, math.inf
    for i in range(5):
        normal[i, i] *= 1 + 1e-9
    by_curve, by_both = _taken_off(normal, rhs, 3), _taken_off(normal, rhs, 5)
    return by_both - by_curve, (square - by_both) / max(1, used - 5)


@inlined()
def _taken_off(normal: Array, rhs: Array, size: int) -> float:
    """What the first `size` unknowns of a least-squares problem take off the sum of squares."""
    inverse, total = new_table(size, size), 0.0
    invert(first_rows(normal, size), inverse, size)
    for i in range(size):
        for k in range(size):
            total += rhs[i] * inverse[i, k] * rhs[k]
    return total
