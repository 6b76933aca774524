"""What is shown of one frame of a scan. Light to import: a window needs it at its start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.model.arrays import Array
from core.scan.preview_cloud import PreviewCloud


@dataclass(frozen=True, eq=False, slots=True)
class FramePreview:
    """What one frame shows.

    Parameters
    ----------
    index, name
        Of the frame.
    centrelines
        The stripe, thinned for display.
    sigma_mm
        For each of the centrelines, (N,) standard uncertainty of depth in mm; NaN where it is unknown.
    crossing_uv
        (M, 2) in pixels.
    crossing_status
        (M,) 0 good, 1 weak, 2 left out.
    crossing_reason
        One sentence for each crossing.
    crossing_with_fan
        (M,) False for crossings with other sweeps.
    condition
        Of the crossings with the fan: ratio of singular values, infinite when they are collinear or too few.
    speed_px
        How far the stripe moves from frame to frame, in pixels: since the last frame looked at, by their number; NaN
        if not known.
    points, point_sigma, point_intensity
        (P, 3) in mm in the camera frame, (P,) in mm, (P,) in grey levels: the points worth showing.
    point_uv
        (P, 2) where they are in the picture, in pixels.
    hints
        At most two short sentences for the hand.
    reason
        Why there are no points; empty if there are.
    renewed
        Not None: all points so far, this frame's and the fan's own included, located anew; they replace all that was
        given before. So with the first frame.
    fan_lines
        Not None: the fan's centrelines by line number, thinned for display, as far as settled; with the first frame,
        and again whenever a number has changed.
    """

    index: int
    name: str
    centrelines: tuple[Centreline, ...]
    sigma_mm: tuple[Array, ...]
    crossing_uv: Array
    crossing_status: NDArray[np.int8]
    crossing_reason: tuple[str, ...]
    crossing_with_fan: NDArray[np.bool_]
    condition: float
    speed_px: float
    points: Array
    point_sigma: Array
    point_intensity: Array
    point_uv: Array
    hints: tuple[str, ...]
    reason: str
    renewed: PreviewCloud | None = None
    fan_lines: tuple[tuple[Centreline, ...], ...] | None = None


def cloud_of(preview: FramePreview) -> PreviewCloud:
    """The points of this frame alone."""
    return PreviewCloud(
        preview.points.astype(np.float32),
        preview.point_sigma.astype(np.float32),
        preview.point_intensity.astype(np.float32),
        preview.point_uv.astype(np.float32),
        np.full(len(preview.points), preview.index, np.int32),
    )


def empty_preview(index: int, name: str, reason: str) -> FramePreview:
    """A frame that shows no stripe, and why."""
    none, empty = np.zeros(0), np.zeros((0, 2))
    return FramePreview(
        index,
        name,
        (),
        (),
        empty,
        np.zeros(0, np.int8),
        (),
        np.zeros(0, np.bool_),
        float("inf"),
        float("nan"),
        np.zeros((0, 3)),
        none,
        none,
        empty,
        (),
        reason,
    )
