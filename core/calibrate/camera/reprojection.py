"""Projection of a target's points, and its derivatives by every parameter of camera and pose.

The camera is a vector of ten numbers in the order of CAMERA_PARAMETERS. A pose changes by a small rotation vector ω
in rad, applied in front of the rotation, and a shift of the translation in mm: six numbers.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from core.model import Camera, Pose
from core.model.arrays import Array


def parameters_of(camera: Camera) -> Array:
    """List the parameters (10,) of `camera` in the order of CAMERA_PARAMETERS."""
    (alpha, gamma, u0), (_, beta, v0), _ = camera.matrix
    return np.array([alpha, beta, gamma, u0, v0, *camera.distortion])


def camera_of(parameters: Array, image_size: tuple[int, int]) -> Camera:
    """Make the camera with these `parameters` (10,); ValueError when they are no camera's."""
    alpha, beta, gamma, u0, v0 = parameters[:5]
    return Camera(image_size, np.array([[alpha, gamma, u0], [0, beta, v0], [0, 0, 1]]), parameters[5:])


def moved(pose: Pose, step: Array) -> Pose:
    """Apply a small `step` (6,), a rotation vector in rad and a shift in mm, in front of a pose."""
    return all_moved([pose], step[None])[0]


def all_moved(poses: Sequence[Pose], steps: Array) -> tuple[Pose, ...]:
    """Apply to each of V poses its own of the small `steps` (V, 6): rotation vector in rad, shift in mm."""
    turns = Rotation.from_rotvec(steps[:, :3]).as_matrix()
    return tuple(
        Pose(turn @ pose.rotation, pose.translation + step[3:])
        for pose, turn, step in zip(poses, turns, steps, strict=True)
    )


def linearise(camera: Camera, pose: Pose, points: Array) -> tuple[Array, Array, Array]:
    """Project target `points` (N, 3) in mm at a `pose` to pixels, with derivatives by camera and pose.

    Returns
    -------
    uv (N, 2) in pixels, ∂uv/∂camera (N, 2, 10) in the order of CAMERA_PARAMETERS, ∂uv/∂pose (N, 2, 6) per rad and
    per mm.
    """
    turned = points @ pose.rotation.T
    return linearise_turned(camera, turned, turned + pose.translation)


def linearise_turned(camera: Camera, turned: Array, position: Array) -> tuple[Array, Array, Array]:
    """Project target points at `position` (N, 3) to pixels, with derivatives by the camera and by their poses.

    The poses may be many: what each changes is what it does to its own points.
    """
    inverse_z = 1 / position[:, 2]
    xy = position[:, :2] * inverse_z[:, None]
    distorted = camera.distort(xy)
    affine = camera.matrix[:2, :2]
    uv = distorted @ affine.T + camera.matrix[:2, 2]

    by_camera = np.concatenate([_by_matrix(distorted), affine @ _by_distortion(xy)], axis=2)

    by_position = np.zeros((len(turned), 2, 3))
    by_position[:, 0, 0] = by_position[:, 1, 1] = inverse_z
    by_position[:, :, 2] = -xy * inverse_z[:, None]
    by_position = affine @ camera.distort_jacobian(xy) @ by_position
    by_pose = np.empty((len(turned), 2, 6))
    (x, y, z), (a, b, c) = turned.T[:, :, None], np.moveaxis(by_position, 2, 0)
    by_pose[:, :, 0] = y * c - z * b  # a · (ω × X) = ω · (X × a); np.cross takes twice as long
    by_pose[:, :, 1] = z * a - x * c
    by_pose[:, :, 2] = x * b - y * a
    by_pose[:, :, 3:] = by_position
    return uv, by_camera, by_pose


def ray_changes(camera: Camera, rays: Array) -> Array:
    """Compute the derivatives (N, 2, 10) of ray coordinates x, y by the camera's parameters, the pixels held fixed."""
    distorted = camera.distort(rays[:, :2])
    by_camera = np.concatenate([_by_matrix(distorted), camera.matrix[:2, :2] @ _by_distortion(rays[:, :2])], axis=2)
    return np.asarray(-camera.ray_jacobian(rays) @ by_camera, dtype=np.float64)


def _by_matrix(distorted: Array) -> Array:
    """∂uv/∂(α, β, γ, u0, v0) at distorted coordinates (N, 2): (N, 2, 5)."""
    derivative = np.zeros((len(distorted), 2, 5))
    derivative[:, 0, 0] = distorted[:, 0]
    derivative[:, 1, 1] = distorted[:, 1]
    derivative[:, 0, 2] = distorted[:, 1]
    derivative[:, 0, 3] = derivative[:, 1, 4] = 1
    return derivative


def _by_distortion(xy: Array) -> Array:
    """∂(distorted)/∂(k1, k2, p1, p2, k3) at `xy` (N, 2): (N, 2, 5)."""
    x, y = xy[:, 0], xy[:, 1]
    r2 = x * x + y * y
    derivative = np.empty((len(xy), 2, 5))
    derivative[:, :, 0] = xy * r2[:, None]
    derivative[:, :, 1] = xy * (r2 * r2)[:, None]
    derivative[:, 0, 2] = derivative[:, 1, 3] = 2 * x * y
    derivative[:, 1, 2] = r2 + 2 * y * y
    derivative[:, 0, 3] = r2 + 2 * x * x
    derivative[:, :, 4] = xy * (r2**3)[:, None]
    return derivative
