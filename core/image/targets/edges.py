"""Sub-pixel edge points (the steepest places of grey profiles across an edge) and straight lines through them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates, spline_filter

from core.image.targets.picture import Picture
from core.model.arrays import Array
from core.model.robust import Schedule, Weigh, irls, mad_sd, median

STEP = 0.5
"""Distance of a profile's samples, in pixels."""

FILTER = 1.5
"""σ of the Gaussian derivative along the profile, in pixels: less leaves 0.02 px of pixel phase on sharp pictures."""

_WEIGHTS = Schedule(15, huber=0, tukey_at=4.7)
"""Of reweighting, from a start that half of the points cannot spoil."""
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
        """Interpolate grey levels at `uv` (…, 2) in px of the whole picture; NaN beyond the spline's part."""
        local = uv - self._origin
        inside = ((local >= 0) & (local <= self._limits)).all(axis=-1)
        levels = map_coordinates(
            self._coefficients, [local[..., 1], local[..., 0]], order=3, mode="mirror", prefilter=False
        )
        return np.where(inside, levels, np.nan)


def profiles(spline: PictureSpline, uv: Array, normal: Array, half_width: float, unit: float = 1.0) -> Profiles:
    """Find the edges on grey profiles through `uv` (K, 2) along `normal` (K, 2), which points from dark to bright.

    They are looked for within `half_width` px. Sampling and filter are in pixels times `unit`.
    """
    half, pitch = round(half_width / unit / STEP), STEP * unit
    t = np.arange(-half - _REACH, half + _REACH + 1) * pitch
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
        offset=(middle - half + shift) * pitch,
        steepness=top / unit,
        dark=levels[:, 4:10].mean(axis=1),
        bright=levels[:, -10:-4].mean(axis=1),
        fall=(np.maximum.accumulate(levels, axis=1) - levels).max(axis=1),
        valid=valid,
    )


@dataclass(frozen=True, eq=False, slots=True)
class Line:
    """Straight line normal · (X − middle) = 0, with the uncertainty of its place and direction.

    `sigma` is the points' spread about it, `variance_middle` that of the line's place at `middle`, `variance_angle`
    of its direction.
    """

    middle: Array
    normal: Array
    sigma: float
    variance_middle: float
    variance_angle: float

    @property
    def tangent(self) -> Array:
        """Unit vector (2,) along the line."""
        return np.array([-self.normal[1], self.normal[0]])


def fit_line(points: Array, candidates: NDArray[np.bool_], floor: float) -> Line | None:
    """Fit the line through most of `points` (N, 2), in order along it; None if fewer than 25 % or 10 of them agree.

    Least median of squares over pairs of points, then Tukey's biweight from there. Neighbouring points may share
    their error: the variances are raised by what the means of 16 neighbours show over what independent points would.

    Parameters
    ----------
    candidates
        (N,) points that may be used at all.
    floor
        Least spread to expect, in units of the points; keeps perfect data from rejecting itself.
    """
    chosen = np.flatnonzero(candidates)
    if len(chosen) < 10:
        return None
    xy = points[chosen]

    def too_few(weight: Array) -> bool:
        return bool(np.count_nonzero(weight) < 10)

    def improve(line: tuple[Array, Array, Array], weigh: Weigh) -> tuple[Array, Array, Array]:
        middle, normal, _ = line
        distance = (xy - middle) @ normal
        scale = max(mad_sd(distance - median(distance)), floor)
        weight = weigh(distance, scale)
        if too_few(weight):
            return middle, normal, weight
        middle = weight @ xy / weight.sum()
        centred = xy - middle
        return middle, np.linalg.eigh((centred * weight[:, None]).T @ centred)[1][:, 0], weight

    start = (*_least_median(xy), np.ones(len(xy)))
    middle, normal, weight = irls(start, improve, _WEIGHTS, lambda _, line: too_few(line[2]))
    used = weight > 0
    if used.sum() < max(10, 0.25 * len(points)):
        return None
    distance = ((xy - middle) @ normal)[used]
    along = ((xy - middle) @ np.array([-normal[1], normal[0]]))[used]
    sigma = float(np.sqrt((distance**2).sum() / (len(distance) - 2)))
    variance = sigma**2 * _correlation(distance)
    return Line(middle, normal, sigma, variance / len(distance), variance / float((along**2).sum()))


def meet(a: Line, b: Line) -> Array:
    """Compute the intersection (2,) of two lines."""
    normals = np.array([a.normal, b.normal])
    return np.asarray(np.linalg.solve(normals, [a.normal @ a.middle, b.normal @ b.middle]), dtype=np.float64)


def corner_covariance(lines: Sequence[Line]) -> Array:
    """Compute the covariance (K, 2, K, 2) of the corners of a polygon, corner k where line k − 1 meets line k.

    Neighbouring corners have an edge in common: its middle is known far better than its ends, which a turn of the
    line moves against each other.
    """
    count = len(lines)
    by_lines = np.zeros((count, 2, count, 2))
    for k in range(count):
        before, after = lines[k - 1], lines[k]
        point, back = meet(before, after), np.linalg.inv([before.normal, after.normal])
        for column, (index, line) in enumerate((((k - 1) % count, before), (k, after))):
            by_lines[k, :, index] = np.outer(back[:, column], [1.0, (point - line.middle) @ line.tangent])
    variance = np.array([[line.variance_middle, line.variance_angle] for line in lines])
    return np.asarray(np.einsum("aimn,mn,bjmn->aibj", by_lines, variance, by_lines), dtype=np.float64)


def _least_median(xy: Array) -> tuple[Array, Array]:
    """Middle and normal of the line, of 300 through two points of `xy`, with the least median distance."""
    third = max(1, len(xy) // 3)
    k = np.arange(300)
    first, second = xy[k * 7919 % third], xy[len(xy) - 1 - k * 6101 % third]
    direction = second - first
    length = np.linalg.norm(direction, axis=1, keepdims=True)
    normal = np.column_stack([direction[:, 1], -direction[:, 0]]) / np.maximum(length, 1e-12)
    sample = xy[:: max(1, len(xy) // 400)]
    distance = np.abs(sample @ normal.T - np.einsum("ij,ij->i", first, normal))
    medians = np.median(np.ascontiguousarray(distance.T), axis=1)  # columns are slow to put in order
    best = int(np.argmin(np.where(length[:, 0] > 0, medians, np.inf)))
    return (first[best] + second[best]) / 2, normal[best]


def _correlation(distance: Array) -> float:
    """Variance of means of 16 neighbours, over that of independent points; at least 1."""
    blocks, variance = len(distance) // 16, float(np.mean(distance**2))
    if blocks < 6 or variance == 0:  # a drawn picture, straight along the pixels, has no scatter at all
        return 1.0
    means = distance[: blocks * 16].reshape(blocks, 16).mean(axis=1)
    return max(1.0, float(16 * (means**2).sum() / (blocks - 2) / variance))
