"""Quality of a camera calibration: fit of its views, agreement of two halves, and notes for the technician."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import BoardShape
from core.calibrate.camera.bundle import NO_PARAMETERS, Bundle, Observed, refine, refine_robustly
from core.calibrate.camera.covariance import MUCH_WIDER, SharedErrorFactors
from core.calibrate.camera.coverage import disagreement_mm, empty_regions, tilt
from core.calibrate.camera.picture_residuals import notes_on_picture
from core.calibrate.camera.screening import Verdict, screen
from core.calibrate.camera.zhang import pose_from_homography
from core.calibrate.results import CameraCalibration, ViewQuality
from core.findings.table import note_of
from core.image.exclusion import Exclusion, Reason
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera, Pose
from core.model.arrays import Array

# When a note is made; tests/calibrate/camera/test_calibration.py (coverage, few views, hardly tilted) holds some.
_ENOUGH_VIEWS = 8
"""Views below which more are advised."""
_ENOUGH_TILT_RANGE = np.deg2rad(25.0)
"""rad between two views: below, the focal length stays uncertain."""
_WORSE_VIEW = 3.0
"""Times the usual RMS of the views."""
_BOWED_MM = 0.05
"""Departure from flat that is worth a note."""
_LEAST_HALVED = 6
"""Views at least that are compared in two halves: three for each camera."""


def fitted_view(view: TargetView, camera: Camera, pose: Pose, verdict: Verdict, board: BoardShape) -> ViewQuality:
    """Compute residuals and RMS in px of a `view`, for this `camera`, `pose` of the target and shape of the board."""
    errors = view.uv - camera.project_pose(pose, board.shaped(view.points))
    rms, mean = rms_and_mean(errors[verdict.counted])
    return ViewQuality(view, pose, errors, rms, mean, tilt(pose), verdict.used, verdict.exclusion, verdict.counted)


def unfitted_view(view: TargetView, exclusion: Reason) -> ViewQuality:
    """Make the entry of a view that has no pose and is left out for the reason `exclusion`."""
    nowhere, none = np.full(view.uv.shape, np.nan), np.zeros(len(view.uv), dtype=np.bool_)
    return ViewQuality(view, Pose.identity(), nowhere, np.nan, np.nan, np.nan, False, exclusion, none)


def view_without_part(view: TargetView, camera: Camera, exclusion: Exclusion, board: BoardShape) -> ViewQuality:
    """Compute residuals in px of a view left out of the calibration, at the pose that fits it best.

    A view that does not even look like the target has no pose; why is added to the `exclusion`.
    """
    homography = screen(view)
    if isinstance(homography, Message):
        return unfitted_view(
            view, Message("camera.two_reasons", "{reasons:;}", reasons=(exclusion.message, homography))
        )
    alone = Bundle(camera, (pose_from_homography(camera.matrix, homography),))
    seen = Observed(board.shaped(view.points), view.uv, (float(np.median(view.sigma)) / view.sigma) ** 2)
    (pose,) = refine_robustly(alone, [seen], NO_PARAMETERS).poses
    return fitted_view(view, camera, pose, Verdict(False, np.ones(len(view.uv), dtype=np.bool_), exclusion), board)


def view_qualities(
    views: Sequence[TargetView],
    reasons: Mapping[int, Message],
    camera: Camera,
    fits: Mapping[int, tuple[Pose, Verdict]],
    board: BoardShape,
) -> tuple[ViewQuality, ...]:
    """List residuals and verdict of all `views`: by `fits` of their index, or left out for one of the `reasons`."""
    return tuple(
        fitted_view(view, camera, *fits[index], board) if index in fits else unfitted_view(view, reasons[index])
        for index, view in enumerate(views)
    )


def rms_and_mean(errors: Array) -> tuple[float, float]:
    """Compute RMS and mean of the lengths of residual vectors (N, 2)."""
    lengths = np.linalg.norm(errors, axis=1)
    return float(np.sqrt(np.mean(lengths**2))), float(lengths.mean())


def cross_validation_mm(solved: Bundle, counted: Sequence[Observed], free: NDArray[np.intp]) -> float:
    """Compute the RMS distance in mm, in the work volume, between points by cameras of odd and of even views.

    The volume is what the corners' part of the picture sees between the nearest and the farthest corner. With half
    the views each, the two differ by about twice the standard uncertainty of the camera from all. NaN with fewer
    than six views.
    """
    if len(counted) < _LEAST_HALVED:
        return float("nan")
    cameras = [refine(Bundle(solved.camera, solved.poses[half::2]), counted[half::2], free).camera for half in (0, 1)]
    uv = np.concatenate([view.uv for view in counted])
    depths = np.concatenate([p.apply(view.points)[:, 2] for p, view in zip(solved.poses, counted, strict=True)])
    return disagreement_mm(cameras[0], cameras[1], uv, (float(depths.min()), float(depths.max())))


def notes_on(calibration: CameraCalibration, widening: SharedErrorFactors) -> tuple[Message, ...]:
    """Note views and corners left out, poor coverage, small tilts, few views, correlated residuals; () if none."""
    used = [quality for quality in calibration.views if quality.used]
    notes = [
        note_of("camera.view_left_out", view=_name(quality), reason=quality.reason)
        for quality in calibration.views
        if quality.reason is not None
    ]
    notes += [
        note_of("camera.misfound_corners", n=int(np.sum(~quality.counted)), view=_name(quality))
        for quality in used
        if not quality.counted.all()
    ]
    notes += _worse_views(used)
    if len(used) < _ENOUGH_VIEWS:
        notes.append(note_of("camera.few_views", n=len(used), least=_ENOUGH_VIEWS))
    uv = np.concatenate([quality.view.uv[quality.counted] for quality in used])
    empty = empty_regions(uv, calibration.camera.image_size)
    if empty:
        notes.append(note_of("camera.empty_regions", places=tuple(empty)))
    if calibration.tilt_range < _ENOUGH_TILT_RANGE:
        notes.append(note_of("camera.small_tilts", tilt=np.rad2deg(calibration.tilt_range)))
    if np.isnan(calibration.cross_validation_mm):
        notes.append(note_of("camera.too_few_to_compare"))
    shape = calibration.board
    if shape.surely_bowed and shape.departure_mm > _BOWED_MM:
        notes.append(note_of("camera.bowed_target", bow=shape.departure_mm))
    notes += notes_on_picture(calibration)
    if widening.err_together:
        notes.append(note_of("camera.corners_err_together", times=widening.within_views))
    if widening.across_views > MUCH_WIDER:
        notes.append(note_of("camera.corners_err_alike", times=widening.across_views))
    return tuple(notes)


def _worse_views(used: list[ViewQuality]) -> list[Message]:
    typical = float(np.median([quality.rms_px for quality in used]))
    return [
        note_of(
            "camera.worse_view", view=_name(quality), times=quality.rms_px / typical, rms=quality.rms_px, usual=typical
        )
        for quality in used
        if quality.rms_px > _WORSE_VIEW * typical
    ]


def _name(quality: ViewQuality) -> str | Message:
    return quality.name or Message("camera.nameless_view", "A view without a name")
