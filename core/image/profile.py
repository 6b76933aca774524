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

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from core.image.linking import IGNORED, SATURATED
from core.image.pieces import arc_length
from core.model.arrays import Array

_BINS_PER_PX = 2
_REACH = 3.2
"""Stripe σ looked at on either side; further out a neighbour that is still harmless would pass for a slope."""
_PIXEL_VARIANCE = 1 / 12
"""What integrating over a pixel adds to the variance of a cross-section."""
_UNKNOWNS = 5
_LONG_STRETCH = 20.0  # filter σ


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
    stride = max(1, round(filter_px))
    at = np.unique(np.append(np.arange(0, len(profiles.height), stride), len(profiles.height) - 1))
    every = np.arange(len(profiles.height))
    length = 2 * round(_LONG_STRETCH / 2 * filter_px / stride) + 1
    height, background, width = (
        np.interp(every, at, median_filter(values[at], length, mode="nearest"))
        for values in (profiles.height, profiles.background, profiles.width)
    )
    blurred = np.sqrt(width**2 + _PIXEL_VARIANCE)
    return Sections(height * width / blurred, blurred, background, profiles.slope)


def measure_profiles(
    picture: NDArray[np.float32], state: NDArray[np.uint8], run: Array, stripe_px: float, filter_px: float
) -> Profiles:
    """Cross-sections along a `run` (N, ≥ 4): u, v, n_u, n_v.

    They are measured every filter σ or so, freed of outliers by a running median, and interpolated.
    """
    arc = arc_length(run)
    stride = max(1, round(filter_px))
    at = np.unique(np.append(np.arange(0, len(run), stride), len(run) - 1))
    fits = _fit_all(picture, state, run[at, :4], stripe_px, filter_px)
    good = fits[:, 0] > 0
    if not good.any():
        flat = np.ones(len(run))
        return Profiles(0 * flat, 0 * flat, 0 * flat, np.inf * flat, stripe_px * flat)
    where = arc[at][good]
    height, background, slope, width = (median_filter(fits[good, k], 5, mode="nearest") for k in range(4))
    freed = np.sqrt(np.maximum(width**2 - _PIXEL_VARIANCE, 0.04))  # the pixel lowers what it widens
    # the slope moves the point itself, so it must be far less noisy than a point: average it over a long stretch
    long = max(3, 2 * round(_LONG_STRETCH / 2 * filter_px / stride) + 1)
    slope, slope_sigma = _running_mean(fits[good, 2], long)
    return Profiles(
        np.interp(arc, where, height * width / freed),
        np.interp(arc, where, background),
        np.interp(arc, where, slope),
        np.interp(arc, where, slope_sigma),
        np.interp(arc, where, freed),
    )


def _running_mean(values: Array, length: int) -> tuple[Array, Array]:
    """Mean over `length` neighbours (fewer at the ends) and its standard error, outliers clipped."""
    centre = np.median(values)
    spread = 1.4826 * np.median(np.abs(values - centre)) + 1e-12
    clipped = np.clip(values, centre - 4 * spread, centre + 4 * spread)
    kernel = np.ones(min(length, len(values)))
    count = np.convolve(np.ones(len(values)), kernel, "same")
    mean = np.convolve(clipped, kernel, "same") / count
    variance = np.maximum(np.convolve(clipped**2, kernel, "same") / count - mean**2, 0)
    # neighbours overlap by half: take every third as independent; a handful gives no standard error
    independent = count / 3
    error = np.where(independent >= 2, np.sqrt(variance / np.maximum(independent - 1, 0.5)), np.inf)
    return mean, error


@njit(cache=True, nogil=True, fastmath=True)
def _fit_all(
    picture: NDArray[np.float32], state: NDArray[np.uint8], places: Array, stripe_px: float, filter_px: float
) -> Array:
    """Fitted height, background, slope, width (K, 4) at `places` (K, 4); height 0 where the fit failed."""
    reach = _REACH * stripe_px + 1.0
    bins = 2 * math.ceil(reach * _BINS_PER_PX) + 1
    section = np.empty((3, bins))
    fits = np.zeros((len(places), 4))
    for k in range(len(places)):
        _gather(picture, state, places[k], reach, filter_px, section)
        fits[k] = _fit(section, stripe_px)
    return fits


@njit(cache=True, nogil=True, fastmath=True)
def _gather(
    picture: NDArray[np.float32], state: NDArray[np.uint8], place: Array, reach: float, filter_px: float, section: Array
) -> None:
    """Pixels around a place, sorted by their distance across the stripe: weight, mean distance, mean grey (3, K)."""
    height, width = picture.shape
    u, v, nu, nv = place[0], place[1], place[2], place[3]
    along_reach = 1.5 * filter_px
    middle = section.shape[1] // 2
    section[:] = 0.0
    half_u = math.ceil(abs(nu) * reach + abs(nv) * along_reach)
    half_v = math.ceil(abs(nv) * reach + abs(nu) * along_reach)
    column, row = int(u + 0.5), int(v + 0.5)
    for j in range(max(row - half_v, 0), min(row + half_v + 1, height)):
        for i in range(max(column - half_u, 0), min(column + half_u + 1, width)):
            along = -nv * (i - u) + nu * (j - v)
            across = nu * (i - u) + nv * (j - v)
            if abs(along) > along_reach or abs(across) > reach or state[j, i] & (SATURATED | IGNORED):
                continue
            k = middle + math.floor(across * _BINS_PER_PX + 0.5)
            section[0, k] += 1.0
            section[1, k] += across
            section[2, k] += picture[j, i]
    for k in range(section.shape[1]):
        if section[0, k] > 0:
            section[1, k] /= section[0, k]
            section[2, k] /= section[0, k]


@njit(cache=True, nogil=True, fastmath=True)
def _fit(section: Array, stripe_px: float) -> Array:
    """Gauss–Newton from the expected width: height, background, slope, width; zeros where it does not settle."""
    failed = np.zeros(4)
    low, high, left, right_side = np.inf, -np.inf, 0, 0
    for k in range(section.shape[1]):
        if section[0, k] > 0:
            low, high = min(low, section[2, k]), max(high, section[2, k])
            left += section[1, k] < -0.25 * stripe_px
            right_side += section[1, k] > 0.25 * stripe_px
    if (
        min(left, right_side) < 3 or left + right_side <= _UNKNOWNS or high <= low
    ):  # both flanks are needed, the top may be saturated
        return failed
    x = np.array([low, 0.0, high - low, 0.0, stripe_px])  # background, slope, height, centre, width
    for _ in range(8):
        normal = np.zeros((_UNKNOWNS, _UNKNOWNS))
        right = np.zeros(_UNKNOWNS)
        row = np.empty(_UNKNOWNS)
        for k in range(section.shape[1]):
            weight = section[0, k]
            if weight == 0.0:
                continue
            d = (section[1, k] - x[3]) / x[4]
            bell = math.exp(-0.5 * d * d)
            row[0], row[1], row[2] = 1.0, section[1, k], bell
            row[3], row[4] = x[2] * bell * d / x[4], x[2] * bell * d * d / x[4]
            residual = section[2, k] - x[0] - x[1] * section[1, k] - x[2] * bell
            for a in range(_UNKNOWNS):
                right[a] += weight * row[a] * residual
                for b in range(a + 1):
                    normal[a, b] += weight * row[a] * row[b]
        step = _solve(normal, right)
        step[3] = min(max(step[3], -0.5 * stripe_px), 0.5 * stripe_px)
        step[4] = min(max(step[4], -0.3 * x[4]), 0.5 * x[4])
        x += step
        if abs(step[3]) + abs(step[4]) < 1e-3 * stripe_px:
            break
    settled = x[2] > 0 and 0.3 * stripe_px < x[4] < 3 * stripe_px and abs(x[3]) < stripe_px
    return np.array([x[2], x[0], x[1], x[4]]) if settled else failed


@njit(cache=True, nogil=True, fastmath=True)
def _solve(normal: Array, right: Array) -> Array:
    """Solve by Cholesky from the lower triangle, lightly damped; zeros when it is singular."""
    size = len(right)
    for a in range(size):
        normal[a, a] *= 1 + 1e-9
        for b in range(a + 1):
            total = normal[a, b]
            for c in range(b):
                total -= normal[a, c] * normal[b, c]
            if a == b:
                if total <= 0.0:
                    return np.zeros(size)
                normal[a, a] = math.sqrt(total)
            else:
                normal[a, b] = total / normal[b, b]
    x = right.copy()
    for a in range(size):
        for b in range(a):
            x[a] -= normal[a, b] * x[b]
        x[a] /= normal[a, a]
    for a in range(size - 1, -1, -1):
        for b in range(a + 1, size):
            x[a] -= normal[b, a] * x[b]
        x[a] /= normal[a, a]
    return x
