"""What the views of a calibration are worth together: what they cover, what they lack, how sure they make it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.coverage import picture_cells
from core.calibrate.expected_error import ExpectedError, ResidualField, expected_error, residual_field
from core.calibrate.missing import what_is_missing
from core.calibrate.results import CameraCalibration
from core.calibrate.seen_views import SeenViews
from core.progress import Progress, silent

COLUMNS = 16
"""Cells across the picture in the map of what the views cover."""


@dataclass(frozen=True, eq=False, slots=True)
class ViewsJudgement:
    """What views are worth together.

    `cells` (rows, COLUMNS) are True where the views that count cover the picture; `missing` are at most four sentences
    on what to record next. `expected` is at the nearest corner's depth, in the middle and at the farthest one's; it is
    empty, and `residuals` is None, where there is no calibration.
    """

    cells: NDArray[np.bool_]
    missing: tuple[str, ...]
    expected: tuple[ExpectedError, ...]
    residuals: ResidualField | None


def judge_views(
    seen: SeenViews,
    excluded: Collection[str] = (),
    calibration: CameraCalibration | None = None,
    progress: Progress = silent,
) -> ViewsJudgement:
    """Judge the views of `seen` that are not `excluded`; with their `calibration`, those that it uses."""
    progress("judging the views", 0, 1)
    if calibration is not None:
        views = [quality.view for quality in calibration.views if quality.used]
    else:
        views = [view for view in seen.found if view.name not in excluded]
    size = seen.size or (1, 1)
    rows = max(1, round(COLUMNS * size[1] / size[0]))
    camera = None if calibration is None else calibration.camera
    return ViewsJudgement(
        picture_cells(np.concatenate([np.zeros((0, 2)), *(view.uv for view in views)]), size, COLUMNS, rows),
        what_is_missing(views, size, camera),
        () if calibration is None else _over_the_volume(calibration),
        None if calibration is None else residual_field(calibration),
    )


def _over_the_volume(calibration: CameraCalibration) -> tuple[ExpectedError, ...]:
    used = [quality for quality in calibration.views if quality.used]
    depths = np.concatenate([quality.pose.apply(quality.view.points[quality.counted])[:, 2] for quality in used])
    near, far = float(depths.min()), float(depths.max())
    return tuple(expected_error(calibration, depth) for depth in (near, (near + far) / 2, far))
