"""Views of the camera's target: what each picture shows, and what they cover and lack together."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.coverage import covered_cells
from core.calibrate.camera.expected_error import ExpectedError, ResidualField, expected_error, residual_field
from core.calibrate.camera.missing import what_is_missing
from core.calibrate.results import CameraCalibration
from core.image.exclusion import Excludable, Reason
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.progress import Progress, silent


@dataclass(frozen=True, eq=False, slots=True)
class SeenView(Excludable):
    """View in one picture: the target found in it, or the exclusion; size (width, height) if it could be read."""

    name: str
    view: TargetView | None = None
    exclusion: Reason | None = None
    size: tuple[int, int] | None = None


@dataclass(frozen=True, eq=False, slots=True)
class SeenViews:
    """Views in all pictures of the camera target, in the order of the set; `where` they lie, for messages.

    `hot` is the number of pixels that shine by themselves in the pictures; None: not known.
    """

    views: tuple[SeenView, ...]
    where: str
    hot: int | None = None

    @property
    def size(self) -> tuple[int, int] | None:
        """Width and height of the pictures in px; None if none could be read."""
        return next((one.size for one in self.views if one.size is not None), None)

    @property
    def found(self) -> tuple[TargetView, ...]:
        """Views of the target in the pictures where it was found."""
        return tuple(one.view for one in self.views if one.view is not None)

    @property
    def lost(self) -> tuple[SeenView, ...]:
        """Pictures in which there is no usable target."""
        return tuple(one for one in self.views if one.view is None)


@dataclass(frozen=True, eq=False, slots=True)
class RecalledCamera:
    """Accepted calibration, with its views if it was made from the project's pictures.

    `as_it_is`: it is what these pictures give with the project's settings as they are.
    """

    calibration: CameraCalibration
    seen: SeenViews | None
    as_it_is: bool


def recovered_views(calibration: CameraCalibration, where: str) -> SeenViews:
    """Make the views that a stored `calibration` was solved from, so that it can be solved again without pictures."""
    size = calibration.camera.image_size
    return SeenViews(
        tuple(
            SeenView(quality.name, quality.view if len(quality.view.uv) else None, quality.exclusion, size)
            for quality in calibration.views
        ),
        where,
        calibration.hot_pixels,
    )


@dataclass(frozen=True, eq=False, slots=True)
class ViewsJudgement:
    """Judgement of a set of views.

    `cells` (rows, columns) are True where the corners that count cover the picture: with a calibration their share is
    its `coverage`. `missing` says what to record next, in at most four sentences. `expected` is at the nearest corner's
    depth, in the middle and at the farthest one's; it is empty, and `residuals` is None, where there is no calibration.
    """

    cells: NDArray[np.bool_]
    missing: tuple[Message, ...]
    expected: tuple[ExpectedError, ...]
    residuals: ResidualField | None


def judge_views(
    seen: SeenViews,
    excluded: Collection[str] = (),
    calibration: CameraCalibration | None = None,
    progress: Progress = silent,
) -> ViewsJudgement:
    """Judge which parts of the picture the views of `seen` cover and what they lack; by `calibration`, if there is one.

    Views named in `excluded` are left out; with a calibration, all that it does not use.
    """
    progress("judging the views", 0, 1)
    if calibration is not None:
        used = [quality for quality in calibration.views if quality.used]
        views, counted = [one.view for one in used], [one.view.uv[one.counted] for one in used]
    else:
        views = [view for view in seen.found if view.name not in excluded]
        counted = [view.uv for view in views]
    size = seen.size or (1, 1)
    camera = None if calibration is None else calibration.camera
    return ViewsJudgement(
        covered_cells(np.concatenate([np.zeros((0, 2)), *counted]), size),
        what_is_missing(views, size, camera),
        () if calibration is None else _over_the_volume(calibration),
        None if calibration is None else residual_field(calibration),
    )


def _over_the_volume(calibration: CameraCalibration) -> tuple[ExpectedError, ...]:
    used = [quality for quality in calibration.views if quality.used]
    depths = np.concatenate([quality.pose.apply(quality.view.points[quality.counted])[:, 2] for quality in used])
    near, far = float(depths.min()), float(depths.max())
    return tuple(expected_error(calibration, depth) for depth in (near, (near + far) / 2, far))
