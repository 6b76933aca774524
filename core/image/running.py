"""Running medians along a stripe."""

from __future__ import annotations

import numpy as np
from numba import njit

from core.model.arrays import Array


@njit(cache=True, nogil=True)
def running_median(values: Array, length: int) -> Array:
    """Median of the `length` (odd) values around each of `values` (N,); the first and last go on beyond the ends."""
    count, half = len(values), length // 2
    window = np.empty(length)
    for k in range(length):
        window[k] = values[min(max(k - half, 0), count - 1)]
    window.sort()
    medians = np.empty(count)
    for at in range(count):
        medians[at] = window[half]
        gone, new = values[max(at - half, 0)], values[min(at + half + 1, count - 1)]
        k = np.searchsorted(window, gone)
        while k + 1 < length and window[k + 1] < new:
            window[k] = window[k + 1]
            k += 1
        while k > 0 and window[k - 1] > new:
            window[k] = window[k - 1]
            k -= 1
        window[k] = new
    return medians
