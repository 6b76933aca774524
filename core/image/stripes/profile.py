"""Cross-section of the light at a line point: height, background and its slope, width without the filter's.

A Gaussian on a sloping background, I(x) = B + b·x + A·exp(−(x − t)²/2s²) with x across the stripe, is fitted to the
picture's own pixels (not the filtered ones), gathered over a short stretch of the stripe. Saturated pixels are left
out of the fit. It gives the width, and the correction for an asymmetric background.

References
----------
Steger, C., An unbiased detector of curvilinear structures, IEEE PAMI 20 (1998), doi:10.1109/34.659930, §5 (width
and asymmetry; there for bar-shaped lines).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.stripes.running_statistics import running_mean, running_median
from core.image.stripes.runs import arc_length
from core.image.stripes.section_fit import fit_sections
from core.image.stripes.stripe import PIXEL_VARIANCE
from core.image.stripes.tracing.seeds import Picture
from core.model.arrays import Array
from core.model.small_arrays import column, new_row, new_table

# Lengths along the stripe in filter σ. Held by tests/image/stripes/test_extraction.py (width and strength, sloping
# background) on speckled stripes and on steps of the width.
_STRIDE = 2.0  # from one fit to the next, so that each pixel is used once
_SHORT_STRETCH = 6.0  # of the running median of height, background and width
_LONG_STRETCH = 20.0  # of the mean of the slope, which moves the point itself, and of what the likelihood is given

_LEAST_VARIANCE = 0.04  # px²: a light narrower than σ = 0.2 px cannot be told from a pixel


@dataclass(frozen=True, eq=False, slots=True)
class Profiles:
    """Cross-sections at every point of a run, (N,) each.

    Height, background in grey levels; its slope across the stripe and the slope's standard uncertainty in grey levels
    per px; width as Gaussian σ in px; skewness, positive where the light reaches further towards the normal.
    """

    height: Array
    background: Array
    slope: Array
    slope_sigma: Array
    width: Array
    skewness: Array

    def select(self, part: slice) -> Profiles:
        """Select the cross-sections of those points of the run that are in the slice `part`."""
        return Profiles(
            self.height[part],
            self.background[part],
            self.slope[part],
            self.slope_sigma[part],
            self.width[part],
            self.skewness[part],
        )


class Sections(NamedTuple):
    """Model of a stripe's light at every point, (N,) each.

    Height in grey levels and σ in px, both as blurred by the pixel; background in grey levels; its slope in grey levels
    per px.
    """

    height: Array
    width: Array
    background: Array
    slope: Array


class Fits(NamedTuple):
    """Cross-sections fitted at some points of a run: their numbers (K,), and what was fitted.

    `figures` (K, 5): height, background, slope, width, skewness.
    """

    at: NDArray[np.int64]
    figures: Array


def smooth_sections(profiles: Profiles, filter_px: float) -> Sections:
    """Smooth the cross-sections of a run along it, by medians that speckle does not disturb."""
    stride = _stride(filter_px)
    at, length = _places(len(profiles.height), stride), _odd(_LONG_STRETCH * filter_px / stride)
    height, background, width = _smoothed(profiles.height, profiles.background, profiles.width, at, length)
    return Sections(height, width, background, profiles.slope)


def measure_profiles(
    picture: Picture, state: NDArray[np.uint8], run: Array, stripe_px: float, filter_px: float
) -> Profiles:
    """Measure height, background, width and skewness of a stripe across each point of a `run` (N, ≥ 4)."""
    fits = fit_profiles(picture, state, run, stripe_px, filter_px)
    return profiles_along(arc_length(run), slice(0, len(run)), fits, stripe_px, filter_px)


def fit_profiles(picture: Picture, state: NDArray[np.uint8], run: Array, stripe_px: float, filter_px: float) -> Fits:
    """Fit cross-sections at points of a `run` (N, ≥ 4) two filter σ apart; points whose fit fails are left out."""
    at = _places(len(run), _stride(filter_px))
    fits = fit_sections(picture, state, run[at, :4], stripe_px, _STRIDE / 2 * filter_px)
    good = fits[:, 0] > 0
    return Fits(at, fits) if good.all() else Fits(at[good], fits[good])


def profiles_along(arc: Array, part: slice, fits: Fits, stripe_px: float, filter_px: float) -> Profiles:
    """Interpolate the cross-sections of `fits` to every point of a `part` of a run, from those within that part alone.

    A running median removes outliers first; `arc` (N,) is the length along the run in px.
    """
    arc = arc[part]
    first, last = np.searchsorted(fits.at, (part.start, part.stop))
    if first == last:
        flat = np.ones(len(arc))
        return Profiles(0 * flat, 0 * flat, 0 * flat, np.inf * flat, stripe_px * flat, 0 * flat)
    stride = _stride(filter_px)
    short, long = (_odd(stretch * filter_px / stride) for stretch in (_SHORT_STRETCH, _LONG_STRETCH))
    return Profiles(*_along(arc, fits.at[first:last] - part.start, fits.figures[first:last], short, long))


@compiled()
def _along(arc: Array, at: NDArray[np.int64], figures: Array, short: int, long: int) -> Array:
    """Height, background, slope, its σ, width and skewness (6, N) from those fitted at some of the points."""
    smooth, places = new_table(6, len(at)), new_row(len(at))
    height, background = running_median(column(figures, 0), short), running_median(column(figures, 1), short)
    width = running_median(column(figures, 3), short)
    # the slope moves the point itself, so it must be far less noisy than a point: average it over a long stretch
    slope, slope_sigma = running_mean(column(figures, 2), long)
    skewness, _ = running_mean(column(figures, 4), long)
    for k in range(len(at)):
        without_pixel = math.sqrt(max(width[k] * width[k] - PIXEL_VARIANCE, _LEAST_VARIANCE))
        smooth[0, k] = height[k] * (width[k] / without_pixel)  # the pixel lowers what it widens
        smooth[1, k], smooth[2, k], smooth[3, k] = background[k], slope[k], slope_sigma[k]
        smooth[4, k], smooth[5, k], places[k] = without_pixel, skewness[k], arc[at[k]]
    return _interpolated(arc, places, smooth)


@compiled()
def _smoothed(height: Array, background: Array, width: Array, at: NDArray[np.int64], length: int) -> Array:
    """Height, background and width (3, N), both as pixels blur them, from running medians at some of the points."""
    smooth, places, numbers = new_table(3, len(at)), new_row(len(at)), new_row(len(height))
    picked = new_row(len(at))
    for row, values in enumerate((height, background, width)):
        for k in range(len(at)):
            picked[k] = values[at[k]]
        middle = running_median(picked, length)
        for k in range(len(at)):
            smooth[row, k] = middle[k]
    for k in range(len(at)):
        places[k] = at[k]
    for k in range(len(height)):
        numbers[k] = k
    found = _interpolated(numbers, places, smooth)
    for k in range(len(height)):
        blurred = math.sqrt(found[2, k] * found[2, k] + PIXEL_VARIANCE)
        found[0, k] *= found[2, k] / blurred
        found[2, k] = blurred
    return found


@inlined()
def _interpolated(x: Array, at: Array, values: Array) -> Array:
    """Figures (C, N) at rising `x`, on straight lines between `values` (C, K) at rising places; level beyond them."""
    found = new_table(len(values), len(x))
    k = 0
    for i in range(len(x)):
        while k + 1 < len(at) and at[k + 1] < x[i]:
            k += 1
        behind = min(k + 1, len(at) - 1)
        step = at[behind] - at[k]
        share = min(max((x[i] - at[k]) / step, 0.0), 1.0) if step > 0 else 0.0
        for c in range(len(values)):
            here = values[c, k]
            found[c, i] = here + share * (values[c, behind] - here) if share > 0 else here  # an infinite σ stays one
    return found


def _stride(filter_px: float) -> int:
    """How many points it is from one whose cross-section is measured to the next."""
    return max(1, round(_STRIDE * filter_px))


def _places(count: int, stride: int) -> NDArray[np.int64]:
    """Every `stride`-th of `count` points, and the last."""
    at = np.arange(0, count - 1 + stride, stride, dtype=np.int64)
    at[-1] = count - 1
    return at


def _odd(length: float) -> int:
    """The odd number nearest to `length`, at least 3."""
    return max(3, 2 * int(length / 2) + 1)
