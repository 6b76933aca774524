"""How well views fit a calibrated camera, and how well two halves of them agree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from core.calibrate.board_shape import BoardShape
from core.calibrate.bundle import NO_PARAMETERS, Bundle, Observed, refine, refine_robustly
from core.calibrate.coverage import disagreement_mm, tilt
from core.calibrate.results import ViewQuality
from core.calibrate.screening import Verdict, screen
from core.calibrate.zhang import pose_from_homography
from core.image.target_view import TargetView
from core.model import Camera, Pose
from core.model.arrays import Array


def fitted_view(view: TargetView, camera: Camera, pose: Pose, verdict: Verdict, board: BoardShape) -> ViewQuality:
    """How `view` of a `board` fits `camera` at `pose`."""
    errors = view.uv - camera.project_pose(pose, board.shaped(view.points))
    rms, mean = rms_and_mean(errors[verdict.counted])
    return ViewQuality(view, pose, errors, rms, mean, tilt(pose), verdict.used, verdict.reason, verdict.counted)


def unfitted_view(view: TargetView, reason: str) -> ViewQuality:
    """A view for which no pose was looked for."""
    nowhere, none = np.full(view.uv.shape, np.nan), np.zeros(len(view.uv), dtype=np.bool_)
    return ViewQuality(view, Pose.identity(), nowhere, np.nan, np.nan, np.nan, False, reason, none)


def view_without_part(view: TargetView, camera: Camera, reason: str, board: BoardShape) -> ViewQuality:
    """How a view that had no part in calibrating `camera` fits it, at the pose that suits the view best.

    Where it does not even look like the target there is no pose, and it says so after the `reason`.
    """
    homography, doubt = screen(view)
    if homography is None:
        return unfitted_view(view, f"{reason}; {doubt}")
    alone = Bundle(camera, (pose_from_homography(camera.matrix, homography),))
    seen = Observed(board.shaped(view.points), view.uv, (float(np.median(view.sigma)) / view.sigma) ** 2)
    (pose,) = refine_robustly(alone, [seen], NO_PARAMETERS).poses
    return fitted_view(view, camera, pose, Verdict(False, np.ones(len(view.uv), dtype=np.bool_), reason), board)


def view_qualities(
    views: Sequence[TargetView],
    reasons: Sequence[str],
    camera: Camera,
    fits: Mapping[int, tuple[Pose, Verdict]],
    board: BoardShape,
) -> tuple[ViewQuality, ...]:
    """Qualities of all `views`: those of index in `fits` with pose and verdict, the others with their reason."""
    return tuple(
        fitted_view(view, camera, *fits[index], board) if index in fits else unfitted_view(view, reasons[index])
        for index, view in enumerate(views)
    )


def rms_and_mean(errors: Array) -> tuple[float, float]:
    """Root mean square and mean of the lengths of residual vectors (N, 2)."""
    lengths = np.linalg.norm(errors, axis=1)
    return float(np.sqrt(np.mean(lengths**2))), float(lengths.mean())


def cross_validation_mm(solved: Bundle, counted: Sequence[Observed], free: NDArray[np.intp]) -> float:
    """RMS distance in mm between what cameras solved from odd and from even views see in the work volume.

    The volume is what the corners' part of the picture sees between the nearest and the farthest corner. With half
    the views each, the two differ by about twice the standard uncertainty of the camera from all. NaN with fewer
    than six views.
    """
    if len(counted) < 6:
        return float("nan")
    cameras = [refine(Bundle(solved.camera, solved.poses[half::2]), counted[half::2], free).camera for half in (0, 1)]
    uv = np.concatenate([view.uv for view in counted])
    depths = np.concatenate([p.apply(view.points)[:, 2] for p, view in zip(solved.poses, counted, strict=True)])
    return disagreement_mm(cameras[0], cameras[1], uv, (float(depths.min()), float(depths.max())))
