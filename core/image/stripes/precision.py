"""Standard uncertainty of line points: from the law of their noise, and from the roughness of the line itself.

The point's offset is t = −f'/f'' of the filtered picture. With pixels of variance σ² + k·I (read and shot noise),
filter σ g, stripe σ s and height A over background B:

    var f' = [σ² + k·B + k·A·(1 + g²/2s²)^(−3/2)] / (8π g⁴)        f'' = −A s / (s² + g²)^(3/2)

That holds for pixels whose noise is their own. Compressed ones have lost it, and are off by what rounding the terms of
a block leaves, together: c/A px for terms that are off by c grey levels, whatever the width of the stripe.

Speckle is not in it. It shows as roughness of the line beyond that law, is the same at any height of the stripe, and
so is added in squares, one figure a piece.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.image.stripes.noise import NoiseModel
from core.image.stripes.profile import Profiles
from core.image.stripes.tracing.pixel_state import SATURATED, bits_within
from core.image.stripes.tracing.ridge import ridge_response
from core.model.arrays import Array
from core.model.small_arrays import median_of, new_row

FLOOR_PX = 0.001
"""Standard uncertainty in px left of all biases on a clean stripe; phase errors are below it
(tests/image/stripes/likelihood/test_refinement.py, places within a pixel)."""
COMPRESSION_SHARE = 0.75
"""Px by which a line is off per grey level that compression leaves the terms of a block off, times its height in grey
levels: 0.55 to 1.0 for stripes of σ 1.2 to 5 px in qualities of 50 to 95, tests/image/stripes/test_compression.py."""
_SATURATED_SHARE = 0.01  # of the filter's weight: with more on saturated pixels a point is flagged
_SATURATED_REACH = 2.5  # filter σ looked at for them: the rest has 4 % of the weight
_TESTED_TOGETHER = 8  # points whose pixels are tested at once for saturation; chosen by speed

# Roughness of a line beyond the law of its noise. Held by tests/image/stripes/test_extraction.py (errors follow the
# law, speckle, saturated all along) on stripes with and without speckle.
_PRIOR_DIFFERENCES = 5.0  # independent differences that all lines' common roughness counts in each line
_LONGEST_SPAN = 3.3  # lags: a third difference over more has a hole in it
_OUTLIER = 25.0  # times the usual square of a difference: larger ones are cut down to it


def response_noise(pixel_noise: float, stripe_px: float, filter_px: float) -> float:
    """Compute the noise of a second derivative from white pixel noise, as a stripe's height in grey levels."""
    second: float = pixel_noise * math.sqrt(3 / (16 * math.pi)) / filter_px**3
    return second / ridge_response(1.0, stripe_px, filter_px)


def added_in_squares(sigma: Array, extra: float) -> Array:
    """Compute √(σ² + extra²) of each σ, (N,).

    In a tenth of the time of `np.hypot`, for numbers that cannot overflow.
    """
    return np.asarray(np.sqrt(sigma * sigma + extra * extra))


def noise_sigma(profiles: Profiles, noise: NoiseModel, filter_px: float) -> Array:
    """Compute the standard uncertainty (N,) in px across the line of its points from read noise and shot noise."""
    read, shot = noise.read_grey**2, noise.grey_per_electron
    sigma: Array = _noise_sigma(profiles.height, profiles.width, profiles.background, read, shot, filter_px)
    return sigma


def compression_sigma(height: Array, noise: NoiseModel) -> Array:
    """Compute the least uncertainty (N,) in px that lossy compression leaves stripes of this height (N,)."""
    return np.asarray(COMPRESSION_SHARE * noise.compression.grey / np.maximum(height, 1.0))


@compiled(fastmath=True)
def _noise_sigma(height: Array, width: Array, background: Array, read: float, shot: float, filter_px: float) -> Array:
    sigma, square = new_row(len(height)), filter_px * filter_px
    for k in range(len(height)):
        light, s = max(height[k], 1e-6), width[k] * width[k]
        blur = 1 + square / (2 * s)
        variance = read + shot * (max(background[k], 0.0) + light / (blur * math.sqrt(blur)))
        bend = light * width[k] / ((s + square) * math.sqrt(s + square))
        lost = min(math.sqrt(variance / (8 * math.pi)) / (square * bend), 1.0)
        sigma[k] = math.sqrt(lost * lost + FLOOR_PX * FLOOR_PX)
    return sigma


def roughness(lines: list[tuple[Array, Array]], correlation: float) -> list[float]:
    """Measure the scatter in px of each line's points (N, ≥ 4) beyond what their stated sigma (N,) explains; 0 if none.

    Measured by third differences between points one correlation length apart, which see neither the line's place
    and direction nor its curvature. Short lines take over some of what all lines show.
    """
    lag = max(1, round(correlation))
    sums = [_excess(points, sigma, lag, correlation) for points, sigma in lines]
    number = sum(n for _, n in sums)
    overall = sum(total for total, _ in sums) / number if number else 0.0
    prior = _PRIOR_DIFFERENCES
    return [math.sqrt(max(0.0, (total + prior * overall) / (n + prior))) for total, n in sums]


def scatter(lines: list[Array], correlation: float) -> float:
    """Compute the standard deviation in px of the points (N, ≥ 4) of lines about smooth lines; 0 if too few."""
    lag = max(1, round(correlation))
    sums = [_excess(points, np.zeros(len(points)), lag, correlation) for points in lines]
    number = sum(n for _, n in sums)
    return math.sqrt(sum(total for total, _ in sums) / number) if number else 0.0


@compiled(fastmath={"contract", "reassoc", "arcp", "nsz"})
def _excess(points: Array, sigma: Array, lag: int, correlation: float) -> tuple[float, float]:
    """Sum of the excess variance over independent third differences, and their number, both weighted."""
    count = max(0, len(points) - 3 * lag)
    observed, law = new_row(count), new_row(count)
    # a third difference of points with correlation ρ one lag apart has variance 20 − 30 ρ
    gain = 20 - 30 * math.exp(-((lag / correlation) ** 2) * math.pi)
    number, longest = 0, (_LONGEST_SPAN * lag) ** 2
    for k in range(count):
        u0, v0, u3, v3 = points[k, 0], points[k, 1], points[k + 3 * lag, 0], points[k + 3 * lag, 1]
        if (u3 - u0) * (u3 - u0) + (v3 - v0) * (v3 - v0) >= longest:  # a hole within
            continue
        du = u0 - u3 + 3 * (points[k + 2 * lag, 0] - points[k + lag, 0])
        dv = v0 - v3 + 3 * (points[k + 2 * lag, 1] - points[k + lag, 1])
        middle = k + 3 * lag // 2
        across = du * points[middle, 2] + dv * points[middle, 3]
        observed[number], law[number] = across * across / gain, sigma[middle] ** 2
        number += 1
    if number == 0:
        return 0.0, 0.0
    usual = median_of(observed, 0, number)
    total, counted, least = 0.0, 0.0, law[0]
    for k in range(1, number):
        least = min(least, law[k])
    least += usual
    for k in range(number):
        weight = (least / (law[k] + usual)) ** 2  # where a line is faint its noise hides what is looked for
        total += weight * (min(observed[k], _OUTLIER * usual) - law[k])
        counted += weight
    return total / lag, counted / lag


@compiled(fastmath=True)
def saturated_points(state: NDArray[np.uint8], points: Array, filter_px: float) -> NDArray[np.bool_]:
    """Flag the points (N, ≥ 2) for which more than 1 % of the filter's weight is on saturated pixels: (N,)."""
    reach = math.ceil(_SATURATED_REACH * filter_px)
    saturated = np.zeros(len(points), dtype=np.bool_)
    limit = _SATURATED_SHARE * 2 * math.pi * filter_px * filter_px
    for start in range(0, len(points), _TESTED_TOGETHER):
        end = min(start + _TESTED_TOGETHER, len(points))
        left, right, top, bottom = _around(state.shape, points[start:end], reach)
        if bits_within(state, left, right, top, bottom) & SATURATED == 0:  # nearly always
            continue
        for k in range(start, end):
            saturated[k] = _weight_of_saturated(state, points[k : k + 1], reach, filter_px) > limit
    return saturated


@inlined(fastmath=True)
def _around(shape: tuple[int, int], points: Array, reach: int) -> tuple[int, int, int, int]:
    """The pixels within `reach` of the box of some points: columns from, to behind; rows from, to behind."""
    left, right, top, bottom = points[0, 0], points[0, 0], points[0, 1], points[0, 1]
    for k in range(1, len(points)):
        left, right = min(left, points[k, 0]), max(right, points[k, 0])
        top, bottom = min(top, points[k, 1]), max(bottom, points[k, 1])
    return (
        max(int(left + 0.5) - reach, 0),
        min(int(right + 0.5) + reach + 1, shape[1]),
        max(int(top + 0.5) - reach, 0),
        min(int(bottom + 0.5) + reach + 1, shape[0]),
    )


@inlined(fastmath=True)
def _weight_of_saturated(state: NDArray[np.uint8], point: Array, reach: int, filter_px: float) -> float:
    """Σ exp(−d²/2g²) over the saturated pixels within `reach` of a point (1, ≥ 2), d being their distance from it."""
    u, v, inverse, total = point[0, 0], point[0, 1], 0.5 / (filter_px * filter_px), 0.0
    left, right, top, bottom = _around(state.shape, point, reach)
    for j in range(top, bottom):
        for i in range(left, right):
            if state[j, i] & SATURATED:
                total += math.exp(-((i - u) ** 2 + (j - v) ** 2) * inverse)
    return total
