"""Places of 3 × 3 px of a picture: which are not clipped, and what a plane through them leaves, as compiled loops."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.model.arrays import Array


@compiled()
def unclipped(picture: NDArray[np.float32], stride: int, darkest: float, brightest: float) -> NDArray[np.bool_]:
    """Flag the places of 3 × 3 px, each `stride` px from the next, all of which lie between two grey levels."""
    rows, columns = (picture.shape[0] - 3) // stride + 1, (picture.shape[1] - 3) // stride + 1
    kept = np.empty((rows, columns), np.bool_)
    for i in range(rows):
        for j in range(columns):
            inside = True
            for k in range(9):
                grey = picture[i * stride + k // 3, j * stride + k % 3]
                inside &= darkest < grey < brightest
            kept[i, j] = inside
    return kept


@compiled()
def flatness(picture: NDArray[np.float32], stride: int, keep: NDArray[np.bool_], added: Array) -> tuple[Array, Array]:
    """Mean level (N,) and variance (N,) that a plane leaves of the places of 3 × 3 px to `keep` (R, C).

    To their pixels `added` (9, N), 0 to 1, less a half, is added first.
    """
    level, variance = np.empty(added.shape[1]), np.empty(added.shape[1])
    place, n = np.empty(9), 0
    for i in range(keep.shape[0]):
        for j in range(keep.shape[1]):
            if not keep[i, j]:
                continue
            for k in range(9):
                place[k] = (added[k, n] - 0.5) + picture[i * stride + k // 3, j * stride + k % 3]
            mean = _sum_of_nine(place) / 9
            across = (place[2] - place[0]) + (place[5] - place[3]) + (place[8] - place[6])
            down = (place[6] - place[0]) + (place[7] - place[1]) + (place[8] - place[2])
            for k in range(9):
                place[k] = (place[k] - mean) * (place[k] - mean)
            level[n] = mean
            variance[n] = (_sum_of_nine(place) - (across * across + down * down) / 6) / 6
            n += 1
    return level, variance


@inlined()
def _sum_of_nine(values: Array) -> float:
    """Sum of nine values, in pairs: so rounding grows least."""
    left = (values[0] + values[1]) + (values[2] + values[3])
    right = (values[4] + values[5]) + (values[6] + values[7])
    return float((left + right) + values[8])
