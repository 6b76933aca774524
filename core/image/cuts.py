"""Rows and columns that cut a stripe, compared with the model of its light; see `core.image.likelihood`."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.bell import bell
from core.image.filling import cubic_weights, points_apart
from core.image.influence import NODES, REACH
from core.image.linking import IGNORED, SATURATED
from core.image.seeds import Picture
from core.model.arrays import Array

_LARGEST_STEP = 2.5  # px between points; across larger gaps nothing is known
_TAIL, _OTHER_LIGHT = 2.5, 0.15  # farther out, in σ, more than this share of the height is no light of this stripe
_BELL_STEPS = 64  # per σ
_BELL = np.exp(-0.5 * (np.arange(3 * _BELL_STEPS + 2) / _BELL_STEPS) ** 2)
_UPRIGHT, _FLAT = 0.74, 0.67  # |n_u| at which columns give way to rows, and rows to columns


@njit(cache=True, nogil=True)
def cuts_of(run: Array, arc: Array, every: int = 1) -> Array:
    """Where rows or columns of the picture, or only every `every`-th of them, cut a `run` (N, ≥ 4).

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
            if line % every:
                continue
            share = (line - start) / step
            cuts[count, 0] = arc[k] + share * (arc[k + 1] - arc[k])
            cuts[count, 1], cuts[count, 2] = line, place + share * drift
            cuts[count, 3], cuts[count, 4] = k + (share > 0.5), upright
            count += 1
    return cuts[:count]


@njit(cache=True, nogil=True, fastmath=True)
def score_cuts(
    picture: Picture,
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
    longest = max(picture.shape)
    bits, rest = np.empty(longest, dtype=np.uint8), np.empty(longest)
    places, bells = np.empty(longest), np.empty(longest)
    for c in range(len(cuts)):
        line, place, near, upright = int(cuts[c, 1]), cuts[c, 2], int(cuts[c, 3]), cuts[c, 4] > 0
        if not clear[near]:
            continue
        nx = run[near, 2] if upright else run[near, 3]
        height, width, background = model[near, 0], model[near, 1], model[near, 2]
        half = REACH * width / abs(nx)
        first, last = math.ceil(place - half), math.floor(place + half)
        rows, columns = picture.shape if upright else picture.shape[::-1]
        if height <= 0 or first < 0 or last >= columns or line < 0 or line >= rows:
            continue
        count = last + 1 - first
        if upright:
            any_bits = _read(picture[line, first : last + 1], state[line, first : last + 1], rest, bits)
        else:
            any_bits = _read(picture[first : last + 1, line], state[first : last + 1, line], rest, bits)
        reach = math.ceil(3 * width)
        slip = -run[near, 3] if upright else run[near, 2]  # of a pixel's foot along the stripe, per pixel
        before, behind = max(near - reach, 0), min(near + reach, len(model) - 1)
        fade = slip * (model[behind, 0] / height - model[before, 0] / height) / max(behind - before, 1)
        widening = slip * (model[behind, 1] / width - model[before, 1] / width) / max(behind - before, 1)
        other = (_OTHER_LIGHT * height) ** 2 + 36 * (noise[0] + noise[1] * max(background, 0.0))
        curve, light = (nx, run[near, 4], fade, widening), (_TAIL * width, other, 36 * noise[1] * height)
        strange = _compare(rest, places, bells, count, first - place, curve, model[near], light)
        table = tables[kind[near]]
        if any_bits == 0 and strange == 0:
            sums[c, 0], sums[c, 1] = _score(rest, places, bells, count, width, height, table)
        else:
            _leave_out_strange(rest, places, bells, bits, count, light)
            sums[c, 0], sums[c, 1] = _score_of_part(rest, places, bells, bits, count, width, height, table)
    return sums


@njit(cache=True, nogil=True, fastmath=True)
def _read(grey: Picture, state: NDArray[np.uint8], rest: Array, bits: NDArray[np.uint8]) -> int:
    """Copy the pixels of a cut; `bits` tell which are saturated or ignored, and what is returned whether one is."""
    every = 0
    for i in range(len(grey)):
        rest[i] = grey[i]
    for i in range(len(grey)):
        bits[i] = state[i] & (SATURATED | IGNORED)
        every |= bits[i]
    return every


@njit(cache=True, nogil=True, fastmath=True)
def _compare(
    rest: Array,
    places: Array,
    bells: Array,
    count: int,
    start: float,
    curve: tuple[float, float, float, float],
    model: Array,
    limits: tuple[float, float, float],
) -> float:
    """Turn grey values into what the model leaves over; with that the pixels' distances from the curve and its bell.

    The first one lies `start` px along the cut from the curve. Of that `curve`: its normal's component along the cut,
    its bend, and the shares by which the section fades and widens from one pixel's foot to the next. Returns how many
    pixels show other light than this stripe's: more of it in the tails than `limits` (see `_is_strange`) allow.
    """
    nx, bend, fade, widening = curve
    height, background, slope, inverse = model[0], model[2], model[3], 0.5 / (model[1] * model[1])
    strange = 0.0
    for i in range(count):
        along = i + start
        power = along * (2 * nx - bend * along)  # of the pixel with respect to the circle of that bend
        turn = bend * power
        x = power * (0.5 + turn * (0.125 + turn * (0.0625 + turn * 0.0390625)))
        light = (1 + fade * along) * bell(x * x * inverse * (1 - 2 * widening * along))
        left = rest[i] - (background + slope * x + height * light)
        places[i], bells[i], rest[i] = x, light, left
        strange += 1.0 if _is_strange(left, x, light, limits) else 0.0
    return strange


@njit(cache=True, nogil=True, fastmath=True)
def _is_strange(left: float, x: float, light: float, limits: tuple[float, float, float]) -> bool:
    """Whether so much is `left` of a pixel in a stripe's tails that it must be other light.

    `limits` are where the tails begin, in px, and the variance that is allowed there: the same for all, and for light.
    """
    return (abs(x) > limits[0]) & (left * left > limits[1] + limits[2] * light)


@njit(cache=True, nogil=True, fastmath=True)
def _leave_out_strange(
    rest: Array,
    places: Array,
    bells: Array,
    bits: NDArray[np.uint8],
    count: int,
    limits: tuple[float, float, float],
) -> None:
    """Let `bits` be 1 for pixels that cannot be used: saturated, ignored, or of other light."""
    for i in range(count):
        bits[i] = 1 if (bits[i] != 0) | _is_strange(rest[i], places[i], bells[i], limits) else 0


@njit(cache=True, nogil=True, fastmath=True)
def _score(
    rest: Array, places: Array, bells: Array, count: int, width: float, height: float, table: Array
) -> tuple[float, float]:
    """Σ ψ·(I − model) and Σ ψ·d of one cut."""
    unit, n, nt = NODES / REACH / width, 0.0, 0.0
    for i in range(count):
        at = min(max(places[i] * unit + NODES, 0.0), 2 * NODES - 1e-9)
        node = np.int32(at)
        psi = table[node] + (at - node) * (table[node + 1] - table[node])
        n += psi * rest[i]
        nt += psi * bells[i] * places[i]
    return n, max(nt * height / (width * width), 0.0)


@njit(cache=True, nogil=True, fastmath=True)
def _score_of_part(
    rest: Array,
    places: Array,
    bells: Array,
    bits: NDArray[np.uint8],
    count: int,
    width: float,
    height: float,
    table: Array,
) -> tuple[float, float]:
    """The same where some pixels are left out: the height is estimated together with the place."""
    unit, inverse = NODES / REACH / width, height / (width * width)
    n, nt, nh = 0.0, 0.0, 0.0  # of ψ: with what is left over, its derivatives with place and height
    e, et, eh = 0.0, 0.0, 0.0  # the same of the section itself, which asks for the height
    for i in range(count):
        if bits[i]:
            continue
        x = places[i]
        at = min(max(x * unit + NODES, 0.0), 2 * NODES - 1e-9)
        node = int(at)
        psi = table[node] + (at - node) * (table[node + 1] - table[node])
        slant = bells[i] * x * inverse
        n += psi * rest[i]
        nt += psi * slant
        nh += psi * bells[i]
        e += bells[i] * rest[i]
        et += bells[i] * slant
        eh += bells[i] * bells[i]
    if eh > 0:
        n, nt = n - nh / eh * e, nt - nh / eh * et
    return n, max(nt, 0.0)


@njit(cache=True, nogil=True)
def averages(arc: Array, at: Array, sums: Array, window: float) -> Array:
    """At each point, (N, 3): the offset t in px, its variance, and the weight of all cuts it rests on.

    The offset is that of a straight line through the window's cuts: a window cut short has its middle elsewhere. It is
    as smooth as the window, so it is worked out at some points and lies on cubics between them (`core.image.filling`).
    """
    count, stride = len(arc), points_apart(window)
    found, weights = np.empty((count, 3)), cubic_weights(stride)
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


@njit(cache=True, nogil=True)
def _evenly_known(arc: Array, found: Array, first: int, stride: int) -> bool:
    """Whether there is no hole among four points `stride` apart, and their variances are much the same."""
    least, most = np.inf, 0.0
    for i in range(4):
        variance = found[first + i * stride, 1]
        least, most = min(least, variance), max(most, variance)
    return bool(arc[first + 3 * stride] - arc[first] < 3 * stride + 1 and most < 2 * least)


@njit(cache=True, nogil=True, fastmath={"contract", "reassoc", "arcp", "nsz"})
def _average(place: float, at: Array, sums: Array, window: float, found: Array) -> None:
    """The three figures `found` at one `place`."""
    reach, scale = 3 * window, 1 / window
    m0, m1, m2, n0, n1 = 0.0, 0.0, 0.0, 0.0, 0.0
    q0, q1, q2, support = 0.0, 0.0, 0.0, 0.0
    for c in range(np.searchsorted(at, place - reach), len(at)):
        if at[c] > place + reach:
            break
        if sums[c, 1] > 0:
            x = (at[c] - place) * scale
            w = _BELL[int(abs(x) * _BELL_STEPS + 0.5)]
            m, n = w * sums[c, 1], w * sums[c, 0]
            m0, m1, m2 = m0 + m, m1 + m * x, m2 + m * x * x
            n0, n1 = n0 + n, n1 + n * x
            m *= w
            q0, q1, q2 = q0 + m, q1 + m * x, q2 + m * x * x
            support += w
    determinant = m0 * m2 - m1 * m1
    found[0], found[1], found[2] = 0.0, np.inf, support
    if determinant > 1e-3 * m0 * m0:
        found[0] = (m2 * n0 - m1 * n1) / determinant
        found[1] = (m2 * m2 * q0 - 2 * m1 * m2 * q1 + m1 * m1 * q2) / (determinant * determinant)


@njit(cache=True, nogil=True, fastmath=True)
def cut_residuals(
    picture: Picture, state: NDArray[np.uint8], run: Array, cuts: Array, model: Array, half: int
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
            light = height * bell(0.5 * (x / width) ** 2)
            found[0, c, k] = picture[row, column] - background - slope * x - light
            found[1, c, k] = light
    return found
