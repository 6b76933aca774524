"""A centreline averaged along itself, as far as it is straight.

The noise of a stripe's points falls with the root of the length they are averaged over, but a window must not span a
bend. So for each point straight lines are fitted to windows that grow, and the largest window is taken whose answer
still agrees with those of all smaller ones: the intersection of confidence intervals. On a flat face windows become
long; at a bend they stay short. A window never leaves its unbroken run, and so never spans a depth edge.

References
----------
Goldenshluger, A., Nemirovski, A., On spatially adaptive estimation of nonparametric regression, Mathematical Methods of
Statistics 6 (1997).
Katkovnik, V., A new method for varying adaptive bandwidth selection, IEEE Transactions on Signal Processing 47 (1999),
doi:10.1109/78.782208.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.model.arrays import Array

WINDOWS = (6.0, 9.0, 13.0, 19.0, 28.0, 41.0)
"""Half lengths of the windows tried, in pixels."""

AGREE = 2.0
"""Half width of the confidence intervals in standard deviations."""


def smooth(centreline: Centreline, windows: tuple[float, ...] = WINDOWS) -> Centreline:
    """The centreline moved across itself onto local straight lines, with the σ that leaves.

    Normals, widths and strengths stay. `correlation_px` becomes the typical length of the windows chosen; saturated
    points have no weight but are moved like the others.
    """
    if len(centreline) < 3:
        return centreline
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(centreline.uv, axis=0), axis=1))])
    best = _LineFits.at(centreline, arc, windows[0])
    chosen = np.full(len(arc), windows[0])
    low, high = best.shift - AGREE * best.sigma, best.shift + AGREE * best.sigma
    growing = np.isfinite(best.shift)
    for window in windows[1:]:
        fits = _LineFits.at(centreline, arc, window)
        low = np.fmax(low, fits.shift - AGREE * fits.sigma)
        high = np.fmin(high, fits.shift + AGREE * fits.sigma)
        growing &= (low <= high) & np.isfinite(fits.shift)
        best = best.replaced(fits, growing)
        chosen[growing] = window
    moved = np.isfinite(best.shift)
    return Centreline(
        centreline.uv + np.where(moved, best.shift, 0.0)[:, None] * centreline.normal,
        centreline.normal,
        centreline.width,
        centreline.strength,
        np.where(moved, best.sigma, centreline.sigma),
        centreline.saturated,
        max(centreline.correlation_px, 2 * float(np.median(chosen))),
    )


@dataclass(frozen=True, eq=False, slots=True)
class _LineFits:
    """For every point, how far (px, along its normal) the line through its window lies from it, and that line's σ."""

    shift: Array
    sigma: Array

    @classmethod
    def at(cls, line: Centreline, arc: Array, half_length: float) -> _LineFits:
        """Weighted straight lines u(s), v(s) through all points within `half_length` of each, by running sums."""
        first = np.searchsorted(arc, arc - half_length, side="left")
        last = np.searchsorted(arc, arc + half_length, side="right")
        weight = np.where(line.saturated, 0.0, 1 / line.sigma**2)

        def window_sum(values: Array) -> Array:
            total = np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])
            return np.asarray(total[last] - total[first])

        s0 = window_sum(weight)
        with np.errstate(divide="ignore", invalid="ignore"):
            mean_s = window_sum(weight * arc) / s0
            mean_uv = window_sum(weight[:, None] * line.uv) / s0[:, None]
            spread = window_sum(weight * arc**2) / s0 - mean_s**2
            slope = (window_sum((weight * arc)[:, None] * line.uv) / s0[:, None] - mean_s[:, None] * mean_uv) / spread[
                :, None
            ]
            here = mean_uv + slope * (arc - mean_s)[:, None]
            shift = np.einsum("ni,ni->n", here - line.uv, line.normal)
            spacing = (arc[last - 1] - arc[first]) / np.maximum(last - first - 1, 1)
            repeats = np.maximum(1.0, line.correlation_px / np.maximum(spacing, 1e-9))
            variance = repeats / s0 * (1 + (arc - mean_s) ** 2 / spread)
        usable = (s0 > 0) & (spread > 1e-3 * half_length**2) & _several(last - first)
        return cls(np.where(usable, shift, np.nan), np.sqrt(np.where(usable, variance, np.nan)))

    def replaced(self, other: _LineFits, where: NDArray[np.bool_]) -> _LineFits:
        return _LineFits(np.where(where, other.shift, self.shift), np.where(where, other.sigma, self.sigma))


def _several(points: NDArray[np.intp]) -> NDArray[np.bool_]:
    return np.asarray(points >= 5)
