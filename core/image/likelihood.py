"""The likeliest place of a stripe: every pixel of its cross-sections asked once, with the weight it deserves.

Steger's points say where to look. Rows of the picture (columns, where the stripe lies flat) cut the stripe once a
pixel; x is the distance of a pixel from the curve through the points (`core.image.guide`), and the model of its grey
value a Gaussian integrated over the pixel on a sloping background,

    I(x) = B + b·x + A·exp(−(x − t)²/2s²)

with A, B, b and s known from `core.image.profile`, A varying along the stripe. A step of Fisher scoring moves the curve
by t = Σ ψ·(I − model) / Σ ψ·d, with d the derivative of the model and ψ the weight of `core.image.influence`: the
maximum of a likelihood with read and shot noise and speckle in it, whatever the background's offset and slope. Both
sums are taken over a Gaussian window along the stripe, so points stay as smooth as the filter made them, but bends do
not pull them: the curve's own bend is in x. A and s change along the stripe, and a pixel is held against those at its
own foot on the curve, not where its row cuts it: where a slanting stripe fades, all rows are brighter on one side.

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
from numba import njit
from numpy.typing import NDArray

from core.image.guide import guide
from core.image.influence import NODES, REACH, influence
from core.image.linking import IGNORED, SATURATED
from core.image.noise import NoiseModel
from core.image.pieces import arc_length
from core.image.profile import Sections
from core.image.speckle import Speckle
from core.model.arrays import Array

_CORE = 1.6  # stripe σ that speckle is looked for in
_PIXEL_VARIANCE = 1 / 12
_LARGEST_STEP = 2.5  # px between points; across larger gaps nothing is known
_HEIGHT_CLASS = 0.1  # sections alike within this share of their height use one weight
_ENOUGH = 0.3  # of a window's cuts
_TAIL, _OTHER_LIGHT = 2.5, 0.15  # farther out, in σ, more than this share of the height is no light of this stripe
_BELL_STEPS = 64  # per σ
_BELL = np.exp(-0.5 * (np.arange(3 * _BELL_STEPS + 2) / _BELL_STEPS) ** 2)
_UPRIGHT, _FLAT = 0.74, 0.67  # |n_u| at which columns give way to rows, and rows to columns


class Refined(NamedTuple):
    """Points (N, 5) u, v, n_u, n_v, curvature; their σ in px, and the length in px over which their errors are one.

    σ is infinite where too few pixels could be used.
    """

    run: Array
    sigma: Array
    correlation_px: float


def refine(
    picture: NDArray[np.float32],
    state: NDArray[np.uint8],
    curve: Array,
    weight: Array,
    clear: NDArray[np.bool_],
    sections: Sections,
    noise: NoiseModel,
    speckle: Speckle,
    filter_px: float,
) -> Refined:
    """Move the points of a `curve` (N, 5), as `core.image.guide` gives it, to the likeliest place of the stripe.

    Parameters
    ----------
    picture, state
        (H, W) grey values, and which of them are saturated or to be ignored.
    weight
        (N,) what each point counts for the curve they make.
    clear
        (N,) True where no other light reaches into the cuts; the others are not used.
    sections
        The model at each point.
    filter_px
        σ in px of the window along the stripe.
    """
    curve, arc = curve.copy(), arc_length(curve)
    kind, tables, shares = _weights(sections, noise, speckle)
    model = np.column_stack(sections)
    law = (noise.read_grey**2, noise.grey_per_electron)
    for last in (False, True):
        cuts = _cuts_of(curve, arc)
        sums = _sums(picture, state, curve, cuts, clear, model, kind, tables, law)
        offset, variance, support = _averages(arc, cuts[:, 0], sums, filter_px, _BELL)
        curve[:, :2] += offset[:, None] * curve[:, 2:4]
        if not last:
            curve = guide(curve, arc, weight, filter_px)
    curve[:, :2] += (_PIXEL_VARIANCE / 2 * curve[:, 4])[:, None] * curve[:, 2:4]  # an arc seen through square pixels
    # grains reach further along the stripe than the pixel: the window averages over fewer of them than of pixels
    grown = math.sqrt(1 + float(np.median(shares[kind])) * (speckle.grain_px / (2 * filter_px)) ** 2)
    usual = 1 / math.sqrt(2 * math.pi) / filter_px
    sigma = np.where(support * usual > _ENOUGH, np.sqrt(variance / grown), np.inf)
    return Refined(curve, sigma, 2 * math.sqrt(math.pi) * filter_px * grown)


def residuals(
    picture: NDArray[np.float32],
    state: NDArray[np.uint8],
    curve: Array,
    sections: Sections,
) -> Array:
    """By how much pixels near the crest differ from the model, and the model's light there: (2, K, W) of K cuts.

    Zeros where a pixel cannot be used. The other arguments are those of `refine`.
    """
    half = max(2, int(_CORE * float(np.median(sections.width))))
    found: Array = _residuals(
        picture, state, curve, _cuts_of(curve, arc_length(curve)), np.column_stack(sections), half
    )
    return found


def _weights(sections: Sections, noise: NoiseModel, speckle: Speckle) -> tuple[NDArray[np.int64], Array, Array]:
    """Which weight suits each point (N,), the weights (K, 2·NODES + 1), and the share of speckle in their variance."""
    level = np.round(np.log(np.maximum(sections.height, 1e-3)) / _HEIGHT_CLASS).astype(np.int64)
    levels, kind = np.unique(level, return_inverse=True)
    background, width = float(np.median(sections.background)), float(np.median(sections.width))
    found = [influence(math.exp(k * _HEIGHT_CLASS), background, width, noise, speckle) for k in levels]
    return kind.astype(np.int64), np.array([f.weight for f in found]), np.array([f.speckle_share for f in found])


@njit(cache=True, nogil=True)
def _cuts_of(run: Array, arc: Array) -> Array:
    """Where rows or columns of the picture cut a `run` (N, ≥ 4).

    (K, 5), in order along the run: length along it; number of the row (column); the place in it; the nearest point;
    1 for a row.
    """
    cuts = np.empty((2 * len(run) + 8, 5))
    count = 0
    upright = abs(run[0, 2]) > 0.7
    for k in range(len(run) - 1):
        du, dv = run[k + 1, 0] - run[k, 0], run[k + 1, 1] - run[k, 1]
        upright = abs(run[k, 2]) > (_FLAT if upright else _UPRIGHT)  # a stripe at 45° must not change at each point
        if du * du + dv * dv > _LARGEST_STEP**2:
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


@njit(cache=True, nogil=True, fastmath=True)
def _sums(
    picture: NDArray[np.float32],
    state: NDArray[np.uint8],
    run: Array,
    cuts: Array,
    clear: NDArray[np.bool_],
    model: Array,
    kind: NDArray[np.int64],
    tables: Array,
    noise: tuple[float, float],
) -> Array:
    """Σ ψ·(I − model) and Σ ψ·d of each cut, (K, 2); zeros where it cannot be used."""
    sums = np.zeros((len(cuts), 2))
    for c in range(len(cuts)):
        line, place, near, upright = int(cuts[c, 1]), cuts[c, 2], int(cuts[c, 3]), cuts[c, 4] > 0
        if not clear[near]:
            continue
        nx = run[near, 2] if upright else run[near, 3]
        height, width, background, slope = model[near, 0], model[near, 1], model[near, 2], model[near, 3]
        half = REACH * width / abs(nx)
        first, last = math.ceil(place - half), math.floor(place + half)
        rows, columns = picture.shape if upright else picture.shape[::-1]
        if height <= 0 or first < 0 or last >= columns or line < 0 or line >= rows:
            continue
        bend, unit, inverse = run[near, 4], NODES / REACH / width, 1 / (width * width)
        table = tables[kind[near]]
        slip = -run[near, 3] if upright else run[near, 2]  # of a pixel's foot along the stripe, per pixel
        before, behind = max(near - math.ceil(width), 0), min(near + math.ceil(width), len(model) - 1)
        fade = slip * (model[behind, 0] / height - model[before, 0] / height) / max(behind - before, 1)
        widening = slip * (model[behind, 1] / width - model[before, 1] / width) / max(behind - before, 1)
        other = (_OTHER_LIGHT * height) ** 2 + 36 * (noise[0] + noise[1] * max(background, 0.0))
        part = False
        n, nt, nh = 0.0, 0.0, 0.0  # of ψ: with what is left over, its derivatives with place and height
        e, et, eh = 0.0, 0.0, 0.0  # the same of the section itself, which asks for the height
        for i in range(first, last + 1):
            column, row = (i, line) if upright else (line, i)
            along = i - place
            power = along * (2 * nx - bend * along)  # of the pixel with respect to the circle of that bend
            turn = bend * power
            x = power * (0.5 + turn * (0.125 + turn * (0.0625 + turn * 0.0390625)))
            at = min(max(x * unit + NODES, 0.0), 2 * NODES - 1e-9)
            node = int(at)
            psi = table[node] + (at - node) * (table[node + 1] - table[node])
            square = x * x * inverse * (1 - 2 * widening * along)
            bell = (1 + fade * along) * math.exp(-0.5 * square)
            light = height * bell
            residual = picture[row, column] - background - slope * x - light
            if state[row, column] & (SATURATED | IGNORED) or (
                abs(x) > _TAIL * width and residual**2 > other + 36 * noise[1] * light
            ):
                part = True
                continue
            slant = light * x * inverse
            n += psi * residual
            nt += psi * slant
            nh += psi * bell
            e += bell * residual
            et += bell * slant
            eh += bell * bell
        if part and eh > 0:
            n, nt = n - nh / eh * e, nt - nh / eh * et
        sums[c, 0], sums[c, 1] = n, max(nt, 0.0)
    return sums


@njit(cache=True, nogil=True, fastmath=True)
def _averages(arc: Array, at: Array, sums: Array, window: float, bell: Array) -> tuple[Array, Array, Array]:
    """At each point, (N,): the offset t in px, its variance, and the weight of all cuts it rests on.

    The offset is that of a straight line through the window's cuts: a window cut short has its middle elsewhere.
    """
    offset, variance, support = np.zeros(len(arc)), np.full(len(arc), np.inf), np.zeros(len(arc))
    reach = 3 * window
    first = 0
    for k in range(len(arc)):
        while first < len(at) and at[first] < arc[k] - reach:
            first += 1
        m0, m1, m2, n0, n1 = 0.0, 0.0, 0.0, 0.0, 0.0
        q0, q1, q2 = 0.0, 0.0, 0.0
        c = first
        while c < len(at) and at[c] <= arc[k] + reach:
            if sums[c, 1] > 0:
                x = (at[c] - arc[k]) / window
                w = bell[int(abs(x) * _BELL_STEPS + 0.5)]
                m = w * sums[c, 1]
                m0, m1, m2 = m0 + m, m1 + m * x, m2 + m * x * x
                n0, n1 = n0 + w * sums[c, 0], n1 + w * sums[c, 0] * x
                m *= w
                q0, q1, q2 = q0 + m, q1 + m * x, q2 + m * x * x
                support[k] += w
            c += 1
        determinant = m0 * m2 - m1 * m1
        if determinant > 1e-3 * m0 * m0:
            offset[k] = (m2 * n0 - m1 * n1) / determinant
            variance[k] = (m2 * m2 * q0 - 2 * m1 * m2 * q1 + m1 * m1 * q2) / (determinant * determinant)
    return offset, variance, support


@njit(cache=True, nogil=True, fastmath=True)
def _residuals(
    picture: NDArray[np.float32], state: NDArray[np.uint8], run: Array, cuts: Array, model: Array, half: int
) -> Array:
    """Residuals of the middle 2·`half` + 1 pixels of each cut, and the model's light there, (2, K, W)."""
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
            light = height * math.exp(-0.5 * (x / width) ** 2)
            found[0, c, k] = picture[row, column] - background - slope * x - light
            found[1, c, k] = light
    return found
