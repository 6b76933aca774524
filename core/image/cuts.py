"""Rows and columns that cut a stripe, and what is left of their pixels; see `core.image.likelihood`."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.bell import bell
from core.image.marks import IGNORED, SATURATED
from core.image.seeds import Picture
from core.model.arrays import Array

_LARGEST_STEP = 2.5  # px between points; across larger gaps nothing is known
_UPRIGHT, _FLAT = 0.74, 0.67  # |n_u| at which columns give way to rows, and rows to columns


@njit(cache=True, nogil=True, error_model="numpy")
def cuts_of(run: Array, arc: Array) -> Array:
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


@njit(cache=True, nogil=True, error_model="numpy", fastmath=True)
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
