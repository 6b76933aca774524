"""Points between the points of a run."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from core.model.arrays import Array

_HOLE = 2.6  # px from one point to the next; what lies in a hole is not known


@njit(cache=True, nogil=True)
def filled(run: Array) -> Array:
    """A run (N, 5) u, v, n_u, n_v, response traced at every second pixel, with points between its points.

    They lie on the cubic through the two neighbours on either side, or on the chord's parabola that the normals ask
    for where a neighbour is missing. What a filter of σ g leaves of noise is as smooth as g, so that for g > 2 px a
    point between differs from one that was looked for by less than 0.001 px.
    """
    count = len(run)
    out = np.empty((2 * count, 5))
    number = 0
    for k in range(count):
        out[number] = run[k]
        number += 1
        if k + 1 == count or _apart(run, k) > _HOLE:
            continue
        new, here, behind = out[number], run[k], run[k + 1]
        if k > 0 and k + 2 < count and _apart(run, k - 1) <= _HOLE and _apart(run, k + 1) <= _HOLE:
            for a in range(5):
                new[a] = (9 * (here[a] + behind[a]) - run[k - 1, a] - run[k + 2, a]) / 16
        else:
            for a in range(5):
                new[a] = 0.5 * (here[a] + behind[a])
            # tangents (−n_v, n_u) of Hermite's cubic, as long as the chord
            chord = _apart(run, k)
            new[0] += chord / 8 * (behind[3] - here[3])
            new[1] -= chord / 8 * (behind[2] - here[2])
        norm = math.hypot(new[2], new[3])
        new[2] /= norm
        new[3] /= norm
        number += 1
    return out[:number]


@njit(cache=True, nogil=True)
def _apart(run: Array, k: int) -> float:
    return math.hypot(run[k + 1, 0] - run[k, 0], run[k + 1, 1] - run[k, 1])
