"""Contrast and grain of the speckle on a stripe, measured from the stripe itself.

What pixels differ from the smooth stripe, r, is white noise and grains of light. Neighbours share grains but no white
noise, so products of neighbours, relative to the stripe's m there, show the speckle alone:

    Σ r(i)·r(i + k) / Σ m(i)·m(i + k) = C²·exp(−k²/grain²)

A section that is not quite the model's, and brightness that changes along the stripe, are taken off before.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from core.compiled import compiled, inlined
from core.image.stripes.running_statistics import running_median
from core.model.arrays import Array
from core.model.small_arrays import median_of, new_row, new_table, row_of, zero_table

# Limits of what is measured. Held by tests/image/stripes/likelihood/test_refinement.py (speckle is measured, neither
# noise nor a section) on speckle of known contrast and grain and on stripes without any.
_SMALLEST_GRAIN_PX = 0.8  # finer grains are averaged within a pixel
_COARSEST_GRAIN = 3.0  # stripe σ: coarser changes count as brightness
_LARGEST_CONTRAST = 1.0  # of fully developed speckle (Goodman, Speckle Phenomena in Optics)
_SIGNIFICANT = 4.0  # standard errors of white noise: less is no speckle
_LEAST_CUTS = 30  # of a stripe that is asked
_LEVEL_CUTS = 41  # cuts: length of the running median that brightness is levelled by
_OUTLIER = 6.0  # median deviations, four standard ones: larger residuals are cut down
_MEDIAN_SAMPLE = 4  # every so many cuts tell that median; saves time
_LAGS = 3  # distances in px of the pixels multiplied: 0, 1 and 2


class Speckle(NamedTuple):
    """Speckle of a stripe: contrast, standard deviation over mean as pixels see it.

    1/e half-width in px of its correlation.
    """

    contrast: float
    grain_px: float


NO_SPECKLE = Speckle(0.0, 0.0)
"""What is returned where none is significant."""


def measure_speckle(stripes: list[Array], width_px: float) -> Speckle:
    """Measure contrast and extent of the laser speckle on stripes, from residuals of neighbouring cuts across them.

    Parameters
    ----------
    stripes
        (2, K, W) for each stripe: residuals and model of K cuts in order, of W pixels; zeros where one cannot be used.
    width_px
        σ of the stripes; speckle is not much coarser than they are wide.
    """
    sums = np.zeros((_LAGS, 2))
    square, number = 0.0, 0.0
    for seen, m in stripes:
        if len(seen) < _LEAST_CUTS:
            continue
        r = _levelled(seen, m)
        sums += _products(r, m)
        square += float(np.vdot(r, r))
        number += float(np.count_nonzero(m))
    if not np.all(sums[:, 1] > 0):
        return NO_SPECKLE
    share = sums[:, 0] / sums[:, 1]
    error = square / number**0.5 / sums[1, 1]  # of white noise
    if not share[1] > _SIGNIFICANT * error:
        return NO_SPECKLE
    fall = math.log(share[1] / share[2]) if share[2] > 0 else math.inf
    grain = math.sqrt(3 / fall) if fall > 0 else math.inf
    grain = min(max(grain, _SMALLEST_GRAIN_PX), _COARSEST_GRAIN * width_px)
    contrast = math.sqrt(float(share[1])) * math.exp(0.5 / grain**2)
    return Speckle(min(contrast, _LARGEST_CONTRAST), grain)


@compiled(fastmath=True)
def _products(r: Array, m: Array) -> Array:
    """Sums of products of neighbours in each cut, of residuals and of the model, (_LAGS, 2)."""
    sums, width = zero_table(_LAGS, 2), m.shape[1]
    for c in range(len(m)):
        for lag in range(_LAGS):
            for i in range(width - lag):
                sums[lag, 0] += r[c, i] * r[c, i + lag]
                sums[lag, 1] += m[c, i] * m[c, i + lag]
    return sums


@compiled(fastmath=True)
def _levelled(r: Array, m: Array) -> Array:
    """Residuals freed of brightness that changes along the stripe, of the section's shape, and of what stands out."""
    cuts, width = m.shape
    height, levelled = new_row(cuts), new_table(cuts, width)
    for c in range(cuts):
        product, square = 0.0, 1e-9
        for i in range(width):
            product += r[c, i] * m[c, i]
            square += m[c, i] * m[c, i]
        height[c] = product / square
    height = running_median(height, _LEVEL_CUTS)
    shape, light = row_of(width, 0.0), row_of(width, 0.0)
    for c in range(cuts):
        for i in range(width):
            levelled[c, i] = r[c, i] - height[c] * m[c, i]
            shape[i] += levelled[c, i] * m[c, i]
            light[i] += m[c, i] * m[c, i]
    for c in range(cuts):
        for i in range(width):
            levelled[c, i] -= shape[i] / max(light[i], 1e-9) * m[c, i]
    limit = _OUTLIER * _median_share(levelled, m)
    for c in range(cuts):
        for i in range(width):
            levelled[c, i] = min(max(levelled[c, i], -limit * m[c, i]), limit * m[c, i])
    return levelled


@inlined()
def _median_share(r: Array, m: Array) -> float:
    """Median of |r/m| where m > 0, of a sample of the cuts; 1 if that is nowhere."""
    shares, count = new_row(len(m) * m.shape[1]), 0
    for c in range(0, len(m), _MEDIAN_SAMPLE):
        for i in range(m.shape[1]):
            if m[c, i] > 0:
                shares[count] = abs(r[c, i]) / m[c, i]
                count += 1
    return median_of(shares, 0, count) if count else 1.0
