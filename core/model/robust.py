"""Robust statistics: weights that limit the influence of outliers, and a scale that they cannot spoil.

References
----------
Huber, P. J., Robust estimation of a location parameter, Ann. Math. Statist. 35 (1964), doi:10.1214/aoms/1177703732.
Beaton, A. E., Tukey, J. W., The fitting of power series, meaning polynomials, illustrated on band-spectroscopic data,
Technometrics 16 (1974), doi:10.1080/00401706.1974.10489171.
"""

from __future__ import annotations

import numpy as np

from core.model.arrays import Array

HUBER = 1.345
"""Huber's limit in standard deviations: 95 % efficient for normal residuals."""
TUKEY = 4.685
"""Limit of Tukey's biweight in standard deviations: 95 % efficient for normal residuals."""
MAD_TO_SD = 1.4826
"""Standard deviation over median absolute deviation of a normal distribution: 1 / 0.6745."""


def huber_weights(residuals: Array, limit: float = HUBER) -> Array:
    """Huber's weights: 1 up to `limit`, beyond it limit / |residual|, so that no residual pulls harder than that.

    Parameters
    ----------
    residuals
        Any shape; signed or absolute.
    limit
        In the unit of the residuals.
    """
    return np.asarray(np.minimum(1.0, limit / np.maximum(np.abs(residuals), 1e-12)))


def tukey_weights(residuals: Array, limit: float | Array = TUKEY) -> Array:
    """Tukey's biweight, (1 − (residual / limit)²)² up to `limit` and 0 beyond; of any shape, both in the same unit."""
    return np.asarray(np.clip(1 - (residuals / limit) ** 2, 0.0, None) ** 2)


def mad_sd(residuals: Array) -> float:
    """Standard deviation of residuals about zero by their median absolute value: outliers up to a half do not count."""
    return MAD_TO_SD * median(np.abs(residuals))


def median(values: Array) -> float:
    """Median of values of any shape, NaN if one is or there are none.

    That of NumPy to the last bit, which takes 30 µs to begin. Compiled loops have `core.model.small_arrays.median_of`.
    """
    ordered = np.array(values, dtype=np.float64).ravel()
    count = len(ordered)
    if not count:
        return float("nan")
    low, high = (count - 1) // 2, count // 2
    ordered.partition((low, high, count - 1))  # NaN is last
    if np.isnan(ordered[-1]):
        return float("nan")
    return float(ordered[high] if low == high else (ordered[low] + ordered[high]) / 2)
