"""Shapes for drawing a rig in 3D: the camera's pyramid and patches of light planes. Corners only, no results."""

from __future__ import annotations

import numpy as np

from core.model import Camera, LightPlane, Pose
from core.model.arrays import Array


def frustum(camera: Camera, depth_mm: float) -> Array:
    """Its centre and the corners of its picture at `depth_mm`: (5, 3) in mm, from the first pixel clockwise."""
    width, height = camera.image_size
    corners = np.array([[0, 0], [width - 1, 0], [width - 1, height - 1], [0, height - 1]], dtype=np.float64)
    # Without distortion: a pyramid has straight edges, and the corners may lie where the distortion cannot be undone.
    rays = np.linalg.solve(camera.matrix, np.column_stack([corners, np.ones(4)]).T).T
    pyramid: Array = np.vstack([np.zeros(3), rays * depth_mm])
    return pyramid


def plane_patch(plane: LightPlane, camera: Camera, depths_mm: tuple[float, float]) -> Array:
    """A light plane between two depths, as long as the camera's picture is high or wide: corners (4, 3) in mm.

    At each depth the plane is a straight line. It is cut where it leaves the picture at the ends it runs towards, and
    not where it leaves it sideways, so there always are four corners.

    Raises
    ------
    ValueError
        If the plane lies across the camera's axis: it has no depths to be cut at.
    """
    a, b, c = plane.pi
    along = 1 if abs(a) >= abs(b) else 0  # the line runs along y when the plane's normal points along x
    if max(abs(a), abs(b)) < 1e-6 * abs(c):
        raise ValueError("the plane lies across the camera's axis")
    patch = np.empty((4, 3))
    for k, depth in enumerate(depths_mm):
        corners = frustum(camera, depth)[1:, along]
        ends = np.array([corners.min(), corners.max()])
        sideways = (1 - c * depth - plane.pi[along] * ends) / plane.pi[1 - along]
        rows = slice(2 * k, 2 * k + 2)
        patch[rows, along], patch[rows, 1 - along], patch[rows, 2] = ends, sideways, depth
    patch[2:] = patch[[3, 2]]
    return patch


def target_outline(pose: Pose, points: Array) -> Array:
    """The rectangle around a target's points (N, 3), where `pose` puts it before the camera: (5, 3) in mm, closed."""
    (left, top), (right, bottom) = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]])
    outline: Array = np.column_stack([corners, np.zeros(5)]) @ pose.rotation.T + pose.translation
    return outline
