"""Several measurements of one thickness: how they scatter, and how far they are from the nominal value.

References
----------
Sun et al., Sensors 2023, 23, 13, §5.3.2, Tables 1 and 2, doi:10.3390/s23010013.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class RepeatStatistics:
    """What `n` measurements of one thickness say together, in mm.

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
    """Mean, error, RMSE, standard deviation and largest error of repeated `thicknesses` in mm.

    Raises
    ------
    ValueError
        If there is no thickness, or one is not a finite number.
    """
    values = np.asarray(thicknesses, dtype=np.float64)
    if values.ndim != 1 or not len(values) or not np.isfinite(values).all():
        raise ValueError("repeats need one finite thickness or more")
    mean = float(values.mean())
    std = float(values.std(ddof=1)) if len(values) > 1 else float("nan")
    if nominal_mm is None:
        return RepeatStatistics(len(values), mean, None, None, std, None)
    errors = values - nominal_mm
    rmse, largest = float(np.sqrt(np.mean(errors**2))), float(np.abs(errors).max())
    return RepeatStatistics(len(values), mean, mean - nominal_mm, rmse, std, largest)
