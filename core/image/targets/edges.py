"""Sub-pixel edge points: the steepest place of the grey profile across an edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates, spline_filter

from core.image.targets.picture import Picture
from core.model.arrays import Array

STEP = 0.5
"""Distance of a profile's samples, in pixels."""

FILTER = 1.5
"""σ of the Gaussian derivative along the profile, in pixels: less leaves 0.02 px of pixel phase on sharp pictures."""

_REACH = round(3 * FILTER / STEP)
"""Samples on either side that the filter takes in."""


@dataclass(frozen=True, eq=False, slots=True)
class Profiles:
    """Grey profiles across an edge.

    `offset` (K,) in pixels along the normal to the steepest rise; `steepness` (K,) its slope in grey levels per pixel;
    `dark`, `bright` (K,) the levels at either end of the profile; `fall` (K,) by how much the level drops again on the
    way from dark to bright, which a mere edge does by its noise only; `valid` (K,) False where it leaves the picture
    or where the steepest place is at its end.
    """

    offset: Array
    steepness: Array
    dark: Array
    bright: Array
    fall: Array
    valid: NDArray[np.bool_]


class PictureSpline:
    """A part of a picture as a cubic spline, to be sampled anywhere."""

    def __init__(self, picture: Picture, around: Array, margin: float) -> None:
        low = np.floor(around.min(axis=0) - margin - 4).astype(int).clip(0)
        high = np.ceil(around.max(axis=0) + margin + 4).astype(int) + 1
        part = picture[low[1] : max(high[1], 0), low[0] : max(high[0], 0)]
        self._origin = low.astype(np.float64)
        self._limits = np.array(part.shape[::-1], dtype=np.float64) - 1
        self._coefficients = spline_filter(part.astype(np.float64), order=3, mode="mirror")

    def at(self, uv: Array) -> Array:
        """Grey levels at `uv` (…, 2) in pixels of the whole picture; NaN outside the part."""
        local = uv - self._origin
        inside = ((local >= 0) & (local <= self._limits)).all(axis=-1)
        levels = map_coordinates(
            self._coefficients, [local[..., 1], local[..., 0]], order=3, mode="mirror", prefilter=False
        )
        return np.where(inside, levels, np.nan)


def profiles(spline: PictureSpline, uv: Array, normal: Array, half_width: float) -> Profiles:
    """Profiles through `uv` (K, 2) along the unit vectors `normal` (K, 2), which point from dark to bright."""
    half = round(half_width / STEP)
    t = np.arange(-half - _REACH, half + _REACH + 1) * STEP
    levels = spline.at(uv[:, None, :] + t[None, :, None] * normal[:, None, :])
    taps = np.arange(-_REACH, _REACH + 1) * STEP
    kernel = taps / FILTER**2 * np.exp(-0.5 * (taps / FILTER) ** 2)
    kernel /= (kernel * taps).sum()  # slope of a ramp is exact
    windows = np.lib.stride_tricks.sliding_window_view(levels, len(taps), axis=1)
    slope = windows @ kernel
    valid = np.isfinite(slope).all(axis=1)
    slope = np.where(valid[:, None], slope, 0.0)
    peak = slope.argmax(axis=1)
    valid &= (peak > 0) & (peak < slope.shape[1] - 1)
    middle = peak.clip(1, slope.shape[1] - 2)
    rows = np.arange(len(uv))
    before, top, after = slope[rows, middle - 1], slope[rows, middle], slope[rows, middle + 1]
    bend = before - 2 * top + after
    valid &= (top > 0) & (bend < 0)
    shift = np.where(valid, 0.5 * (before - after) / np.where(valid, bend, -1.0), 0.0)
    return Profiles(
        offset=(middle - half + shift) * STEP,
        steepness=top,
        dark=levels[:, 4:10].mean(axis=1),
        bright=levels[:, -10:-4].mean(axis=1),
        fall=(np.maximum.accumulate(levels, axis=1) - levels).max(axis=1),
        valid=valid,
    )
