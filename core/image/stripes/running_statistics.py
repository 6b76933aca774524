"""Running medians and means along a stripe, compiled: on a thousand points NumPy takes longer to begin than to work."""

from __future__ import annotations

import math

from core.compiled import compiled, inlined
from core.model.arrays import Array
from core.model.robust import MAD_TO_SD
from core.model.small_arrays import first_not_below, median_of, new_row, row_of, smallest, sort, zero_table


@compiled()
def median(values: Array) -> float:
    """Compute the median of `values` (N,), N ≥ 1."""
    return median_of(values, 0, len(values))


@inlined()
def quantile_of_magnitudes(values: Array, share: float) -> float:
    """Compute the quantile `share` of the magnitudes |value| of `values` (N,)."""
    k = min(int(share * len(values)), len(values) - 1)
    sizes = new_row(len(values))
    for i in range(len(values)):
        sizes[i] = abs(values[i])
    return smallest(sizes, k)


@inlined()
def running_median(values: Array, length: int) -> Array:
    """Compute the median of the `length` (odd) values around each of `values` (N,), end values repeated beyond."""
    count, half = len(values), length // 2
    window = new_row(length)
    for k in range(length):
        window[k] = values[min(max(k - half, 0), count - 1)]
    sort(window)
    medians = new_row(count)
    for at in range(count):
        medians[at] = window[half]
        gone, new = values[max(at - half, 0)], values[min(at + half + 1, count - 1)]
        k = first_not_below(window, gone)
        while k + 1 < length and window[k + 1] < new:
            window[k] = window[k + 1]
            k += 1
        while k > 0 and window[k - 1] > new:
            window[k] = window[k - 1]
            k -= 1
        window[k] = new
    return medians


@inlined()
def running_mean(values: Array, length: int) -> tuple[Array, Array]:
    """Compute the mean over `length` (odd) neighbours, fewer at the ends, and its standard error, (N,) each.

    Outliers clipped.

    Two values give no standard error: it is infinite.
    """
    count, half = len(values), length // 2
    centre = median_of(values, 0, count)
    mean, error = new_row(count), row_of(count, math.inf)
    for k in range(count):
        mean[k] = abs(values[k] - centre)
    spread = MAD_TO_SD * median_of(mean, 0, count) + 1e-12
    sums = zero_table(count + 1, 2)
    for k in range(count):
        away = min(max(values[k] - centre, -4 * spread), 4 * spread)
        sums[k + 1, 0], sums[k + 1, 1] = sums[k, 0] + away, sums[k, 1] + away * away
    for k in range(count):
        first, last = max(k - half, 0), min(k + half + 1, count)
        number = last - first
        away = (sums[last, 0] - sums[first, 0]) / number
        variance = max((sums[last, 1] - sums[first, 1]) / number - away * away, 0.0)
        mean[k] = centre + away
        if number >= 3:
            error[k] = math.sqrt(variance / (number - 1))
    return mean, error
