"""Screening of views and corners for a camera calibration, with reasons for what is left out.

References
----------
Baarda, W., A testing procedure for use in geodetic networks (1968): single gross errors by their normed residuals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.bundle import RAYLEIGH_MEDIAN
from core.calibrate.camera.options import Outliers
from core.calibrate.camera.zhang import homography, homography_misfit
from core.image.exclusion import Excludable, Reason
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model.arrays import Array

# Which views are screened out; tests/calibrate/camera/test_calibration.py (misfound corners, wrong views) holds them.
LEAST_CORNERS = 6
"""Corners of a view: fewer hardly determine its own pose."""
_GRID_MISFIT = 0.05
"""Median misfit to a homography, as a share of the target's extent: distortion bends a target by a percent or two of
its size, corners in a wrong order miss by a third of it."""
_LEAST_FLATNESS = 1e-3
"""Second singular value over the first of the corners: with less they lie on one straight line."""

# Outliers; held by the same tests.
VIEW_LIMIT = 6.0
"""Times the usual median residual of the views at which a view is left out."""
CORNER_LIMIT = 7.0
"""Standard deviations off at which a corner is left out."""
_LEAST_COUNTED_SHARE = 0.7
"""Of its corners that must count, or the view is left out."""
_FLOOR_PX = 1e-3
"""Usual residual in px at least: views without noise are not compared by their rounding."""


@dataclass(frozen=True, eq=False, slots=True)
class Verdict(Excludable):
    """Decision on a view: whether it is used, the reason if not, and which of its corners count (N,)."""

    used: bool
    counted: NDArray[np.bool_]
    exclusion: Reason | None = None


def screen(view: TargetView) -> Array | Message:
    """Fit the homography (3, 3) of `view`, or return the reason why its points are no view of a flat target."""
    if len(view.points) < LEAST_CORNERS:
        return Message(
            "camera.few_corners",
            "only {n} corners were found and a pose needs at least {least}",
            n=len(view.points),
            least=LEAST_CORNERS,
        )
    if not (np.isfinite(view.uv).all() and np.isfinite(view.points).all()):
        return Message("camera.corners_not_finite", "it holds corners without finite coordinates")
    if _flatness(view.points[:, :2]) < _LEAST_FLATNESS or _flatness(view.uv) < _LEAST_FLATNESS:
        return Message("camera.corners_on_line", "its corners lie on one straight line")
    matrix = homography(view.points[:, :2], view.uv)
    misfit = float(np.median(homography_misfit(matrix, view.points[:, :2], view.uv)))
    extent = float(np.linalg.norm(np.ptp(view.uv, axis=0)))
    if not misfit < _GRID_MISFIT * extent:
        return Message(
            "camera.no_pattern",
            "its corners do not form the target's pattern: found in a wrong order, or another target",
        )
    return matrix


def judge(lengths: Sequence[Array], used: Sequence[bool], outliers: Outliers) -> list[Verdict]:
    """Decide for each view whether it is used, and which corners count, by the `lengths` (N,) of its residuals in px.

    They are weighted to pixels of a typical corner.

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
        reason = Message(
            "camera.view_out_of_line",
            "its residuals (median {rms_px:.2f} px) are out of line with the other views' ({usual_px:.2f} px): "
            "blurred, moved, or not the same target",
            rms_px=median,
            usual_px=typical,
        )
        return Verdict(False, counted, reason)
    if counted.mean() < _LEAST_COUNTED_SHARE or counted.sum() < LEAST_CORNERS:
        reason = Message(
            "camera.corners_misfit",
            "only {n} of its {all} corners fit the camera",
            n=int(counted.sum()),
            all=len(lengths),
        )
        return Verdict(False, counted, reason)
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
