"""Camera calibration from views of a flat target: Zhang's start, then all parameters and poses together.

Every view is screened (is it this target at all?), the closed form starts a robust bundle adjustment, views and
corners out of line with the rest are left out, and the plain least-squares solution of what remains is the result,
with its covariance, its residuals and what it covers.

References
----------
Sun et al., Sensors 2023, 23, 13, §3.1, doi:10.3390/s23010013.
Zhang, Z., IEEE Trans. PAMI 22 (2000) 1330–1334, doi:10.1109/34.888718.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_fit import BoardFit
from core.calibrate.board_shape import BoardShape, BoardTolerance
from core.calibrate.bundle import Bundle, Observed, refine_robustly
from core.calibrate.camera_adjustment import MIN_VIEWS, freedom_of, solve_judged, what_counts, with_shape
from core.calibrate.camera_covariance import Widening
from core.calibrate.camera_notes import notes_on
from core.calibrate.camera_options import CameraOptions
from core.calibrate.camera_quality import cross_validation_mm, rms_and_mean, view_qualities, view_without_part
from core.calibrate.camera_start import start_of
from core.calibrate.coverage import coverage, tilt_range
from core.calibrate.results import LEFT_OUT, CameraCalibration, ViewQuality
from core.calibrate.screening import screen
from core.errors import InputError
from core.image.target_view import TargetView
from core.model.arrays import Array
from core.progress import Progress, silent

_MIN_TILT = np.deg2rad(3.0)
_LOOSE_FOCAL = 0.05
_LOOSE_CENTRE = 0.1
_STEP = "Calibrating the camera"
_STAGES = 5
_MORE_VIEWS = "take 10 to 15 pictures of the whole target, tilted by up to 30° in different directions"


def calibrate_camera(
    views: Sequence[TargetView],
    image_size: tuple[int, int],
    options: CameraOptions | None = None,
    progress: Progress = silent,
    excluded: Collection[str] = (),
    tolerance: BoardTolerance | None = None,
) -> CameraCalibration:
    """Calibrate the camera that took `views` of a flat target, in pictures of `image_size` (width, height).

    Corners are weighted by their `sigma` relative to each other; how large it really is, the residuals tell. Views
    whose name is in `excluded` have no part in the solution; they come back with their residuals under it. The target's
    shape is solved for, too, within its `tolerance`.

    Raises
    ------
    InputError
        When fewer than three views can be used, or when the views do not determine the camera (all in parallel).
    ValueError
        When a `sigma` is not positive.
    """
    options = options or CameraOptions()
    taken = [view for view in views if view.name not in excluded]
    calibration = _calibrated(taken, image_size, options, tolerance or BoardTolerance(), progress)
    left_out = [view for view in views if view.name in excluded]
    if not left_out:
        return calibration
    solved = iter(calibration.views)
    qualities = tuple(
        view_without_part(view, calibration.camera, LEFT_OUT, calibration.board)
        if view.name in excluded
        else next(solved)
        for view in views
    )
    note = f"{len(left_out)} of {len(views)} views are left out by hand: {', '.join(view.name for view in left_out)}."
    return replace(calibration, views=qualities, notes=(note, *calibration.notes))


def _calibrated(
    views: Sequence[TargetView],
    image_size: tuple[int, int],
    options: CameraOptions,
    tolerance: BoardTolerance,
    progress: Progress,
) -> CameraCalibration:
    """The camera from those of `views` that fit together."""
    progress(_STEP, 0, _STAGES)
    screened = [screen(view) for view in views]
    usable = [index for index, (_, reason) in enumerate(screened) if not reason]
    reasons = {index: reason for index, (_, reason) in enumerate(screened) if reason}
    _require_views(views, usable, reasons)
    observed = _observed([views[index] for index in usable])
    homographies = [matrix for matrix, _ in screened if matrix is not None]

    bundle = start_of(homographies, observed, image_size, options)
    progress(_STEP, 1, _STAGES)
    if options.outliers != "keep":
        bundle = refine_robustly(bundle, observed, options.free)
    progress(_STEP, 2, _STAGES)
    bundle, verdicts = solve_judged(bundle, observed, options)
    fit, bundle, verdicts = with_shape(bundle, verdicts, observed, options, tolerance)
    reasons |= {index: v.reason for index, v in zip(usable, verdicts, strict=True) if not v.used}
    _require_views(views, [index for index in usable if index not in reasons], reasons)

    progress(_STEP, 3, _STAGES)
    used, counted = what_counts(observed, verdicts)
    solved = bundle.of_views(used)
    covariance, shape, widening = _covariance(solved, counted, options.free, fit)
    progress(_STEP, 4, _STAGES)
    fits = {index: (pose, verdict) for index, pose, verdict in zip(usable, bundle.poses, verdicts, strict=True)}
    qualities = view_qualities(views, [reason for _, reason in screened], bundle.camera, fits, shape)
    calibration = replace(_summary(qualities, solved, fit.shaped(counted), covariance, options.free), board=shape)
    progress(_STEP, _STAGES, _STAGES)
    return replace(calibration, notes=notes_on(calibration, widening))


def _observed(views: Sequence[TargetView]) -> list[Observed]:
    """Views with weights relative to a typical corner, so that weighted residuals stay in pixels."""
    sigmas = np.concatenate([view.sigma for view in views])
    if not (np.isfinite(sigmas).all() and (sigmas > 0).all()):
        raise ValueError("every sigma of a view must be positive")
    typical = float(np.median(sigmas))
    return [Observed(view.points, view.uv, (typical / view.sigma) ** 2) for view in views]


def _covariance(
    bundle: Bundle, counted: Sequence[Observed], free: NDArray[np.intp], fit: BoardFit
) -> tuple[Array, BoardShape, Widening]:
    """Covariance (10, 10) of the camera, the board's shape with its own, and how both were widened.

    InputError where the views do not determine the camera.
    """
    range_of_tilt = tilt_range(bundle.poses)
    if range_of_tilt < _MIN_TILT:
        raise InputError(
            "all views show the target in parallel planes, from which a focal length cannot be told from a distance "
            f"(tilted by at most {np.rad2deg(range_of_tilt):.1f}° against each other)",
            todo=_MORE_VIEWS,
        )
    covariance = np.zeros((10, 10))
    try:
        both, widening = fit.covariance(bundle, counted, free, freedom_of(counted, free))
        covariance[np.ix_(free, free)] = both[: len(free), : len(free)]
    except np.linalg.LinAlgError:
        raise InputError("the views do not determine the camera: too much alike", todo=_MORE_VIEWS) from None
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0))
    camera = bundle.camera
    loose_focal = max(deviation[0] / camera.matrix[0, 0], deviation[1] / camera.matrix[1, 1])
    loose_centre = max(deviation[3], deviation[4]) / max(camera.image_size)
    if loose_focal > _LOOSE_FOCAL or loose_centre > _LOOSE_CENTRE:
        raise InputError(
            f"the views do not determine the camera: its focal length is uncertain by {100 * loose_focal:.0f} %, the "
            f"centre of its picture by {100 * loose_centre:.0f} % of the picture",
            todo=_MORE_VIEWS,
        )
    return covariance, fit.shape(both, len(free)), widening


def _summary(
    qualities: tuple[ViewQuality, ...],
    solved: Bundle,
    counted: Sequence[Observed],
    covariance: Array,
    free: NDArray[np.intp],
) -> CameraCalibration:
    errors = np.concatenate([quality.residuals[quality.counted] for quality in qualities if quality.used])
    rms, mean = rms_and_mean(errors)
    uv = np.concatenate([view.uv for view in counted])
    return CameraCalibration(
        camera=solved.camera,
        covariance=covariance,
        views=qualities,
        rms_px=rms,
        mean_px=mean,
        coverage=coverage(uv, solved.camera.image_size),
        tilt_range=tilt_range(solved.poses),
        cross_validation_mm=cross_validation_mm(solved, counted, free),
    )


def _require_views(views: Sequence[TargetView], usable: Sequence[int], reasons: dict[int, str]) -> None:
    if len(usable) >= MIN_VIEWS:
        return
    why = "; ".join(f"{views[index].name or f'view {index + 1}'}: {reason}" for index, reason in reasons.items())
    raise InputError(
        f"only {len(usable)} of {len(views)} views of the target can be used and a camera needs at least {MIN_VIEWS}"
        + (f" ({why})" if why else ""),
        todo=_MORE_VIEWS,
    )
