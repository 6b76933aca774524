"""Maximum-likelihood refinement of a stripe's centreline from all pixels of its cross-sections, optimally weighted.

Steger's points say where to look. Rows of the picture (columns, where the stripe lies flat) cut the stripe once a
pixel; x is the distance of a pixel from the curve through the points (`core.image.stripes.curve`), and the model of
its grey value a Gaussian integrated over the pixel on a sloping background,

    I(x) = B + b·x + A·exp(−(x − t)²/2s²)

with A, B, b and s known from `core.image.stripes.profile`, A varying along the stripe. A step of Fisher scoring moves
the curve by t = Σ ψ·(I − model) / Σ ψ·d, with d the derivative of the model and ψ the weight of
`core.image.stripes.likelihood.influence`: the maximum of a likelihood with read and shot noise and speckle in it,
whatever the background's offset and slope. Both sums are taken over a Gaussian window along the stripe, so points stay
as smooth as the filter made them, but bends do not pull them: the curve's own bend is in x. A and s change along the
stripe, and a pixel is held against those at its own foot on the curve, not where its row cuts it: where a slanting
stripe fades, all rows are brighter on one side. On slanting stripes it counts for the cut through its foot, too.

Where pixels cannot be used (saturated, or other light far off the model), A is estimated together with t from those
that are left, for then the two are no longer independent.

References
----------
Kay, S. M., Fundamentals of Statistical Signal Processing: Estimation Theory (1993), §7.7: scoring; §6: the best linear
unbiased estimator, to which each step comes down.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.stripes.curve import smooth_curve
from core.image.stripes.likelihood.cut_model import Light
from core.image.stripes.likelihood.influence import influences
from core.image.stripes.likelihood.measured_section import Section
from core.image.stripes.likelihood.scores import score_cuts
from core.image.stripes.noise import NoiseModel
from core.image.stripes.profile import Sections
from core.image.stripes.running_statistics import median
from core.image.stripes.runs import arc_length
from core.image.stripes.section_fit import exp_negative
from core.image.stripes.speckle import Speckle
from core.image.stripes.stripe import PIXEL_VARIANCE
from core.image.stripes.tracing.interpolation import cubic_weights, tracing_step
from core.image.stripes.tracing.pixel_state import IGNORED, SATURATED
from core.image.stripes.tracing.seeds import Picture
from core.model.arrays import Array
from core.model.small_arrays import column, first_not_below, first_rows, new_indices, new_table

# Held by tests/image/stripes/likelihood/test_refinement.py against the Cramér–Rao bound on rendered stripes.
_CORE = 1.6  # stripe σ on either side in which speckle is measured
_ENOUGH = 0.3  # of a window's cuts must be usable, or a point is not refined
_NEAR = 0.2  # stripe σ: one step from there errs by less than a hundredth of its length, so one is enough
_FARTHEST = 1.0  # stripe σ: a longer step leads out of the flanks that it is worked out from, to no place of any light
_HEIGHT_CLASS = 0.1  # logarithm of the height: sections within this step of it use one weight
_SECTION_SAMPLE = 8  # points: every so many tell a median over sections, which change slowly; saves time

# Cuts of a run by rows and columns.
_LARGEST_STEP_PX = 2.5  # between points; across larger gaps nothing is known
_UPRIGHT, _FLAT = 0.74, 0.67  # |n_u| at which columns give way to rows, and rows to columns: 45° lies between

_WINDOW_STEPS = 64  # per σ: rounding to the nearest changes a weight by less than 0.5 %
_WINDOW = np.exp(-0.5 * (np.arange(3 * _WINDOW_STEPS + 2) / _WINDOW_STEPS) ** 2)
"""Gaussian window from its middle to 3 σ."""


class Refined(NamedTuple):
    """Refined points of a stripe (N, 5): u, v, n_u, n_v, curvature in 1/px; their σ (N,) and correlation length in px.

    σ is infinite where too few pixels could be used, or what they say leads astray.
    """

    run: Array
    sigma: Array
    correlation_px: float


class StripeModel(NamedTuple):
    """Stripe before its refinement, at each of N points.

    Parameters
    ----------
    curve
        (N, 5) u, v, n_u, n_v, curvature, as `core.image.stripes.curve` gives it.
    weight
        (N,) weight of each point in the curve.
    clear
        (N,) True where no other light reaches into the cuts; the others are not used.
    sections
        The light's cross-sections.
    measured
        Their shape where that is no Gaussian.
    """

    curve: Array
    weight: Array
    clear: NDArray[np.bool_]
    sections: Sections
    measured: Section | None = None


def refine(
    picture: Picture,
    state: NDArray[np.uint8],
    stripe: StripeModel,
    noise: NoiseModel,
    speckle: Speckle,
    filter_px: float,
) -> Refined:
    """Move the points of a stripe to its likeliest place, by the pixels of rows or columns that cut it.

    Parameters
    ----------
    picture, state
        (H, W) grey values, and which of them are saturated or to be ignored.
    stripe
        The stripe as known so far.
    noise, speckle
        Scatter of the grey values.
    filter_px
        σ in px of the window along the stripe.
    """
    curve, weight, clear, sections, measured = stripe
    figures, scatter = np.column_stack(sections), (noise.read_grey**2, noise.grey_per_electron)
    if measured is None:
        kind, weights, shares = _weights(sections, noise, speckle)
        light = Light(figures, kind, weights, scatter)
    else:
        kind, solved = measured.weights_along(sections.height)
        weights = np.stack([one.table for one in solved])
        shares = np.array([one.speckle_share for one in solved])
        light = Light(figures, kind, weights, scatter, measured.tables)
    curve, variance, support = _likeliest(picture, state, curve, weight, clear, light, filter_px)
    # grains reach further along the stripe than the pixel: the window averages over fewer of them than of pixels
    grown = math.sqrt(1 + median(shares[kind[::_SECTION_SAMPLE]]) * (speckle.grain_px / (2 * filter_px)) ** 2)
    usual = 1 / math.sqrt(2 * math.pi) / filter_px
    sigma = np.where(support * usual > _ENOUGH, np.sqrt(variance / grown), np.inf)
    return Refined(curve, sigma, 2 * math.sqrt(math.pi) * filter_px * grown)


@compiled()
def _likeliest(
    picture: Picture,
    state: NDArray[np.uint8],
    start: Array,
    weight: Array,
    clear: NDArray[np.bool_],
    light: Light,
    filter_px: float,
) -> tuple[Array, Array, Array]:
    """The curve (N, 5), the variance of its points and the weight of all cuts they rest on, (N,)."""
    curve, arc, last = first_rows(start, len(start)), arc_length(start), False
    while True:
        cuts = cuts_of(curve, arc)
        sums = score_cuts(picture, state, curve, cuts, clear, light)
        found = averages(arc, column(cuts, 0), sums, filter_px)
        near = True
        for k in range(len(curve)):
            if abs(found[k, 0]) > _FARTHEST * light.sections[k, 1]:
                found[k, 0], found[k, 1] = 0.0, math.inf
            curve[k, 0] += found[k, 0] * curve[k, 2]
            curve[k, 1] += found[k, 0] * curve[k, 3]
            near &= abs(found[k, 0]) < _NEAR * light.sections[k, 1]
        if near or last:
            break
        curve, last = smooth_curve(curve, arc, weight, filter_px), True
    for k in range(len(curve)):
        seen = 0.5 * PIXEL_VARIANCE * curve[k, 4]  # an arc through square pixels
        curve[k, 0] += seen * curve[k, 2]
        curve[k, 1] += seen * curve[k, 3]
    return curve, found[:, 1], found[:, 2]


def residuals(
    picture: Picture,
    state: NDArray[np.uint8],
    curve: Array,
    sections: Sections,
) -> Array:
    """Compute measured − modelled light of the W pixels near the crest in K cuts, and the model: (2, K, W).

    A cut is a row or column of W pixels across the stripe. Zeros where a pixel cannot be used. The other arguments are
    those of `refine`.
    """
    half = max(2, int(_CORE * median(sections.width)))
    cuts = cuts_of(curve, arc_length(curve))
    return np.asarray(cut_residuals(picture, state, curve, cuts, np.column_stack(sections), half))


def _weights(sections: Sections, noise: NoiseModel, speckle: Speckle) -> tuple[NDArray[np.int64], Array, Array]:
    """Which weight suits each point (N,), the weights (K, DEGREE + 1), and the share of speckle in their variance."""
    level = _height_levels(sections.height)
    lowest = int(level.min())
    present = np.flatnonzero(np.bincount(level - lowest))  # as few as there are heights
    kind, heights = np.searchsorted(present, level - lowest), np.exp((present + lowest) * _HEIGHT_CLASS)
    background, width = (median(figure[::_SECTION_SAMPLE]) for figure in (sections.background, sections.width))
    return kind, *influences(tuple(heights.tolist()), background, width, noise, speckle)


@compiled()
def _height_levels(height: Array) -> NDArray[np.int64]:
    """The logarithm of each point's height, as a whole number of classes."""
    level = new_indices(len(height))
    here, from_height, to_height = 0, math.inf, -math.inf
    for k in range(len(height)):
        if not from_height <= height[k] < to_height:  # seldom: heights change slowly
            here = round(math.log(max(height[k], 1e-3)) / _HEIGHT_CLASS)
            from_height, to_height = math.exp((here - 0.5) * _HEIGHT_CLASS), math.exp((here + 0.5) * _HEIGHT_CLASS)
        level[k] = here
    return level


@compiled(inline=True)
def cuts_of(run: Array, arc: Array) -> Array:
    """Find where rows or columns of the picture cut a `run` (N, ≥ 4) of line points: (K, 5) in order along the run.

    Length along it; number of the row (column); the place in it; the nearest point; 1 for a row.
    """
    cuts = new_table(2 * len(run) + 8, 5)
    count = 0
    upright = abs(run[0, 2]) > 0.7
    for k in range(len(run) - 1):
        du, dv = run[k + 1, 0] - run[k, 0], run[k + 1, 1] - run[k, 1]
        upright = abs(run[k, 2]) > (_FLAT if upright else _UPRIGHT)  # a stripe at 45° must not change at each point
        if du * du + dv * dv > _LARGEST_STEP_PX**2:
            continue
        start, step = (run[k, 1], dv) if upright else (run[k, 0], du)
        place, drift = (run[k, 0], du) if upright else (run[k, 1], dv)
        first, behind = math.ceil(min(start, start + step)), math.ceil(max(start, start + step))
        for number in range(min(behind - first, len(cuts) - count)):
            line = first + number if step > 0 else behind - 1 - number
            share = (line - start) / step
            cuts[count, 0] = arc[k] + share * (arc[k + 1] - arc[k])
            cuts[count, 1], cuts[count, 2] = line, place + share * drift
            cuts[count, 3], cuts[count, 4] = k + (share > 0.5), upright
            count += 1
    return cuts[:count]


@compiled(fastmath=True)
def cut_residuals(
    picture: Picture, state: NDArray[np.uint8], run: Array, cuts: Array, model: Array, half: int
) -> Array:
    """Compute measured − modelled light of the middle 2·`half` + 1 pixels of K cuts, and the model: (2, K, W)."""
    found = np.zeros((2, len(cuts), 2 * half + 1))
    for c in range(len(cuts)):
        line, place, near, upright = int(cuts[c, 1]), cuts[c, 2], int(cuts[c, 3]), cuts[c, 4] > 0
        nx = run[near, 2] if upright else run[near, 3]
        height, width, background, slope = model[near, 0], model[near, 1], model[near, 2], model[near, 3]
        rows, columns = picture.shape if upright else picture.shape[::-1]
        first = math.floor(place + 0.5) - half
        if first < 0 or first + 2 * half >= columns or line < 0 or line >= rows:
            continue
        for k in range(2 * half + 1):
            column, row = (first + k, line) if upright else (line, first + k)
            if state[row, column] & (SATURATED | IGNORED):
                continue
            x = nx * (first + k - place)
            light = height * exp_negative(0.5 * (x / width) ** 2)
            found[0, c, k] = picture[row, column] - background - slope * x - light
            found[1, c, k] = light
    return found


@inlined()
def averages(arc: Array, at: Array, sums: Array, window: float) -> Array:
    """Average the scores of cuts in a window about each point: (N, 3) offset in px, its variance, total weight.

    The offset is that of a straight line through the window's cuts: a window cut short has its middle elsewhere. It is
    as smooth as the window, so it is worked out at some points and lies on cubics between them
    (`core.image.stripes.tracing.interpolation`).
    """
    count, stride = len(arc), tracing_step(window)
    found, weights = new_table(count, 3), cubic_weights(stride)
    for k in range(0, count, stride):
        _average(arc[k], at, sums, window, found[k])
    for k in range(count):
        step = k % stride
        first, last = k - step - stride, k - step + 2 * stride
        if step == 0:
            continue
        if first < 0 or last >= count or not _evenly_known(arc, found, first, stride):
            _average(arc[k], at, sums, window, found[k])
            continue
        for a in range(3):
            found[k, a] = 0.0
            for i in range(4):
                found[k, a] += weights[step, i] * found[first + i * stride, a]
    return found


@inlined()
def _evenly_known(arc: Array, found: Array, first: int, stride: int) -> bool:
    """Whether there is no hole among four points `stride` apart, and their variances are much the same."""
    least, most = math.inf, 0.0
    for i in range(4):
        variance = found[first + i * stride, 1]
        least, most = min(least, variance), max(most, variance)
    return bool(arc[first + 3 * stride] - arc[first] < 3 * stride + 1 and most < 2 * least)


@inlined(fastmath={"contract", "reassoc", "arcp", "nsz"})
def _average(place: float, at: Array, sums: Array, window: float, found: Array) -> None:
    """The three figures `found` at one `place`."""
    reach, scale = 3 * window, 1 / window
    m0, m1, m2, n0, n1 = 0.0, 0.0, 0.0, 0.0, 0.0
    q0, q1, q2, support = 0.0, 0.0, 0.0, 0.0
    for c in range(first_not_below(at, place - reach), len(at)):
        if at[c] > place + reach:
            break
        if sums[c, 1] > 0:
            x = (at[c] - place) * scale
            w = _WINDOW[int(abs(x) * _WINDOW_STEPS + 0.5)]
            m, n = w * sums[c, 1], w * sums[c, 0]
            m0, m1, m2 = m0 + m, m1 + m * x, m2 + m * x * x
            n0, n1 = n0 + n, n1 + n * x
            m *= w
            q0, q1, q2 = q0 + m, q1 + m * x, q2 + m * x * x
            support += w
    determinant = m0 * m2 - m1 * m1
    found[0], found[1], found[2] = 0.0, math.inf, support
    if determinant > 1e-3 * m0 * m0:
        found[0] = (m2 * n0 - m1 * n1) / determinant
        found[1] = (m2 * m2 * q0 - 2 * m1 * m2 * q1 + m1 * m1 * q2) / (determinant * determinant)
