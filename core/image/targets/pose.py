"""Homography and pose of a planar target from one view, with covariance and the two-fold ambiguity of planes."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.image.targets.target_view import TargetNotFound, TargetView
from core.messages import Field, Message
from core.model import Camera, Pose
from core.model.arrays import Array, frozen_array, set_field
from core.model.robust import tukey_weights

ROBUST_FROM = 12
"""Points from which on outliers can be told and the residuals' size estimated."""

CUT = 5.0
"""Residual, in standard deviations, from which on a point has no weight (Tukey's biweight)."""

LIKELIHOOD_STEP = 9.0
"""Growth of χ² from which on the second pose is taken to be the wrong one."""


@dataclass(frozen=True, eq=False, slots=True)
class PoseEstimate:
    """Estimated pose of a target, with its covariance and fit.

    Parameters
    ----------
    pose
        `pose_cam_target`.
    covariance
        (6, 6) of `pose.vector` (rad, mm): from the view's σ, raised by χ²/dof where that exceeds one and there are
        points enough to tell. The camera counts as known.
    residuals
        (N, 2) observed − predicted in pixels, of all points.
    used
        (N,) False for points left out as outliers.
    rms_px
        Root mean square length of the residuals of the points used.
    ambiguous
        True if the view does not tell `pose` from `alternative`.
    alternative
        The second pose, or None.
    """

    pose: Pose
    covariance: Array
    residuals: Array
    used: NDArray[np.bool_]
    rms_px: float
    ambiguous: bool
    alternative: Pose | None

    def __post_init__(self) -> None:
        set_field(self, "covariance", frozen_array(self.covariance, (6, 6), "covariance"))
        set_field(self, "residuals", frozen_array(self.residuals, (None, 2), "residuals"))


def estimate_pose(view: TargetView, camera: Camera) -> PoseEstimate:
    """Estimate the target's pose in the camera frame from the points of `view`; TargetNotFound if none explains them.

    By weighted least squares over the pixel residuals of the full camera model. Both solutions that a plane allows
    (IPPE) are refined; the better one is the pose, and whether the view tells them apart is reported. With twelve
    points or more outliers lose their weight (Tukey).

    Raises
    ------
    TargetNotFound
        If no pose before the camera explains the view.
    ValueError
        If there are fewer than four points.

    References
    ----------
    Collins & Bartoli, Infinitesimal plane-based pose estimation, IJCV 109 (2014), doi:10.1007/s11263-014-0725-5.
    """
    if len(view.points) < 4:
        raise ValueError(f"a pose needs four points, not {len(view.points)}")
    fits = [fit for start in _plane_poses(view, camera) if (fit := _refine(view, camera, start)) is not None]
    if not fits:
        raise TargetNotFound(
            Message("target.no_pose", "no pose of the target in front of the camera explains its points"),
            where=view.name,
            todo=Message(
                "advice.check_calibration_and_size",
                "check the camera's calibration and the target's {field}",
                field=Field("target.size"),
            ),
        )
    scale = min(fit.scale for fit in fits)
    fits.sort(key=lambda fit: fit.misfit(scale))
    best = fits[0]
    other = next((fit for fit in fits[1:] if _apart(best.pose, fit.pose)), None)
    least, second = best.misfit(scale), other.misfit(scale) if other else np.inf
    return PoseEstimate(
        pose=best.pose,
        covariance=_covariance(view, camera, best),
        residuals=best.residuals,
        used=best.weight > 0,
        rms_px=float(np.sqrt(np.mean((best.residuals[best.weight > 0] ** 2).sum(axis=1)))),
        ambiguous=bool(second - least < LIKELIHOOD_STEP),
        alternative=other.pose if other else None,
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Fit:
    pose: Pose
    residuals: Array
    """(N, 2) in pixels."""
    length: Array
    """(N,) of the residuals, in σ of their points."""
    weight: Array
    """(N,) robust weights, 0 … 1."""
    scale: float
    """By how much the residuals exceed their σ; at least 1."""

    def misfit(self, scale: float) -> float:
        """χ² with σ taken `scale` times as large and outliers capped."""
        return float(np.minimum((self.length / scale) ** 2, CUT**2).sum())


def _plane_poses(view: TargetView, camera: Camera) -> list[Pose]:
    """The one or two poses that a plane's undistorted points allow, in front of the camera."""
    xy = camera.undistort(view.uv)
    known = np.isfinite(xy).all(axis=1)
    middle = view.points.mean(axis=0)  # IPPE expands about the middle of the points
    _, turns, moves, _ = cv2.solvePnPGeneric(
        np.ascontiguousarray(view.points[known] - middle)[:, None],
        np.ascontiguousarray(xy[known])[:, None],
        np.eye(3),
        None,
        flags=cv2.SOLVEPNP_IPPE,
    )
    poses = []
    for turn, move in zip(turns, moves, strict=True):
        rotation = Rotation.from_rotvec(np.asarray(turn, dtype=np.float64).ravel()).as_matrix()
        pose = Pose(rotation, np.asarray(move, dtype=np.float64).ravel() - rotation @ middle)
        if np.isfinite(pose.vector).all() and (pose.apply(view.points)[:, 2] > 0).all():
            poses.append(pose)
    return poses


def _refine(view: TargetView, camera: Camera, start: Pose) -> _Fit | None:
    """Levenberg–Marquardt from `start`, with the weights renewed at every step; None if it leaves the half-space."""
    fit = _judge(view, camera, start)
    damping = 1e-6
    for _ in range(60):
        jacobian = _jacobian(view, camera, fit.pose) / view.sigma[:, None, None]
        weighted = jacobian * fit.weight[:, None, None]
        normal = np.einsum("nki,nkj->ij", weighted, jacobian)
        right = np.einsum("nki,nk->i", weighted, fit.residuals / view.sigma[:, None])
        step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), right)
        trial = _moved(fit.pose, step)
        if (trial.apply(view.points)[:, 2] <= 0).any():
            damping = max(damping, 1e-6) * 10
            continue
        after = _judge(view, camera, trial)
        before_cost = float((fit.weight * fit.length**2).sum())
        if float((fit.weight * after.length**2).sum()) <= before_cost * (1 + 1e-12) + 1e-18:
            fit, damping = after, damping / 10
            if step @ normal @ step < 1e-10:
                break
        else:
            damping *= 10
            if damping > 1e8:
                break
    return fit if (fit.pose.apply(view.points)[:, 2] > 0).all() else None


def _judge(view: TargetView, camera: Camera, pose: Pose) -> _Fit:
    residuals = view.uv - camera.project_pose(pose, view.points)
    length = np.linalg.norm(residuals, axis=1) / view.sigma
    weight = np.ones(len(length))
    scale = max(1.0, float(np.median(length)) / 1.177)  # the median length of two normal components
    if len(length) >= ROBUST_FROM:
        weight = tukey_weights(length, CUT * scale)
    return _Fit(pose, residuals, length, weight, scale)


def _jacobian(view: TargetView, camera: Camera, pose: Pose) -> Array:
    """∂(uv)/∂(small rotation in the camera frame, translation): (N, 2, 6)."""
    turned = view.points @ pose.rotation.T
    x, y, z = (turned + pose.translation).T
    to_ray = np.zeros((len(x), 2, 3))
    to_ray[:, 0, 0] = to_ray[:, 1, 1] = 1 / z
    to_ray[:, 0, 2] = -x / z**2
    to_ray[:, 1, 2] = -y / z**2
    to_pixel = camera.matrix[:2, :2] @ camera.distort_jacobian(np.column_stack([x / z, y / z]))
    by_point = to_pixel @ to_ray
    return np.concatenate([-by_point @ cross_matrices(turned), by_point], axis=2)


def cross_matrices(vectors: Array) -> Array:
    """Make the matrices (N, 3, 3) of the cross products with `vectors` (N, 3)."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)


def _moved(pose: Pose, step: Array) -> Pose:
    return Pose(Rotation.from_rotvec(step[:3]).as_matrix() @ pose.rotation, pose.translation + step[3:])


def _apart(a: Pose, b: Pose) -> bool:
    """Whether two poses are two, not one found twice."""
    turn = Rotation.from_matrix(a.rotation.T @ b.rotation).magnitude()
    return bool(turn > 1e-4)


def _covariance(view: TargetView, camera: Camera, fit: _Fit) -> Array:
    """(6, 6) of `fit.pose.vector`."""
    used = fit.weight > 0
    jacobian = _jacobian(view, camera, fit.pose)[used] / view.sigma[used, None, None]
    covariance = np.linalg.inv(np.einsum("nki,nkj->ij", jacobian, jacobian))
    if len(fit.length) >= ROBUST_FROM:
        freedom = max(1.0, 2 * float(np.count_nonzero(used)) - 6)
        covariance *= max(1.0, float((fit.length[used] ** 2).sum()) / freedom)
    change = np.eye(6)
    change[:3, :3] = _vector_by_turn(fit.pose.vector[:3])
    return change @ covariance @ change.T


def _vector_by_turn(vector: Array) -> Array:
    """∂(rotation vector)/∂(small rotation applied after it): the inverse left Jacobian of SO(3)."""
    angle = float(np.linalg.norm(vector))
    cross = cross_matrices(vector[None])[0]
    factor = 1 / 12 if angle < 1e-4 else 1 / angle**2 - (1 + np.cos(angle)) / (2 * angle * np.sin(angle))
    inverse: Array = np.eye(3) - cross / 2 + factor * cross @ cross
    return inverse


def homography_of(xy: Array, uv: Array, *, robust: bool = False) -> Array | None:
    """Fit the homography (3, 3) that maps `xy` (N, 2) to `uv` (N, 2); None if they do not determine one."""
    matrix = cv2.findHomography(xy, uv, cv2.LMEDS if robust else 0)[0]
    return None if matrix is None else np.asarray(matrix, dtype=np.float64)


def map_by(homography: Array, xy: Array) -> Array:
    """Map `xy` (N, 2) by a homography (3, 3) to their images (N, 2)."""
    ends = np.column_stack([xy, np.ones(len(xy))]) @ homography.T
    mapped: Array = ends[:, :2] / ends[:, 2:]
    return mapped
