"""Whether a target moved between two pictures."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from core.image.targets.picture import Picture, as_8bit
from core.image.targets.target_view import TargetView
from core.model.arrays import Array

BLUR = 1.5
"""σ in pixels of the smoothing before pictures are compared: a movement of a few pixels is then nearly linear."""

ROUNDS = 10
"""Of least squares: the shift has settled long before."""

SLACK = 0.1
"""Share of the edges' contrast by which pixels that look alike may differ."""

EDGE = 0.3
"""Share of the steepest slope from which a pixel counts as an edge."""

FARTHEST_PX = 8.0
"""Movement up to which pictures are compared: beyond it the slopes of one say nothing of the other."""

ALIKE = 0.5
"""Least share of the edges' pixels that must agree, and least contrast left; with less, something else is seen."""

WINDOW_PX = (9, 99)
"""Least and most about a mark to follow it by: between these, as far as to the next mark."""

STEADY_PX = 0.1
"""A mark followed there and back that comes back farther from where it was has been lost."""

CORNERS = 3
"""Of the four corner marks that must be followed: a line may hide one, a row that is gone hides two."""


def camera_shift(view_a: TargetView, view_b: TargetView) -> float:
    """Compute by how many px the target moved between two views: the median length of its points' displacements.

    The median forgives points that a laser stripe disturbs in one of the pictures. A target that looks the same turned
    round (:class:`BlackSquare`, :class:`CircleGrid`) may be numbered differently in the two views, so points are paired
    by their places in the picture where that gives less.

    Raises
    ------
    ValueError
        If the views share no point of the target.
    """
    found = cKDTree(view_a.points).query(view_b.points)
    index = np.asarray(found[1], dtype=np.intp)
    same = np.asarray(found[0], dtype=np.float64) < 1e-6
    if not same.any():
        raise ValueError("the two views show no point of the target in common")
    by_number = float(np.median(np.linalg.norm(view_b.uv[same] - view_a.uv[index[same]], axis=1)))
    by_place = float(np.median(cKDTree(view_a.uv).query(view_b.uv)[0]))
    renumbered = len(view_a.uv) == len(view_b.uv) and by_place < 0.5 * by_number
    return by_place if renumbered else by_number


def followed_shift(view: TargetView, before: Picture, after: Picture) -> float | None:
    """Measure how many px the target's marks moved from `before` to `after`, each followed; None if too few are.

    The median length of the marks' displacements (Lucas & Kanade, in the pyramid of J.-Y. Bouguet, 2000): far quicker
    than finding the target anew, for movements of a few pixels. A grid that moved by just its spacing looks unmoved
    except at the side that it left: None unless CORNERS of its corner marks, and half of all, are followed there and
    back.
    """
    spacing = np.asarray(cKDTree(view.uv).query(view.uv, k=2)[0])[:, 1]
    window = int(np.clip(np.median(spacing), *WINDOW_PX))
    one, other = as_8bit(before), as_8bit(after)
    start = view.uv.astype(np.float32)[:, None]
    there = _followed(one, other, start, window)
    back = _followed(other, one, there, window)
    steady = np.asarray(np.linalg.norm((back - start)[:, 0], axis=1) < STEADY_PX)  # False where it is NaN
    corners = [int((view.points[:, :2] @ way).argmax()) for way in ((1, 1), (1, -1), (-1, 1), (-1, -1))]
    if steady[corners].sum() < CORNERS or steady.mean() < ALIKE:
        return None
    return float(np.median(np.linalg.norm((there - start)[steady, 0], axis=1)))


def _followed(one: Picture, other: Picture, points: NDArray[np.float32], window: int) -> NDArray[np.float32]:
    """Where `points` (N, 1, 2) of `one` picture are in the `other`, by `window` pixels about each; NaN where lost."""
    lost = np.isnan(points[..., :1])
    start = np.where(lost, np.float32(0), points)
    moved, found, _ = cv2.calcOpticalFlowPyrLK(one, other, start, start.copy(), winSize=(window, window), maxLevel=1)
    return np.where((found[..., None] == 1) & ~lost, moved, np.float32(np.nan))


def picture_shift(view: TargetView, before: Picture, after: Picture) -> float | None:
    """Measure how many px the picture of a target moved from `before` to `after`; None if the two are too unlike.

    The target is not searched in `after`. The shift is the one under which most pixels at the target's edges look alike
    in both pictures, refined by robust least squares on the slopes (B. D. Lucas, T. Kanade, An iterative image
    registration technique, IJCAI 1981) together with a change of brightness. An edge under a laser line looks different
    and loses its weight; the others tell. None where too little looks alike, as after a movement much farther than
    FARTHEST_PX.
    """
    low = np.floor(view.uv.min(axis=0) - 4 * BLUR).astype(int).clip(0)
    high = np.ceil(view.uv.max(axis=0) + 4 * BLUR).astype(int) + 1
    window = slice(low[1], high[1]), slice(low[0], high[0])
    first, second = (_smooth(picture[window]) for picture in (before, after))
    slope_v, slope_u = (np.asarray(np.gradient(first, axis=axis)) for axis in (0, 1))
    steepness = np.hypot(slope_u, slope_v)
    vu = np.argwhere(steepness > EDGE * np.quantile(steepness, 0.999))
    level = first[tuple(vu.T)]
    terms = np.column_stack([slope_v[tuple(vu.T)], slope_u[tuple(vu.T)], level, np.ones(len(vu))])
    slack = SLACK * float(np.ptp(level))

    def after_at(shift: Array) -> Array:
        return np.asarray(map_coordinates(second, (vu + shift).T, order=1, mode="nearest"), dtype=np.float64)

    def left_at(shift: Array) -> Array:
        brighter = after_at(shift) - level
        return np.asarray(brighter - np.median(brighter))

    gain, steps = 1.0, np.arange(-FARTHEST_PX, FARTHEST_PX + 1)
    tried = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    best = int(np.argmax([np.mean(np.abs(left_at(each)) < slack) for each in tried]))
    shift: Array = tried[best]
    left = left_at(shift)
    for _ in range(ROUNDS):
        seen, weight = after_at(shift), np.clip(1 - (left / (2 * slack)) ** 2, 0, None)
        fitted = np.linalg.lstsq(terms * weight[:, None], seen * weight, rcond=None)[0]
        solved = np.asarray(fitted, dtype=np.float64)
        left, gain = seen - terms @ solved, float(solved[2])
        shift = shift - solved[:2] / max(gain, ALIKE)
    distance = float(np.linalg.norm(shift))
    alike = float(np.mean(np.abs(left) < slack)) > ALIKE and gain > ALIKE
    return distance if alike and distance < 1.5 * FARTHEST_PX else None


def _smooth(picture: Picture) -> Array:
    return np.asarray(cv2.GaussianBlur(picture.astype(np.float32), (0, 0), BLUR), dtype=np.float64)
