"""Which views, and which corners of them, a camera calibration may rest on, and why not the others.

References
----------
Baarda, W., A testing procedure for use in geodetic networks (1968): single gross errors by their normed residuals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.calibrate.bundle import RAYLEIGH_MEDIAN
from core.calibrate.zhang import homography, homography_misfit
from core.image.target_view import TargetView
from core.model.arrays import Array

Outliers = Literal["keep", "gross", "all"]

MIN_CORNERS = 6
"""A view with fewer corners hardly holds its own pose."""

VIEW_LIMIT = 6.0
"""A view whose median residual is this many times that of the views is left out."""

CORNER_LIMIT = 7.0
"""A corner this many standard deviations off is left out."""

_MIN_COUNTED_SHARE = 0.7
_GRID_MISFIT = 0.05
_FLOOR_PX = 1e-3


@dataclass(frozen=True, eq=False, slots=True)
class Verdict:
    """Whether a view is used, why not, and which of its corners count (N,)."""

    used: bool
    counted: NDArray[np.bool_]
    reason: str = ""


def screen(view: TargetView) -> tuple[Array | None, str]:
    """The homography (3, 3) of `view`, or None and the reason why it is no view of a flat target.

    Distortion bends a target by a percent or two of its size; corners in a wrong order miss by a third of it.
    """
    if len(view.points) < MIN_CORNERS:
        return None, f"only {len(view.points)} corners were found and a pose needs at least {MIN_CORNERS}"
    if not (np.isfinite(view.uv).all() and np.isfinite(view.points).all()):
        return None, "it holds corners without finite coordinates"
    if _flatness(view.points[:, :2]) < 1e-3 or _flatness(view.uv) < 1e-3:
        return None, "its corners lie on one straight line"
    matrix = homography(view.points[:, :2], view.uv)
    misfit = float(np.median(homography_misfit(matrix, view.points[:, :2], view.uv)))
    extent = float(np.linalg.norm(np.ptp(view.uv, axis=0)))
    if not misfit < _GRID_MISFIT * extent:
        return None, "its corners do not form the target's pattern: found in a wrong order, or another target"
    return matrix, ""


def judge(lengths: Sequence[Array], used: Sequence[bool], outliers: Outliers) -> list[Verdict]:
    """Verdicts on views with weighted residual vectors of these `lengths` (N,), in pixels of a typical corner.

    A view is compared by its median with the median of those that are `used` so far, so that single corners neither
    condemn nor save it. `outliers` says which corners to leave out: "keep" none (and no view); "gross" those that
    stand out even against the plain standard deviation of their view, which they raise themselves; "all" those that
    stand out against its median.
    """
    if outliers == "keep":
        return [Verdict(True, np.ones(len(length), dtype=np.bool_)) for length in lengths]
    medians = np.array([np.median(length) for length in lengths])
    typical = max(float(np.median(medians[np.asarray(used)])), _FLOOR_PX)
    return [_verdict(length, float(median), typical, outliers) for length, median in zip(lengths, medians, strict=True)]


def _verdict(lengths: Array, median: float, typical: float, outliers: Outliers) -> Verdict:
    counted = _counted(lengths, typical / RAYLEIGH_MEDIAN, outliers)
    if median > VIEW_LIMIT * typical:
        reason = (
            f"its residuals (median {median:.2f} px) are out of line with the other views' ({typical:.2f} px): "
            "blurred, moved, or not the same target"
        )
        return Verdict(False, counted, reason)
    if counted.mean() < _MIN_COUNTED_SHARE or counted.sum() < MIN_CORNERS:
        return Verdict(False, counted, f"only {counted.sum()} of its {len(lengths)} corners fit the camera")
    return Verdict(True, counted)


def _counted(lengths: Array, floor: float, outliers: Outliers) -> NDArray[np.bool_]:
    if outliers == "all":
        scale = max(float(np.median(lengths)) / RAYLEIGH_MEDIAN, floor)
        return np.asarray(lengths <= CORNER_LIMIT * scale)
    counted = np.ones(len(lengths), dtype=np.bool_)
    while True:
        scale = max(float(np.sqrt(np.mean(lengths[counted] ** 2) / 2)), floor)
        keep = lengths <= CORNER_LIMIT * scale
        if keep.sum() >= counted.sum():
            return counted
        counted = keep


def _flatness(xy: Array) -> float:
    """Second singular value over first of centred points (N, 2): 0 on a straight line."""
    first, second = np.linalg.svd(xy - xy.mean(axis=0), compute_uv=False)
    return float(second / first) if first > 0 else 0.0
