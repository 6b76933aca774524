"""Straight lines through points some of which are wrong, and where two lines meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array


@dataclass(frozen=True, eq=False, slots=True)
class Line:
    """normal · (X − middle) = 0, with the uncertainty of its place and direction.

    `sigma` is the points' spread about it, `variance_middle` that of the line's place at `middle`, `variance_angle`
    of its direction; `inliers` tells the points used.
    """

    middle: Array
    normal: Array
    sigma: float
    variance_middle: float
    variance_angle: float
    inliers: NDArray[np.bool_]

    @property
    def tangent(self) -> Array:
        """Unit vector along the line."""
        return np.array([-self.normal[1], self.normal[0]])


def fit_line(points: Array, candidates: NDArray[np.bool_], floor: float) -> Line | None:
    """The line through most of `points` (N, 2), in order along it; None if fewer than 25 % or 10 of them agree.

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
    middle, normal = _least_median(xy)
    weight = np.ones(len(xy))
    for _ in range(15):
        distance = (xy - middle) @ normal
        scale = max(1.4826 * float(np.median(np.abs(distance - np.median(distance)))), floor)
        weight = np.clip(1 - (distance / (4.7 * scale)) ** 2, 0, None) ** 2
        if np.count_nonzero(weight) < 10:
            return None
        middle = weight @ xy / weight.sum()
        centred = xy - middle
        normal = np.linalg.eigh((centred * weight[:, None]).T @ centred)[1][:, 0]
    used = weight > 0
    if used.sum() < max(10, 0.25 * len(points)):
        return None
    distance = ((xy - middle) @ normal)[used]
    along = ((xy - middle) @ np.array([-normal[1], normal[0]]))[used]
    sigma = float(np.sqrt((distance**2).sum() / (len(distance) - 2)))
    variance = sigma**2 * _correlation(distance)
    inliers = np.zeros(len(points), dtype=np.bool_)
    inliers[chosen[used]] = True
    return Line(middle, normal, sigma, variance / len(distance), variance / float((along**2).sum()), inliers)


def meet(a: Line, b: Line) -> Array:
    """Where two lines meet, (2,)."""
    normals = np.array([a.normal, b.normal])
    return np.asarray(np.linalg.solve(normals, [a.normal @ a.middle, b.normal @ b.middle]), dtype=np.float64)


def corner_covariance(lines: Sequence[Line]) -> Array:
    """Covariance (K, 2, K, 2) of the corners of a polygon, corner k where line k − 1 meets line k.

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
    best = int(np.argmin(np.where(length[:, 0] > 0, np.median(distance, axis=0), np.inf)))
    return (first[best] + second[best]) / 2, normal[best]


def _correlation(distance: Array) -> float:
    """Variance of means of 16 neighbours, over that of independent points; at least 1."""
    blocks, variance = len(distance) // 16, float(np.mean(distance**2))
    if blocks < 6 or variance == 0:  # a drawn picture, straight along the pixels, has no scatter at all
        return 1.0
    means = distance[: blocks * 16].reshape(blocks, 16).mean(axis=1)
    return max(1.0, float(16 * (means**2).sum() / (blocks - 2) / variance))
