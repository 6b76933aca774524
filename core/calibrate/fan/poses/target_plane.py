"""The plane of a flat target in the inverse-depth form, τ·X = 1 on it, and how it moves with the target's pose."""

from __future__ import annotations

import numpy as np

from core.calibrate.board_shape import BoardShape
from core.calibrate.camera import reprojection
from core.image.targets.target_view import TargetView
from core.model import Camera, Pose
from core.model.arrays import Array


def target_plane(pose: Pose) -> Array:
    """Compute the vector τ (3,) in 1/mm of the target's plane at `pose`: τ·X = 1 for points X on it."""
    return target_plane_changes(pose)[0]


def on_target(rays: Array, pose: Pose, shape: BoardShape | None = None) -> Array:
    """Compute the points (N, 3) in mm where `rays` (N, 3) meet the target at `pose`, flat or of this `shape`."""
    plane = target_plane(pose)
    flat: Array = rays / (rays @ plane)[:, None]
    if shape is None or not shape.values.any():
        return flat
    height = shape.shaped(pose.inverse().apply(flat))[:, 2]
    # what lies h above the plane through distance d lies on the plane through d + h
    return np.asarray(flat * (1 + height * (plane @ pose.rotation[:, 2]))[:, None], dtype=np.float64)


def target_plane_changes(pose: Pose) -> tuple[Array, Array]:
    """Compute τ (3,) of the target's plane, τ·X = 1, and its derivative (3, 6) by turn and shift of the pose."""
    normal = pose.rotation[:, 2]
    distance = float(normal @ pose.translation)
    # column i is e_i × normal: what a small turn about axis i adds to the normal
    turned = np.array([[0.0, normal[2], -normal[1]], [-normal[2], 0.0, normal[0]], [normal[1], -normal[0], 0.0]])
    normal_step = np.hstack([turned, np.zeros((3, 3))])
    distance_step = pose.translation @ normal_step
    distance_step[3:] += normal
    return normal / distance, normal_step / distance - np.outer(normal, distance_step) / distance**2


def target_plane_covariance(view: TargetView, pose: Pose, camera: Camera) -> Array:
    """Compute the covariance (3, 3) in 1/mm² of the target's plane τ, τ·X = 1, from that of the target's points."""
    _, _, by_pose = reprojection.linearise(camera, pose, view.points)
    scaled = view.whitened(by_pose)
    by_step = target_plane_changes(pose)[1]
    covariance: Array = by_step @ np.linalg.pinv(scaled.T @ scaled, hermitian=True, rcond=1e-14) @ by_step.T
    return covariance
