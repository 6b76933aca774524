"""Several measurements of one quantity: how they scatter, and how far they are from the nominal value.

The scan is the independent unit, not the point: n repeats are n scans.

References
----------
Sun et al., Sensors 2023, 23, 13, §5.3.2, Tables 1 and 2, doi:10.3390/s23010013.
ISO 7870-2:2013 (control chart of individual values).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import WrongValue
from core.messages import Message
from core.model.arrays import Array

MOST_BINS = 20
"""Of a histogram: more cannot be told apart in the drawing."""
TO_LIMITS = 2.66
"""3/d₂ with d₂ = 1.128 of two values: from the mean moving range to three standard deviations (ISO 7870-2)."""


@dataclass(frozen=True, slots=True)
class RepeatStatistics:
    """Statistics of `n` measurements of one thickness, in mm.

    `error_mm` is mean − nominal, `rmse_mm` the root mean square of the single errors (over n), `largest_error_mm` the
    largest magnitude of one; all None without a nominal value. `std_mm` is the standard deviation of a single
    measurement about the mean (over n − 1), NaN for one measurement alone.
    """

    n: int
    mean_mm: float
    error_mm: float | None
    rmse_mm: float | None
    std_mm: float
    largest_error_mm: float | None


def repeat_statistics(thicknesses: Sequence[float], nominal_mm: float | None = None) -> RepeatStatistics:
    """Compute mean, error, RMSE, standard deviation and largest error of repeated `thicknesses` in mm.

    Raises
    ------
    WrongValue
        If there is no thickness, or one is not a finite number.
    """
    values = np.asarray(thicknesses, dtype=np.float64)
    if values.ndim != 1 or not len(values) or not np.isfinite(values).all():
        raise WrongValue(Message("study.no_repeats", "repeats need one finite thickness or more"))
    mean = float(values.mean())
    std = float(values.std(ddof=1)) if len(values) > 1 else float("nan")
    if nominal_mm is None:
        return RepeatStatistics(len(values), mean, None, None, std, None)
    errors = values - nominal_mm
    rmse, largest = float(np.sqrt(np.mean(errors**2))), float(np.abs(errors).max())
    return RepeatStatistics(len(values), mean, mean - nominal_mm, rmse, std, largest)


@dataclass(frozen=True, eq=False, slots=True)
class RunChart:
    """Chart of values in their order: centre line, limits, and values outside.

    Parameters
    ----------
    centre
        Their mean.
    lower, upper
        centre ∓ 2.66 mean moving range: limits that a steady measurement seldom leaves.
    outside
        Indices of the values beyond them.
    """

    centre: float
    lower: float
    upper: float
    outside: tuple[int, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Histogram:
    """Numbers of values (`counts`, B) between the `edges` (B + 1)."""

    edges: Array
    counts: NDArray[np.int64]


def run_chart(values: Array) -> RunChart | None:
    """Compute centre line, limits and values outside of a run chart of `values` (n,) in time order; None if n < 2."""
    if len(values) < 2:
        return None
    centre = float(values.mean())
    reach = TO_LIMITS * float(np.abs(np.diff(values)).mean())
    outside = np.flatnonzero(np.abs(values - centre) > reach * (1 + 1e-9))
    return RunChart(centre, centre - reach, centre + reach, tuple(int(place) for place in outside))


def histogram(values: Array) -> Histogram:
    """Count `values` (n,) in bins of equal width (Freedman, Diaconis 1981, or Sturges 1926), at most MOST_BINS."""
    if not np.ptp(values):
        counts, edges = np.histogram(values, 1)
    else:
        bins = min(len(np.histogram_bin_edges(values, "auto")) - 1, MOST_BINS)
        counts, edges = np.histogram(values, bins)
    return Histogram(np.asarray(edges, dtype=np.float64), np.asarray(counts, dtype=np.int64))
