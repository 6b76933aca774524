"""The light's cross-section beside a line point: height, background and its slope, width freed of the filter.

A Gaussian on a sloping background, I(x) = B + b·x + A·exp(−(x − t)²/2s²) with x across the stripe, is fitted to the
picture's own pixels (not the filtered ones), gathered over a short stretch of the stripe. Saturated pixels are left
out of the fit. What it gives serves for the width and for the correction of the asymmetric background.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930, §5 (width
and asymmetry; there for bar-shaped lines).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.image.pieces import arc_length
from core.image.running import running_mean, running_median
from core.image.section_fit import fit_sections
from core.image.seeds import Picture
from core.model.arrays import Array

_PIXEL_VARIANCE = 1 / 12
"""What integrating over a pixel adds to the variance of a cross-section."""
_STRIDE = 2.0  # filter σ from one fit to the next, so that each pixel is used once
_SHORT_STRETCH, _LONG_STRETCH = 6.0, 20.0  # filter σ


@dataclass(frozen=True, eq=False, slots=True)
class Profiles:
    """Cross-sections at every point of a run, (N,) each: grey levels, grey levels per pixel, pixels."""

    height: Array
    background: Array
    slope: Array
    slope_sigma: Array
    width: Array

    def select(self, part: slice) -> Profiles:
        """The cross-sections of a part of the run."""
        return Profiles(
            self.height[part], self.background[part], self.slope[part], self.slope_sigma[part], self.width[part]
        )


class Sections(NamedTuple):
    """The model of a stripe's light at every point, (N,) each: height and σ as pixels blur them, background, slope."""

    height: Array
    width: Array
    background: Array
    slope: Array


def smooth_sections(profiles: Profiles, filter_px: float) -> Sections:
    """Medians of the cross-sections along the stripe, over many grains of speckle, blurred by the pixel."""
    at, stride = _places(len(profiles.height), filter_px)
    every = np.arange(len(profiles.height))
    length = _odd(_LONG_STRETCH * filter_px / stride)
    height, background, width = (
        np.interp(every, at, running_median(values[at], length))
        for values in (profiles.height, profiles.background, profiles.width)
    )
    blurred = np.sqrt(width**2 + _PIXEL_VARIANCE)
    return Sections(height * width / blurred, blurred, background, profiles.slope)


def measure_profiles(
    picture: Picture, state: NDArray[np.uint8], run: Array, stripe_px: float, filter_px: float
) -> Profiles:
    """Cross-sections along a `run` (N, ≥ 4): u, v, n_u, n_v.

    They are measured every two filter σ or so, freed of outliers by a running median, and interpolated.
    """
    arc = arc_length(run)
    at, stride = _places(len(run), filter_px)
    fits = fit_sections(picture, state, run[at, :4], stripe_px, _STRIDE / 2 * filter_px)
    good = fits[:, 0] > 0
    if not good.any():
        flat = np.ones(len(run))
        return Profiles(0 * flat, 0 * flat, 0 * flat, np.inf * flat, stripe_px * flat)
    where, fits = arc[at][good], fits[good]
    short, long = (_odd(stretch * filter_px / stride) for stretch in (_SHORT_STRETCH, _LONG_STRETCH))
    height, background, width = (running_median(fits[:, k], short) for k in (0, 1, 3))
    freed = np.sqrt(np.maximum(width**2 - _PIXEL_VARIANCE, 0.04))  # the pixel lowers what it widens
    # the slope moves the point itself, so it must be far less noisy than a point: average it over a long stretch
    slope, slope_sigma = running_mean(fits[:, 2], long)
    return Profiles(
        np.interp(arc, where, height * width / freed),
        np.interp(arc, where, background),
        np.interp(arc, where, slope),
        np.interp(arc, where, slope_sigma),
        np.interp(arc, where, freed),
    )


def _places(count: int, filter_px: float) -> tuple[NDArray[np.int64], int]:
    """The points of a run of `count` whose cross-sections are measured, and how many it is from one to the next."""
    stride = max(1, round(_STRIDE * filter_px))
    return np.append(np.arange(0, count - 1, stride), count - 1), stride


def _odd(length: float) -> int:
    """The odd number nearest to `length`, at least 3."""
    return max(3, 2 * int(length / 2) + 1)
