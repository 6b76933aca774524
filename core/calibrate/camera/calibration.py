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
from itertools import product

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import BoardShape, BoardTolerance
from core.calibrate.camera.adjustment import (
    LEAST_VIEWS,
    counted_observations,
    free_parameters,
    freedom_of,
    solve_judged,
    with_shape,
)
from core.calibrate.camera.board_fit import BoardFit
from core.calibrate.camera.bundle import Bundle, Observed, refine, refine_robustly, residual_lengths
from core.calibrate.camera.covariance import SharedErrorFactors
from core.calibrate.camera.coverage import coverage, tilt_range
from core.calibrate.camera.options import CameraOptions
from core.calibrate.camera.quality import cross_validation_mm, notes_on, rms_and_mean, view_qualities, view_without_part
from core.calibrate.camera.screening import screen
from core.calibrate.camera.settled import has_settled
from core.calibrate.camera.skew import SKEW, skew_helps
from core.calibrate.camera.third_radial import third_radial
from core.calibrate.camera.zhang import centred_matrix, intrinsic_matrix, pose_from_homography, radial_start
from core.calibrate.results import CameraCalibration, ViewQuality
from core.errors import InputError
from core.findings.table import note_of
from core.image.exclusion import Exclusion
from core.image.targets.target_view import TargetView
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.progress import Progress, silent

# Limits beyond which views do not determine a camera; tests/calibrate/camera/test_calibration.py (parallel views) holds
# them.
_LEAST_TILT_RANGE = np.deg2rad(3.0)
"""rad between the targets' planes of two views at least: in parallel planes a focal length is not told from a
distance."""
_MOST_FOCAL_SD = 0.05
"""Standard deviation of the focal length as a share of it."""
_MOST_CENTRE_SD = 0.1
"""Standard deviation of the principal point as a share of the picture's longer side."""

_STEP = "Calibrating the camera"
_STAGES = 5
"""Name of the step for the progress, and its parts."""
_MORE_VIEWS = Message(
    "advice.more_views", "take 10 to 15 pictures of the whole target, tilted by up to 30° in different directions"
)


def calibrate_camera(
    views: Sequence[TargetView],
    image_size: tuple[int, int],
    options: CameraOptions | None = None,
    progress: Progress = silent,
    excluded: Collection[str] = (),
    tolerance: BoardTolerance | None = None,
) -> CameraCalibration:
    """Calibrate the camera that took `views` of a flat target, in pictures of `image_size` (width, height).

    Whether skew and k3 are worth solving for is decided here if the options leave it open.

    Corners are weighted by their `sigma` relative to each other; its true size is estimated from the residuals. Views
    whose name is in `excluded` have no part in the solution; they are returned with their residuals under it. The
    target's shape is estimated, too, within its `tolerance`; None: it has its size, and is flat unless the views surely
    show otherwise.

    Raises
    ------
    InputError
        When fewer than three views can be used, or when the views do not determine the camera (all in parallel).
    ValueError
        When a `sigma` is not positive.
    """
    options = options or CameraOptions()
    taken = [view for view in views if view.name not in excluded]
    calibration = _calibrated(taken, image_size, options, tolerance or BoardTolerance(scale_sd=0.0), progress)
    if tolerance is not None:
        calibration = replace(calibration, notes=(*calibration.notes, *tolerance.notes("camera_target")))
    left_out = [view for view in views if view.name in excluded]
    if not left_out:
        return calibration
    solved = iter(calibration.views)
    qualities = tuple(
        view_without_part(view, calibration.camera, Exclusion.BY_HAND, calibration.board)
        if view.name in excluded
        else next(solved)
        for view in views
    )
    note = note_of(
        "camera.views_left_out_by_hand", n=len(left_out), all=len(views), names=tuple(view.name for view in left_out)
    )
    return replace(calibration, views=qualities, notes=(note, *calibration.notes))


def _calibrated(
    views: Sequence[TargetView],
    image_size: tuple[int, int],
    options: CameraOptions,
    tolerance: BoardTolerance,
    progress: Progress,
    *,
    skew_left_out: bool = False,
) -> CameraCalibration:
    """The camera from those of `views` that fit together.

    `skew_left_out`: γ was tried and does not help, but nobody has said that it is 0.
    """
    progress(_STEP, 0, _STAGES)
    screened = [screen(view) for view in views]
    reasons = {index: found for index, found in enumerate(screened) if isinstance(found, Message)}
    usable = [index for index in range(len(views)) if index not in reasons]
    _require_views(views, usable, reasons)
    observed = _observed([views[index] for index in usable])
    homographies = [found for found in screened if not isinstance(found, Message)]

    free, bundle = free_parameters(options), start_of(homographies, observed, image_size, options)
    progress(_STEP, 1, _STAGES)
    if options.outliers != "keep":
        bundle = refine_robustly(bundle, observed, free)
    progress(_STEP, 2, _STAGES)
    bundle, verdicts = solve_judged(bundle, observed, options)
    if options.skew is None:
        used, counted = counted_observations(observed, verdicts)
        if not skew_helps(bundle.of_views(used), counted, free):
            return _calibrated(views, image_size, replace(options, skew=False), tolerance, progress, skew_left_out=True)
    fit, bundle, verdicts = with_shape(bundle, verdicts, observed, options, tolerance)
    if options.k3 is None and not options.fixed & {"k1", "k2"}:
        used, counted = counted_observations(observed, verdicts)
        found = third_radial(bundle.of_views(used), fit.shaped(counted), free)
        if found is not None:  # the skew is judged again with it
            again = replace(options, skew=None if skew_left_out else options.skew, k3=True)
            calibration = _calibrated(views, image_size, again, tolerance, progress)
            return replace(calibration, notes=(found.note, *calibration.notes))
    reasons |= {index: v.reason for index, v in zip(usable, verdicts, strict=True) if v.reason is not None}
    _require_views(views, [index for index in usable if index not in reasons], reasons)

    progress(_STEP, 3, _STAGES)
    used, counted = counted_observations(observed, verdicts)
    solved = bundle.of_views(used)
    covariance, shape, widening = _covariance(solved, counted, free, fit)
    if skew_left_out:
        covariance = _with_skew(covariance, solved, counted, free, fit)
        widening = _without_skew_left_out(widening, solved, counted, free, fit)
    progress(_STEP, 4, _STAGES)
    fits = {index: (pose, verdict) for index, pose, verdict in zip(usable, bundle.poses, verdicts, strict=True)}
    qualities = view_qualities(views, reasons, bundle.camera, fits, shape)
    calibration = replace(_summary(qualities, solved, fit.shaped(counted), covariance, free), board=shape)
    calibration = replace(calibration, converged=has_settled(calibration))
    progress(_STEP, _STAGES, _STAGES)
    of_fit = () if calibration.converged else (note_of("camera.not_converged"),)
    return replace(calibration, notes=(*of_fit, *notes_on(calibration, widening)))


def _observed(views: Sequence[TargetView]) -> list[Observed]:
    """Views with weights relative to a typical corner, so that weighted residuals stay in pixels."""
    sigmas = np.concatenate([view.sigma for view in views])
    if not (np.isfinite(sigmas).all() and (sigmas > 0).all()):
        raise ValueError("every sigma of a view must be positive")
    typical = float(np.median(sigmas))
    return [Observed(view.points, view.uv, (typical / view.sigma) ** 2) for view in views]


def _covariance(
    bundle: Bundle, counted: Sequence[Observed], free: NDArray[np.intp], fit: BoardFit
) -> tuple[Array, BoardShape, SharedErrorFactors]:
    """Covariance (10, 10) of the camera, the board's shape with its own, and how both were widened.

    InputError where the views do not determine the camera.
    """
    range_of_tilt = tilt_range(bundle.poses)
    if range_of_tilt < _LEAST_TILT_RANGE:
        raise InputError(
            Message(
                "camera.parallel_views",
                "all views show the target in parallel planes, from which a focal length cannot be told from a "
                "distance (tilted by at most {tilt:.1f}° against each other)",
                tilt=np.rad2deg(range_of_tilt),
            ),
            todo=_MORE_VIEWS,
        )
    covariance = np.zeros((10, 10))
    try:
        both, widening = fit.covariance(bundle, counted, free, freedom_of(counted, free))
        covariance[np.ix_(free, free)] = both[: len(free), : len(free)]
    except np.linalg.LinAlgError:
        what = Message("camera.views_alike", "the views do not determine the camera: too much alike")
        raise InputError(what, todo=_MORE_VIEWS) from None
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0))
    camera = bundle.camera
    loose_focal = max(deviation[0] / camera.matrix[0, 0], deviation[1] / camera.matrix[1, 1])
    loose_centre = max(deviation[3], deviation[4]) / max(camera.image_size)
    if loose_focal > _MOST_FOCAL_SD or loose_centre > _MOST_CENTRE_SD:
        raise InputError(
            Message(
                "camera.not_determined",
                "the views do not determine the camera: its focal length is uncertain by {focal:.0f} %, the centre of "
                "its picture by {centre:.0f} % of the picture",
                focal=100 * loose_focal,
                centre=100 * loose_centre,
            ),
            todo=_MORE_VIEWS,
        )
    return covariance, fit.shape(both, len(free)), widening


def _with_skew(
    covariance: Array, bundle: Bundle, counted: Sequence[Observed], free: NDArray[np.intp], fit: BoardFit
) -> Array:
    """The covariance (10, 10) if γ were `free` as well: that it is left at 0 is the model's choice, not knowledge.

    As it is where the views do not determine γ, of which nothing then is known.
    """
    known = np.union1d(free, [SKEW])
    try:
        both, _ = fit.covariance(bundle, counted, known, freedom_of(counted, known))
    except np.linalg.LinAlgError:
        return covariance
    wider = np.zeros_like(covariance)
    wider[np.ix_(known, known)] = both[: len(known), : len(known)]
    return wider


def _without_skew_left_out(
    widening: SharedErrorFactors, bundle: Bundle, counted: Sequence[Observed], free: NDArray[np.intp], fit: BoardFit
) -> SharedErrorFactors:
    """The factors less what γ explains that is left at 0: errors of the model are none that a view's corners share.

    They are told; σ stays as wide as it is.
    """
    if not widening.err_together:
        return widening
    known = np.union1d(free, [SKEW])
    with_skew = refine(bundle, fit.shaped(counted), known)
    try:
        _, explained = fit.covariance(with_skew, counted, known, freedom_of(counted, known))
    except np.linalg.LinAlgError:
        return widening
    return replace(widening, within_views=min(widening.within_views, explained.within_views))


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


def _require_views(views: Sequence[TargetView], usable: Sequence[int], reasons: dict[int, Message]) -> None:
    if len(usable) >= LEAST_VIEWS:
        return
    numbers = {"n": len(usable), "all": len(views), "least": LEAST_VIEWS}
    what = Message(
        "camera.few_usable_views",
        "only {n} of {all} views of the target can be used and a camera needs at least {least}",
        **numbers,
    )
    if reasons:
        what = Message(
            "camera.few_usable_views_why",
            "only {n} of {all} views of the target can be used and a camera needs at least {least} ({reasons:;})",
            reasons=tuple(_of_view(views[index], index, reason) for index, reason in reasons.items()),
            **numbers,
        )
    raise InputError(what, todo=_MORE_VIEWS)


def _of_view(view: TargetView, index: int, reason: Message) -> Message:
    """Message with the reason of one view."""
    name = view.name or Message("camera.view_number", "view {number}", number=index + 1)
    return Message("camera.of_view", "{view}: {reason}", view=name, reason=reason)


def start_of(
    homographies: Sequence[Array], observed: Sequence[Observed], image_size: tuple[int, int], options: CameraOptions
) -> Bundle:
    """Choose a start in closed form for the calibration, with the smallest median residual of several.

    `homographies` (3, 3) are those of the views `observed`, in the same order.
    """
    matrices = [
        centred_matrix(homographies, image_size),
        intrinsic_matrix(homographies, image_size, options.skew is not False),
    ]
    free = ("k1" not in options.fixed, "k2" not in options.fixed)
    starts = []
    for matrix, radial in product(matrices, (free, (False, False))):
        if matrix is None:
            continue
        poses = tuple(pose_from_homography(matrix, h) for h in homographies)
        undistorted = Camera(image_size, matrix)
        positions = np.concatenate([p.apply(view.points) for p, view in zip(poses, observed, strict=True)])
        uv = np.concatenate([view.uv for view in observed])
        k1, k2 = radial_start(matrix, positions[:, :2] / positions[:, 2:], uv, radial)
        camera = replace(undistorted, distortion=np.array([k1, k2, 0, 0]))
        starts.append(Bundle(camera, poses))
    return min(starts, key=lambda start: float(np.median(np.concatenate(residual_lengths(start, observed)))))
