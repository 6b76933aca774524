"""What the cuts of a stripe say, averaged over a Gaussian window along it; see `core.image.likelihood`."""

from __future__ import annotations

import numpy as np
from numba import njit

from core.image.filling import cubic_weights, points_apart
from core.model.arrays import Array

_BELL_STEPS = 64  # per σ
_BELL = np.exp(-0.5 * (np.arange(3 * _BELL_STEPS + 2) / _BELL_STEPS) ** 2)


@njit(cache=True, nogil=True, error_model="numpy")
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


@njit(cache=True, nogil=True, error_model="numpy")
def _evenly_known(arc: Array, found: Array, first: int, stride: int) -> bool:
    """Whether there is no hole among four points `stride` apart, and their variances are much the same."""
    least, most = np.inf, 0.0
    for i in range(4):
        variance = found[first + i * stride, 1]
        least, most = min(least, variance), max(most, variance)
    return bool(arc[first + 3 * stride] - arc[first] < 3 * stride + 1 and most < 2 * least)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "reassoc", "arcp", "nsz"})
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
