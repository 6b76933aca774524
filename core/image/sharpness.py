"""Sharpness of a picture at the marks of a target."""

from __future__ import annotations

import cv2
import numpy as np
from scipy.spatial import cKDTree

from core.image.targets.picture import Picture
from core.model.arrays import Array

SMOOTHING_PX = 1.0
"""σ of the Gaussian that keeps noise from passing for a steep edge; its variance is subtracted from the result."""

_DIFFERENCE_VARIANCE = 4 / 12
"""Variance in px² of the central difference, which averages over two pixels: 2²/12."""

# Chosen by the time this takes with each live picture: tests/image/test_sharpness.py holds them.
_MOST_MARKS = 40  # marks looked at
_SMALLEST_REACH, _LARGEST_REACH = 4, 32  # px around a mark


def edge_blur_px(picture: Picture, uv: Array) -> float:
    """Measure the blur of the edges around the marks at `uv` (N, 2) as a Gaussian σ in pixels; NaN if there is no edge.

    A step of height c blurred by σ is at most c / (√(2π) σ) steep. Around each mark, as far as half-way to the next,
    c is the range of grey levels and the steepness the largest gradient: that of the steepest edge, and that of the
    steepest one across it, for a movement smears only the edges it does not run along. The flatter of the two counts,
    and the median over the marks: the lower one of an even number, for a laser line over a mark adds to the range of
    grey levels more than to the steepness of the edges, and may lie over two marks of four.
    """
    reach = _reach(uv)
    marks = np.rint(uv[:: max(1, len(uv) // _MOST_MARKS)]).astype(np.intp)
    height, width = picture.shape
    sigmas = []
    for u, v in marks:
        part = picture[max(v - reach, 0) : min(v + reach + 1, height), max(u - reach, 0) : min(u + reach + 1, width)]
        if min(part.shape) < 2 * _SMALLEST_REACH:
            continue
        smooth = np.asarray(cv2.GaussianBlur(part.astype(np.float32), (0, 0), SMOOTHING_PX), dtype=np.float64)
        low, high = np.quantile(smooth, [0.05, 0.95])
        rise_v, rise_u = np.gradient(smooth)
        steepness = _steepness_both_ways(rise_u.ravel(), rise_v.ravel())
        if steepness > 0 and high > low:
            sigmas.append((high - low) / (np.sqrt(2 * np.pi) * steepness))
    if not sigmas:
        return float("nan")
    middle = float(np.quantile(sigmas, 0.5, method="lower"))
    return float(np.sqrt(max(middle**2 - SMOOTHING_PX**2 - _DIFFERENCE_VARIANCE, 0.01)))


def _steepness_both_ways(rise_u: Array, rise_v: Array) -> float:
    """The largest gradient, or the largest among those more across than along it if that is smaller."""
    size = np.hypot(rise_u, rise_v)
    top = int(np.argmax(size))
    along = rise_u * rise_u[top] + rise_v * rise_v[top]
    across = np.abs(along) < np.sqrt(0.5) * size * size[top]
    steepest = float(np.quantile(size, 0.995))
    if np.count_nonzero(across) < len(size) // 50:
        return steepest
    return min(steepest, float(np.quantile(size[across], 0.99)))


def _reach(uv: Array) -> int:
    """Half width in px of the part around a mark that is used: less than half-way to its neighbour."""
    if len(uv) < 2:
        return _LARGEST_REACH
    distances = np.asarray(cKDTree(uv).query(uv, k=2)[0], dtype=np.float64)
    return int(np.clip(0.45 * np.median(distances[:, 1]), _SMALLEST_REACH, _LARGEST_REACH))
