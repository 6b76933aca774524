"""Fit of a Gaussian on a sloping background to the pixels around points of a stripe; see `core.image.stripes.profile`.

The exponential is worked out in plain multiplications, so that compiled loops over pixels do many at once.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.stripes.tracing.pixel_state import IGNORED, SATURATED
from core.image.stripes.tracing.seeds import Picture
from core.model.arrays import Array

REACH = 3.2
"""Stripe σ looked at on either side; further out a neighbour that is still harmless would pass for a slope."""
_UNKNOWNS = 5  # background, slope, height, centre, width
_BINS_PER_PX = 2  # across the stripe
_BINS_MULTIPLE = 8  # the number of bins is one of it: processors work on 8 numbers at once
_ALL_ROWS_UP_TO = 6.0
"""Px along the stripe; of more, every second row tells enough: grains are as wide, and a hundred pixels are left."""


# Gauss–Newton steps in σ of the stripe, or of the fit. Held by tests/image/test_rendered_lines.py and
# tests/image/stripes/test_extraction.py (width and strength) on rendered plates.
_ROUNDS = 8  # at most
_SETTLED = 0.01  # stripe σ: after a step so small the next one would be nothing
_LARGEST_SHIFT = 0.5  # stripe σ that a step moves the centre at most
_LARGEST_NARROWING, _LARGEST_WIDENING = 0.3, 0.5  # of the fitted σ that a step takes or adds at most
_NARROWEST, _WIDEST, _FARTHEST = 0.3, 3.0, 1.0  # stripe σ: widths and centre of a fit that can be this stripe

_FLANK = 0.25  # stripe σ from the middle where a flank begins
_LEAST_ON_FLANK = 3  # bins seen on each flank: the top may be saturated
_DAMPING = 1e-9  # relative to the diagonal: a fit without a unique answer stays solvable
DARK = 16.0  # exponent from which on exp(−y) counts as 0: 1e-7


@compiled(fastmath=True)
def fit_sections(picture: Picture, state: NDArray[np.uint8], places: Array, stripe_px: float, along_px: float) -> Array:
    """Fit cross-sections at `places` (K, ≥ 4) u, v, n_u, n_v: height, background, slope, width, skewness (K, 5).

    Each rests on the pixels up to `along_px` away along the stripe and 3.2 σ `stripe_px` across it; a height of 0 says
    that a fit failed. Skewness is positive where the light reaches further towards the normal.
    """
    reach = REACH * stripe_px + 1.0
    bins = _BINS_MULTIPLE * (2 * math.ceil(reach * _BINS_PER_PX) // _BINS_MULTIPLE + 1)
    section = np.empty((3, bins))
    work = np.empty((_UNKNOWNS + 2, _UNKNOWNS))
    x = np.zeros(_UNKNOWNS)  # background, slope, height, centre, width
    fits = np.zeros((len(places), 5))
    has_neighbour = False
    for k in range(len(places)):
        _average_across(picture, state, places[k], reach, along_px, section)
        low, high = _range(section, stripe_px)
        if high <= low:
            continue
        settled = False
        if has_neighbour:  # the neighbour's answer is nearly this one's, and wrong if its own was: it must settle
            x[3] = 0.0
            settled = _fit(section, stripe_px, x, work)
        if not (settled and _is_likely(x, stripe_px)):
            x[0], x[1], x[2], x[3], x[4] = low, 0.0, high - low, 0.0, stripe_px
            settled = _fit(section, stripe_px, x, work)
        has_neighbour = _is_likely(x, stripe_px)
        if has_neighbour:
            fits[k, 0], fits[k, 1], fits[k, 2], fits[k, 3] = x[2], x[0], x[1], x[4]
            fits[k, 4] = _skewness(section, x, work)
        has_neighbour = has_neighbour and settled
    return fits


@inlined(fastmath=True)
def _average_across(
    picture: Picture, state: NDArray[np.uint8], place: Array, reach: float, along_px: float, section: Array
) -> None:
    """Average the pixels around a place in bins across the stripe: number, mean distance, mean grey (3, K)."""
    height, width = picture.shape
    u, v, nu, nv = place[0], place[1], place[2], place[3]
    upright = abs(nu) > abs(nv)
    if not upright:  # rows are columns, then
        height, width, u, v, nu, nv = width, height, v, u, nv, nu
    middle = section.shape[1] // 2
    section[:] = 0.0
    half = math.ceil(abs(nv) * reach + abs(nu) * along_px)
    row, every = int(v + 0.5), 2 if 2 * along_px > _ALL_ROWS_UP_TO else 1
    for j in range(max(row - half, 0), min(row + half + 1, height), every):
        at, spread = u - nv * (j - v) / nu, reach / abs(nu)
        for i in range(max(math.ceil(at - spread), 0), min(math.floor(at + spread) + 1, width)):
            across = nu * (i - u) + nv * (j - v)
            if abs(nu * (j - v) - nv * (i - u)) > along_px:
                continue
            here = state[j, i] if upright else state[i, j]
            if here & (SATURATED | IGNORED):
                continue
            k = middle + math.floor(across * _BINS_PER_PX + 0.5)
            section[0, k] += 1.0
            section[1, k] += across
            section[2, k] += picture[j, i] if upright else picture[i, j]
    for k in range(section.shape[1]):
        if section[0, k] > 0:
            section[1, k] /= section[0, k]
            section[2, k] /= section[0, k]


@inlined(fastmath=True)
def _range(section: Array, stripe_px: float) -> tuple[float, float]:
    """Lowest and highest grey value; twice 0 where too little is seen: both flanks, the top may be saturated."""
    low, high, left, right = np.inf, -np.inf, 0, 0
    for k in range(section.shape[1]):
        if section[0, k] > 0:
            low, high = min(low, section[2, k]), max(high, section[2, k])
            left += section[1, k] < -_FLANK * stripe_px
            right += section[1, k] > _FLANK * stripe_px
    if min(left, right) < _LEAST_ON_FLANK or left + right <= _UNKNOWNS:
        return 0.0, 0.0
    return low, high


@inlined(fastmath=True)
def _fit(section: Array, stripe_px: float, x: Array, work: Array) -> bool:
    """Gauss–Newton from `x` (5,): background, slope, height, centre, width; whether it settles."""
    normal, step = work[:_UNKNOWNS], work[_UNKNOWNS]
    count, distance, grey = section[0], section[1], section[2]
    for _ in range(_ROUNDS):
        back, slope, height, centre, width = x[0], x[1], x[2], x[3], x[4]
        n00, n10, n11, n20, n21, n22, n30, n31 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        n32, n33, n40, n41, n42, n43, n44 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        r0, r1, r2, r3, r4 = 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(len(count)):
            w, t = count[k], distance[k]
            d = (t - centre) / width
            b = exp_negative(0.5 * d * d)
            p = height * b * d / width  # by the centre
            q = p * d  # by the width
            r = w * (grey[k] - back - slope * t - height * b)
            r0, r1, r2, r3, r4 = r0 + r, r1 + r * t, r2 + r * b, r3 + r * p, r4 + r * q
            n00, n10, n20, n30, n40 = n00 + w, n10 + w * t, n20 + w * b, n30 + w * p, n40 + w * q
            n11, n21, n31, n41 = n11 + w * t * t, n21 + w * t * b, n31 + w * t * p, n41 + w * t * q
            n22, n32, n42 = n22 + w * b * b, n32 + w * b * p, n42 + w * b * q
            n33, n43, n44 = n33 + w * p * p, n43 + w * p * q, n44 + w * q * q
        normal[0, 0], normal[1, 0], normal[1, 1], normal[2, 0], normal[2, 1] = n00, n10, n11, n20, n21
        normal[2, 2], normal[3, 0], normal[3, 1], normal[3, 2], normal[3, 3] = n22, n30, n31, n32, n33
        normal[4, 0], normal[4, 1], normal[4, 2], normal[4, 3], normal[4, 4] = n40, n41, n42, n43, n44
        step[0], step[1], step[2], step[3], step[4] = r0, r1, r2, r3, r4
        if not _solve(normal, step):
            return False
        step[3] = min(max(step[3], -_LARGEST_SHIFT * stripe_px), _LARGEST_SHIFT * stripe_px)
        step[4] = min(max(step[4], -_LARGEST_NARROWING * width), _LARGEST_WIDENING * width)
        for a in range(_UNKNOWNS):
            x[a] += step[a]
        if abs(step[3]) + abs(step[4]) < _SETTLED * stripe_px:
            return True
    return False


@inlined(fastmath=True)
def _skewness(section: Array, x: Array, work: Array) -> float:
    """Skewness of the light about a fit `x` (5,): by the third term of a Gram–Charlier series, fitted with all others.

    With d in σ from the centre, what is left of the section is searched for A·κ/6·(d³ − 3d)·exp(−d²/2), of which what
    background, slope, height, centre and width would take over is taken out first. Kendall, M., Stuart, A., The
    Advanced Theory of Statistics, vol. 1 (1977), 6.17.
    """
    normal, share, row = work[:_UNKNOWNS], work[_UNKNOWNS], work[_UNKNOWNS + 1]
    normal[:] = 0.0
    share[:] = 0.0
    found, square = 0.0, 0.0
    for k in range(section.shape[1]):
        w, t = section[0, k], section[1, k]
        d = (t - x[3]) / x[4]
        b = exp_negative(0.5 * d * d)
        third = b * d * (d * d - 3)
        row[0], row[1], row[2], row[3], row[4] = 1.0, t, b, b * d, b * d * d
        for i in range(_UNKNOWNS):
            share[i] += w * row[i] * third
            for j in range(i + 1):
                normal[i, j] += w * row[i] * row[j]
        found += w * third * (section[2, k] - x[0] - x[1] * t - x[2] * b)
        square += w * third * third
    for i in range(_UNKNOWNS):
        row[i] = share[i]
    if not _solve(normal, share):
        return 0.0
    for i in range(_UNKNOWNS):
        square -= share[i] * row[i]
    return 6 * found / (x[2] * square) if square > 0 else 0.0


@inlined(fastmath=True)
def _is_likely(x: Array, stripe_px: float) -> bool:
    """Whether a fit `x` (5,) can be the section of a stripe of about this σ."""
    return bool(x[2] > 0 and _NARROWEST * stripe_px < x[4] < _WIDEST * stripe_px and abs(x[3]) < _FARTHEST * stripe_px)


@inlined(fastmath=True)
def _solve(normal: Array, x: Array) -> bool:
    """Solve by Cholesky from the lower triangle, lightly damped; `x` comes as the right side. False if singular."""
    for a in range(_UNKNOWNS):
        normal[a, a] *= 1 + _DAMPING
        for b in range(a + 1):
            total = normal[a, b]
            for c in range(b):
                total -= normal[a, c] * normal[b, c]
            if a == b:
                if total <= 0.0:
                    return False
                normal[a, a] = math.sqrt(total)
            else:
                normal[a, b] = total / normal[b, b]
    for a in range(_UNKNOWNS):
        for b in range(a):
            x[a] -= normal[a, b] * x[b]
        x[a] /= normal[a, a]
    for a in range(_UNKNOWNS - 1, -1, -1):
        for b in range(a + 1, _UNKNOWNS):
            x[a] -= normal[b, a] * x[b]
        x[a] /= normal[a, a]
    return True


@inlined(fastmath=True)
def exp_negative(y: float) -> float:
    """Compute exp(−y) for y ≥ 0 to within 1e-7, quickly in compiled loops.

    Taylor's series of the sixteenth part, squared four times.
    """
    t = min(y, DARK) * (1 / 16)
    tail = 1 - t / 4 * (1 - t / 5 * (1 - t / 6 * (1 - t / 7)))
    p = 1 - t * (1 - t / 2 * (1 - t / 3 * tail))
    p *= p
    p *= p
    p *= p
    return p * p
