"""Shapes for drawing a rig in 3D: the grid, the camera's pyramid, patches of light planes, outlines of targets."""

from __future__ import annotations

import numpy as np

from core.model import Camera, LightPlane, Pose
from core.model.arrays import Array
from workbench.views.scene.camera import Orientation
from workbench.views.scene.colours import Rgb, nice_step
from workbench.views.scene.contents import Labels, Lines

GREY: Rgb = (128, 134, 142)
"""Red, green and blue of the grid: seen on light and dark ground."""
PYRAMID: Rgb = (74, 134, 220)
"""Of the grid and of the camera: seen on the light and on the dark ground."""


def frustum(camera: Camera, depth_mm: float) -> Array:
    """Compute the camera's centre and its picture's four corners at `depth_mm`: (5, 3) in mm, clockwise."""
    width, height = camera.image_size
    corners = np.array([[0, 0], [width - 1, 0], [width - 1, height - 1], [0, height - 1]], dtype=np.float64)
    # Without distortion: a pyramid has straight edges, and the corners may lie where the distortion cannot be undone.
    rays = np.linalg.solve(camera.matrix, np.column_stack([corners, np.ones(4)]).T).T
    pyramid: Array = np.vstack([np.zeros(3), rays * depth_mm])
    return pyramid


def plane_patch(plane: LightPlane, camera: Camera, depths_mm: tuple[float, float]) -> Array:
    """Compute the corners (4, 3) in mm of the part of a light plane that the picture shows between two depths.

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
    """Compute the closed rectangle (5, 3) in mm around a target's points (N, 3), placed by `pose`."""
    (left, top), (right, bottom) = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom], [left, top]])
    outline: Array = np.column_stack([corners, np.zeros(5)]) @ pose.rotation.T + pose.translation
    return outline


def ground_grid(points: Array, orientation: Orientation) -> tuple[Lines, float]:
    """Make the lines of a grid under `points` (N, 3) in mm, and return their spacing in mm as well.

    They stand at whole multiples of that spacing from the orientation's origin.
    """
    axes = orientation.axes
    local = (points - orientation.origin) @ axes.T
    low, high = local.min(axis=0), local.max(axis=0)
    step = nice_step(max(float((high - low)[:2].max()), 1e-6) / 12)
    floor = low[2] - 0.02 * max(float((high - low).max()), step)
    first, last = np.floor(low[:2] / step), np.ceil(high[:2] / step)
    lines = []
    for axis in (0, 1):
        for k in np.arange(first[axis], last[axis] + 1):
            ends = np.empty((2, 3))
            ends[:, axis] = k * step
            ends[:, 1 - axis] = first[1 - axis] * step, last[1 - axis] * step
            ends[:, 2] = floor
            lines.append(ends @ axes + orientation.origin)
    return Lines(tuple(lines), (GREY,) * len(lines), 1.0), step


def camera_pyramid(corners: Array, name: str) -> tuple[Lines, Labels]:
    """Make the edges of the camera's pyramid from its centre and corners (5, 3), and a label with its name."""
    edges = [np.array([corners[0], corner]) for corner in corners[1:]]
    lines = Lines((*edges, corners[[1, 2, 3, 4, 1]]), (PYRAMID,) * 5, 1.6)
    return lines, Labels(corners[:1], (name,), None)
