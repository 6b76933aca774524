"""Runs of line points split at kinks and jumps, so that each part lies on one smooth surface."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.stripes.runs import correlation_length
from core.model.arrays import Array, runs_of
from core.model.small_arrays import invert, mean_of, new_row, row_of, zero_table

# What counts as a break of a smooth line; also used where lines are joined. Held by
# tests/image/stripes/test_extraction.py (jump, kink, smooth curve): above speckle's roughness, below the smallest depth
# edges and kinks.
SIGNIFICANT = 6.0  # standard uncertainties
SMALLEST_JUMP_PX = 0.3  # across the line
SMALLEST_KINK = 0.06  # rad, 3.4°

_BREAK_GAP = 2.0  # filter σ on either side of a kink that the filter rounds
_BREAK_ARM = 8.0  # filter σ fitted on either side
_LEAST_ARM = 0.75  # share of that length which a window must have: nearer to an end nothing is judged
_LEAST_POINTS = 8  # of a fit with five unknowns
_SUSPECT = 0.5  # of the misfit that the smallest significant break leaves: with less, no broken curve is fitted


def split_at_breaks(
    run: Array, whole: Array, usable: NDArray[np.bool_], filter_px: float, sigma_px: Array
) -> list[slice]:
    """Split a run (N, ≥ 4) into slices at sideways jumps and kinks, without the points that the filter rounds there.

    At every point a curve y = a + b·x + c·x² with a jump and a kink at that point is fitted to both sides, up to 8
    filter σ away and leaving out the nearest 2. The run is broken where jump or kink is large and significant, given
    the points' standard uncertainties `sigma_px` (N,). Only `usable` points (N,) are judged; `whole` (N,) is the length
    along the run up to each point.
    """
    judged, arc = run, whole
    if not usable.all():
        judged, arc, sigma_px = run[usable], whole[usable], sigma_px[usable]
    gap, arm = _BREAK_GAP * filter_px, _BREAK_ARM * filter_px
    score, misfit = _break_scores(judged, arc, sigma_px, gap, arm, correlation_length(filter_px))
    parts, start, broken = [], 0, score > 1
    for first, last in runs_of(broken) if broken.any() else ():
        # a fit beside the break is spoilt by it too: the break is where the broken curve fits best
        at = float(arc[first + int(np.argmin(misfit[first:last]))])
        parts.append(slice(start, int(np.searchsorted(whole, at - gap))))
        start = int(np.searchsorted(whole, at + gap))
    parts.append(slice(start, len(run)))
    return [part for part in parts if part.stop - part.start > 1]


@compiled()
def _break_scores(
    run: Array, arc: Array, sigma: Array, gap: float, arm: float, correlation: float
) -> tuple[Array, Array]:
    """Jump or kink over the largest allowed (1 = the limit), and the misfit of the broken curve, (N,) each."""
    count = len(run)
    score, misfit, row = row_of(count, 0.0), row_of(count, math.inf), new_row(5)
    normal, inverse, rhs, solution = zero_table(5, 5), zero_table(5, 5), new_row(5), new_row(5)
    left, right = 0, 0
    stride = max(1, round(gap / 4))
    smooth = _smooth_misfit(run, arc, gap, arm, stride)
    for i in range(0, count, stride):
        # a break that counts explains at least so much: where all is less, there is none
        if smooth[i] < _SUSPECT * SIGNIFICANT**2 * sigma[i] ** 2 * correlation:
            continue
        while arc[i] - arc[left] > arm:
            left += 1
        while right + 1 < count and arc[right + 1] - arc[i] <= arm:
            right += 1
        if arc[i] - arc[left] < _LEAST_ARM * arm or arc[right] - arc[i] < _LEAST_ARM * arm:
            continue
        tu, tv = run[right, 0] - run[left, 0], run[right, 1] - run[left, 1]
        length = math.hypot(tu, tv)
        tu, tv = tu / length, tv / length
        square, used = 0.0, 0
        for a in range(5):
            rhs[a] = solution[a] = 0.0
            for b in range(5):
                normal[a, b] = 1e-9 if a == b else 0.0
        for k in range(left, right + 1):
            du, dv = run[k, 0] - run[i, 0], run[k, 1] - run[i, 1]
            x, y = du * tu + dv * tv, dv * tu - du * tv
            if abs(arc[k] - arc[i]) < gap:
                continue
            side = 0.5 if k > i else -0.5
            row[0], row[1], row[2], row[3], row[4] = 1.0, x, x * x / arm, side, side * x
            for a in range(5):
                rhs[a] += row[a] * y
                for b in range(5):
                    normal[a, b] += row[a] * row[b]
            square += y * y
            used += 1
        if used < _LEAST_POINTS:
            continue
        invert(normal, inverse, 5)
        for a in range(5):
            for b in range(5):
                solution[a] += inverse[a, b] * rhs[b]
            square -= solution[a] * rhs[a]
        scatter = sigma[i] * math.sqrt(correlation)
        jump = max(SIGNIFICANT * scatter * math.sqrt(inverse[3, 3]), SMALLEST_JUMP_PX)
        kink = max(SIGNIFICANT * scatter * math.sqrt(inverse[4, 4]), SMALLEST_KINK)
        for k in range(i, min(i + stride, count)):
            score[k], misfit[k] = max(abs(solution[3]) / jump, abs(solution[4]) / kink), square / used
    return score, misfit


@inlined()
def _smooth_misfit(run: Array, arc: Array, gap: float, arm: float, stride: int) -> Array:
    """Sum of squares (N,) in px² that parabolas u(s), v(s) leave over what a broken curve is fitted to.

    Known at every `stride`-th point; 0 where a window is cut short. Running sums make the cost independent of `arm`.
    """
    count = len(run)
    misfit = row_of(count, 0.0)
    sums = zero_table(count + 1, 13)  # Σ x⁰…⁴, Σ x⁰…² u, Σ x⁰…² v, Σ u², Σ v²
    middle, centre_u, centre_v = 0.5 * (arc[0] + arc[-1]), mean_of(run, 0), mean_of(run, 1)
    for k in range(count):
        x, u, v = (arc[k] - middle) / arm, run[k, 0] - centre_u, run[k, 1] - centre_v
        power = 1.0
        for a in range(5):
            sums[k + 1, a] = sums[k, a] + power
            if a < 3:
                sums[k + 1, 5 + a] = sums[k, 5 + a] + power * u
                sums[k + 1, 8 + a] = sums[k, 8 + a] + power * v
            power *= x
        sums[k + 1, 11], sums[k + 1, 12] = sums[k, 11] + u * u, sums[k, 12] + v * v
    window = new_row(13)
    left, before, after, right = 0, 0, 0, 0
    for i in range(0, count, stride):
        while arc[i] - arc[left] > arm:
            left += 1
        while arc[i] - arc[before] >= gap:
            before += 1
        while after < count and arc[after] - arc[i] < gap:
            after += 1
        while right < count and arc[right] - arc[i] <= arm:
            right += 1
        for a in range(13):
            window[a] = sums[right, a] - sums[after, a] + sums[before, a] - sums[left, a]
        misfit[i] = _left_over(window, (arc[i] - middle) / arm, run[i, 0] - centre_u, run[i, 1] - centre_v)
    return misfit


@inlined()
def _left_over(m: Array, x: float, u: float, v: float) -> float:
    """Sum of squares that parabolas leave of a window's sums `m` (13,), moved to the origin (x, u, v)."""
    s0 = m[0]
    s1 = m[1] - x * m[0]
    s2 = m[2] - x * (2 * m[1] - x * m[0])
    s3 = m[3] - x * (3 * m[2] - x * (3 * m[1] - x * m[0]))
    s4 = m[4] - x * (4 * m[3] - x * (6 * m[2] - x * (4 * m[1] - x * m[0])))
    c00, c01, c02 = s2 * s4 - s3 * s3, s2 * s3 - s1 * s4, s1 * s3 - s2 * s2
    c11, c12, c22 = s0 * s4 - s2 * s2, s1 * s2 - s0 * s3, s0 * s2 - s1 * s1
    determinant = s0 * c00 + s1 * c01 + s2 * c02
    if determinant <= 1e-9 * s0**3:
        return math.inf
    total = 0.0
    for axis in range(2):
        at = u if axis == 0 else v
        t0, t1, t2 = m[5 + 3 * axis], m[6 + 3 * axis], m[7 + 3 * axis]
        t2 -= x * (2 * t1 - x * t0)
        t1 -= x * t0
        square = m[11 + axis] - at * (2 * t0 - at * s0)
        t0, t1, t2 = t0 - at * s0, t1 - at * s1, t2 - at * s2
        a, b, c = c00 * t0 + c01 * t1 + c02 * t2, c01 * t0 + c11 * t1 + c12 * t2, c02 * t0 + c12 * t1 + c22 * t2
        total += square - (a * t0 + b * t1 + c * t2) / determinant
    return total
