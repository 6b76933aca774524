"""From runs of line points to pieces on one smooth surface: ends cut, kinks and jumps split.

Everything here works on the order of the points along the stripe; the picture is not looked at again.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.model.arrays import Array

END_TRIM_PX = 4.0
"""Left out at the ends of a stripe, at least: the filter sees only half of it there."""
_END_TRIM = 2.5  # the same in filter σ
_FADE_REACH = 20.0  # filter σ from an end that a fading shadow is looked for
_FADED = 0.8  # less than this share of what is further in
_BREAK_GAP = 2.0  # filter σ on either side of a kink that its rounding reaches
_BREAK_ARM = 8.0  # filter σ looked at on either side
_SIGNIFICANT = 6.0  # standard uncertainties
_SMALLEST_JUMP = 0.3  # px
_SMALLEST_KINK = 0.06  # rad
NEIGHBOUR = 3.5
"""Lines nearer than this many filtered widths √(s² + g²) pull each other by more than 0.003 px."""


def arc_length(run: Array) -> Array:
    """Length along a run (N, ≥ 2) up to each point, in pixels."""
    steps = np.diff(run[:, :2], axis=0)
    return np.append(0.0, np.cumsum(np.hypot(steps[:, 0], steps[:, 1])))


def correlation_length(filter_px: float) -> float:
    """Length along the stripe over which the noise of its points is one and the same, 2√π·g, in pixels."""
    return 2 * math.sqrt(math.pi) * filter_px


def cut_ends(run: Array, filter_px: float) -> Array:
    """Cut a run (N, 5) where its response falls to half at an end, and END_TRIM_PX more."""
    arc = arc_length(run)
    trim = max(END_TRIM_PX, _END_TRIM * filter_px)
    start = _real_end(arc, run[:, 4], filter_px) + trim
    end = float(arc[-1]) - _real_end(arc[-1] - arc[::-1], run[::-1, 4], filter_px) - trim
    inside: Array = run[(arc >= start) & (arc <= end)]
    return inside


def _real_end(arc: Array, response: Array, filter_px: float) -> float:
    """Where the response first reaches half of what it is further in."""
    inner = response[(arc >= 3 * filter_px) & (arc <= 9 * filter_px)]
    if len(inner) == 0:
        return 0.0
    return float(arc[np.argmax(response >= 0.5 * np.median(inner))])


def fully_lit(arc: Array, height: Array, width: Array, filter_px: float) -> slice:
    """The part of a run between its fading ends, from the height and width (N,) of its cross-section.

    An oblique shadow cuts the stripe on one side first and pulls the line to the other while its crest is still as
    bright as before. What gives it away is height · width², which speckle hardly changes: its grains make the stripe
    dimmer and wider, or brighter and narrower.
    """
    spread = height * width**2
    first = _fading(arc, spread, filter_px)
    last = len(arc) - _fading(arc[-1] - arc[::-1], spread[::-1], filter_px)
    return slice(first, max(first, last))


def _fading(arc: Array, spread: Array, filter_px: float) -> int:
    """How many points at the start have less light than the stretch behind them."""
    reach = min(_FADE_REACH * filter_px, 0.2 * float(arc[-1]))
    inner = spread[(arc >= reach) & (arc <= 2.5 * reach)]
    if len(inner) == 0:
        return 0
    return int(np.argmax((spread >= _FADED * np.median(inner)) | (arc >= reach)))


def split_at_breaks(run: Array, usable: NDArray[np.bool_], filter_px: float, sigma_px: Array) -> list[slice]:
    """Parts of a run (N, ≥ 4) between jumps sideways and kinks, leaving out what the filter rounds there.

    At every point a curve y = a + b·x + c·x² with a jump and a kink at that point is fitted to both sides, up to 8
    filter σ away and leaving out the nearest 2. The run is broken where jump or kink is large and significant, given
    the points' standard uncertainties `sigma_px` (N,). Only `usable` points (N,) are judged.
    """
    whole = arc_length(run)
    arc = whole[usable]
    gap, arm = _BREAK_GAP * filter_px, _BREAK_ARM * filter_px
    score, misfit = _break_scores(run[usable, :4], arc, sigma_px[usable], gap, arm, correlation_length(filter_px))
    parts, start = [], 0
    for first, last in _stretches(score > 1):
        # a fit beside the break is spoilt by it too: the break is where the broken curve fits best
        at = float(arc[first + int(np.argmin(misfit[first:last]))])
        parts.append(slice(start, int(np.searchsorted(whole, at - gap))))
        start = int(np.searchsorted(whole, at + gap))
    parts.append(slice(start, len(run)))
    return [part for part in parts if part.stop - part.start > 1]


def _stretches(flags: NDArray[np.bool_]) -> NDArray[np.int64]:
    """First and past-the-last index (K, 2) of each unbroken stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return edges.reshape(-1, 2)


@njit(cache=True, nogil=True)
def _break_scores(
    run: Array, arc: Array, sigma: Array, gap: float, arm: float, correlation: float
) -> tuple[Array, Array]:
    """How far jump or kink exceed what is allowed (1 = the limit), and the misfit of the broken curve, (N,) each."""
    count = len(run)
    score = np.zeros(count)
    misfit = np.full(count, np.inf)
    row = np.empty(5)
    left, right = 0, 0
    stride = max(1, round(gap / 4))
    for i in range(0, count, stride):
        while arc[i] - arc[left] > arm:
            left += 1
        while right + 1 < count and arc[right + 1] - arc[i] <= arm:
            right += 1
        if arc[i] - arc[left] < 0.75 * arm or arc[right] - arc[i] < 0.75 * arm:
            continue
        tu, tv = run[right, 0] - run[left, 0], run[right, 1] - run[left, 1]
        length = math.hypot(tu, tv)
        tu, tv = tu / length, tv / length
        normal = np.zeros((5, 5))
        rhs = np.zeros(5)
        square, used = 0.0, 0
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
        if used < 8:
            continue
        inverse = np.linalg.inv(normal + 1e-9 * np.eye(5))
        solution = inverse @ rhs
        misfit[i] = (square - np.sum(solution * rhs)) / used
        scatter = sigma[i] * math.sqrt(correlation)
        jump = max(_SIGNIFICANT * scatter * math.sqrt(inverse[3, 3]), _SMALLEST_JUMP)
        kink = max(_SIGNIFICANT * scatter * math.sqrt(inverse[4, 4]), _SMALLEST_KINK)
        score[i : i + stride] = max(abs(solution[3]) / jump, abs(solution[4]) / kink)
        misfit[i : i + stride] = misfit[i]
    return score, misfit


def beside_another(runs: list[Array], reach: float) -> list[Array]:
    """For each run, how far in px each point is from another run beside or across it; infinite beyond `reach`.

    Another run that goes on where this one ends (ahead of it, not beside it) does not count.
    """
    apart_px = [np.full(len(run), np.inf) for run in runs]
    boxes = [(run[:, :2].min(axis=0) - reach, run[:, :2].max(axis=0) + reach) for run in runs]
    trees: dict[int, cKDTree] = {}
    for i, run in enumerate(runs):
        for j, other in enumerate(runs):
            if i == j or np.any(boxes[i][1] < boxes[j][0] + reach) or np.any(boxes[j][1] < boxes[i][0] + reach):
                continue
            tree = trees.setdefault(j, cKDTree(other[:, :2]))
            distance, nearest = tree.query(run[:, :2], distance_upper_bound=reach)
            near = np.flatnonzero(np.isfinite(distance))
            apart = other[np.asarray(nearest)[near], :2] - run[near, :2]
            across = np.abs(np.sum(apart * run[near, 2:4], axis=1))
            along = np.abs(apart[:, 1] * run[near, 2] - apart[:, 0] * run[near, 3])
            beside = near[across > along]
            apart_px[i][beside] = np.minimum(apart_px[i][beside], np.asarray(distance)[beside])
    return apart_px
