"""Smoothing of a centreline along itself, as far as it is a parabola.

The noise of a stripe's points falls with the root of the length they are averaged over, but a window must not span a
bend. So for each point parabolas are fitted to windows that grow, and the largest window is taken whose answer still
agrees with those of all smaller ones: the intersection of confidence intervals. On a flat face windows become long, at
a bend they stay short, and on an arc they stay so short that it is not flattened. A window never leaves its unbroken
run, and so never spans a depth edge.

A parabola may not be fitted to a long arc: a circle of curvature κ departs from its parabola by κ³x⁴/8; fitted over
± h, the parabola takes up all of that but 3/35 of its value at the ends, so in the middle it is off by 3 κ³h⁴/280.

References
----------
Goldenshluger, A., Nemirovski, A., On spatially adaptive estimation of nonparametric regression, Mathematical Methods of
Statistics 6 (1997).
Katkovnik, V., A new method for varying adaptive bandwidth selection, IEEE Transactions on Signal Processing 47 (1999),
doi:10.1109/78.782208.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.image.stripes.runs import arc_length
from core.model.arrays import Array
from core.model.robust import median

# Held by tests/image/stripes/lines/test_smoothing.py on straight lines, bends and arcs, and on arcs as a sphere shows
# them.
WINDOWS = (9.0, 13.0, 19.0, 28.0, 41.0, 60.0, 88.0)
"""Half lengths in px of the windows tried, each about 1.46 times the one before."""
AGREEMENT = 1.0
"""Half width of the confidence intervals in standard uncertainties."""
BIAS_ALLOWED = 0.1
"""Largest bias of a local fit, in its standard uncertainties."""
FORESHORTENING = 6.0
"""Factor of an arc's bias when it is seen at a slant: it departs from its parabola by 1/sin² of the angle between its
plane and the line of sight more than its own curvature tells; 6 is right for 24°."""
LOPSIDED_FACTOR = 5.0
"""The same once more where a window is lopsided: a flattened arc is not as bent on one side as on the other."""
SYMMETRIC_SHARE = 0.8
"""Of its half length that a window has on both sides, or it is lopsided."""

_LEAST_POINTS = 7  # of a window
_LEAST_SIDE = 0.3  # of its half length that a window must have on either side


def smooth(centreline: Centreline, windows: tuple[float, ...] = WINDOWS) -> Centreline:
    """Smooth a centreline: move its points along their normals onto locally fitted parabolas, with the σ of those fits.

    Normals, widths and strengths stay. `correlation_px` grows by as much as the variances fall, for a mean along the
    line gains nothing by it; saturated points have no weight but are moved like the others.
    """
    if len(centreline) < 3:
        return centreline
    arc = arc_length(centreline.uv)
    best = _Fits.at(centreline, arc, windows[0])
    low, high = best.shift - AGREEMENT * best.sigma, best.shift + AGREEMENT * best.sigma
    growing = np.isfinite(best.shift)
    for window in windows[1:]:
        fits = _Fits.at(centreline, arc, window)
        low = np.fmax(low, fits.shift - AGREEMENT * fits.sigma)
        high = np.fmin(high, fits.shift + AGREEMENT * fits.sigma)
        bias = FORESHORTENING * np.where(fits.lopsided, LOPSIDED_FACTOR, 1.0) * arc_bias(best.curvature, window)
        straight = bias <= BIAS_ALLOWED * fits.sigma
        growing &= (low <= high) & np.isfinite(fits.shift) & straight
        best = best.replaced(fits, growing)
    moved = np.isfinite(best.shift)
    sigma = np.where(moved, best.sigma, centreline.sigma)
    return Centreline(
        centreline.uv + np.where(moved, best.shift, 0.0)[:, None] * centreline.normal,
        centreline.normal,
        centreline.width,
        centreline.strength,
        sigma,
        centreline.saturated,
        centreline.correlation_px * max(1.0, median((centreline.sigma / sigma) ** 2)),
        centreline.skewness,
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Fits:
    """For every point, the distance in px along its normal to the parabola through its window.

    With that its σ in px and the parabola's curvature in 1/px, (N,) each; NaN where a window holds too little. And
    whether the window reaches much further to one side than to the other.
    """

    shift: Array
    sigma: Array
    curvature: Array
    lopsided: NDArray[np.bool_]

    @classmethod
    def at(cls, line: Centreline, arc: Array, half_length: float) -> _Fits:
        """Weighted parabolas u(s), v(s) through all points within `half_length` of each, by running sums."""
        first = np.searchsorted(arc, arc - half_length, side="left")
        last = np.searchsorted(arc, arc + half_length, side="right")
        spacing = (arc[last - 1] - arc[first]) / np.maximum(last - first - 1, 1)
        usable = (
            (last - first >= _LEAST_POINTS)
            & (arc - arc[first] > _LEAST_SIDE * half_length)
            & (arc[last - 1] - arc > _LEAST_SIDE * half_length)
        )
        weight = np.where(line.saturated, 0.0, 1 / line.sigma**2)

        # Moments about the middle of the run, in units of the window, then moved to each point.
        t = (arc - arc.mean()) / half_length
        moved = [(-t) ** power for power in range(5)]
        weights = [weight * t**power for power in range(5)]
        running = np.zeros((len(arc) + 1, 11))
        np.cumsum(np.column_stack([*weights, *(each[:, None] * line.uv for each in weights[:3])]), 0, out=running[1:])
        sums = np.ascontiguousarray((running[last] - running[first]).T)
        moments = _about(sums[:5], moved)
        target = _about(np.stack([np.ascontiguousarray(sums[k : k + 2].T) for k in (5, 7, 9)]), moved)
        normal_matrix = moments[np.add.outer(np.arange(3), np.arange(3))].transpose(2, 0, 1)
        usable &= np.linalg.det(normal_matrix) > 1e-6 * np.maximum(moments[0], 1e-300) ** 3
        normal_matrix[~usable] = np.eye(3)
        inverse = np.linalg.inv(normal_matrix)
        place, bend = (
            row[:, :1] * target[0] + row[:, 1:2] * target[1] + row[:, 2:] * target[2]
            for row in (inverse[:, 0], inverse[:, 2])
        )
        shift = np.einsum("ni,ni->n", place - line.uv, line.normal)
        curvature = 2 * np.abs(np.einsum("ni,ni->n", bend, line.normal)) / half_length**2
        repeats = np.maximum(1.0, line.correlation_px / np.maximum(spacing, 1e-9))
        sigma = np.sqrt(repeats * inverse[:, 0, 0])
        lopsided = np.minimum(arc - arc[first], arc[last - 1] - arc) < SYMMETRIC_SHARE * half_length
        shift, sigma, curvature = (np.where(usable, values, np.nan) for values in (shift, sigma, curvature))
        return cls(shift, sigma, curvature, lopsided)

    def replaced(self, other: _Fits, where: NDArray[np.bool_]) -> _Fits:
        pairs = ((other.shift, self.shift), (other.sigma, self.sigma), (other.curvature, self.curvature))
        shift, sigma, curvature = (np.where(where, new, old) for new, old in pairs)
        return _Fits(shift, sigma, curvature, np.where(where, other.lopsided, self.lopsided))


def _about(moments: Array, moved: Sequence[Array]) -> Array:
    """Moments Σ w (t − origin)^k of each window from Σ w t^k, k = 0, 1, …; `moved` are the powers of −origin."""
    shape = (-1,) + (1,) * (moments.ndim - 2)
    about = np.zeros_like(moments)
    for k in range(len(moments)):
        for j in range(k + 1):
            about[k] += comb(k, j) * moved[k - j].reshape(shape) * moments[j]
    return about


def arc_bias(curvature: Array, half_length: float) -> Array:
    """Compute how far in px parabolas fitted to ± `half_length` px of arcs of `curvature` (N,) in 1/px lie off them."""
    return 3.0 / 280.0 * curvature**3 * half_length**4
