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

from core.image.running import median, running_median
from core.model.arrays import Array

_COARSEST = 3.0  # stripe σ
_FEWEST_CUTS = 30
_LEVEL_CUTS = 41
_OUTLIER = 6.0  # median deviations, four standard ones
_SIGNIFICANT = 4.0
_SMALLEST_GRAIN_PX = 0.8
_LARGEST_CONTRAST = 1.0


class Speckle(NamedTuple):
    """Contrast (standard deviation over mean) as pixels see it; 1/e half-width of the grains' correlation in px."""

    contrast: float
    grain_px: float


NO_SPECKLE = Speckle(0.0, 0.0)


def measure_speckle(stripes: list[Array], width_px: float) -> Speckle:
    """Speckle on stripes seen in cuts of neighbouring pixels.

    Parameters
    ----------
    stripes
        (2, K, W) for each stripe: residuals and model of K cuts in order, of W pixels; zeros where one is of no use.
    width_px
        σ of the stripes; speckle is not much coarser than they are wide.
    """
    sums = np.zeros((3, 2))
    square, number = 0.0, 0.0
    for seen, m in stripes:
        if len(seen) < _FEWEST_CUTS:
            continue
        r = _levelled(seen, m)
        for lag in range(3):
            width = m.shape[1] - lag
            sums[lag] += [float(np.sum(p[:, :width] * p[:, lag:])) for p in (r, m)]
        square += float(np.sum(r**2))
        number += float(np.count_nonzero(m))
    if not np.all(sums[:, 1] > 0):
        return NO_SPECKLE
    share = sums[:, 0] / sums[:, 1]
    error = square / number**0.5 / sums[1, 1]  # of white noise
    if not share[1] > _SIGNIFICANT * error:
        return NO_SPECKLE
    fall = math.log(share[1] / share[2]) if share[2] > 0 else math.inf
    grain = math.sqrt(3 / fall) if fall > 0 else math.inf
    grain = min(max(grain, _SMALLEST_GRAIN_PX), _COARSEST * width_px)
    contrast = math.sqrt(float(share[1])) * math.exp(0.5 / grain**2)
    return Speckle(min(contrast, _LARGEST_CONTRAST), grain)


def _levelled(r: Array, m: Array) -> Array:
    """Residuals freed of brightness that changes along the stripe, of the section's shape, and of what stands out."""
    height = np.sum(r * m, axis=1) / np.maximum(np.sum(m**2, axis=1), 1e-9)
    levelled = r - running_median(height, _LEVEL_CUTS)[:, None] * m
    levelled -= np.sum(levelled * m, axis=0) / np.maximum(np.sum(m**2, axis=0), 1e-9) * m
    seen = m > 0
    limit = _OUTLIER * median(np.abs(levelled[seen]) / m[seen]) * m if seen.any() else m
    clipped: Array = np.clip(levelled, -limit, limit)
    return clipped
