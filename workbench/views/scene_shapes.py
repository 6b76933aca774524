"""Shapes for drawing a rig in 3D: the camera's pyramid and patches of light planes. Corners only, no results."""

from __future__ import annotations

import numpy as np

from core.model import Camera, LightPlane
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
    """The part of a light plane that the camera sees between two depths: corners (4, 3) in mm.

    The plane meets each depth in a straight line; it is cut at the sides of the pyramid the line crosses.
    A plane that the camera does not see between these depths gives NaN.
    """
    near, far = (_chord(plane, frustum(camera, depth)[1:], depth) for depth in depths_mm)
    patch: Array = np.array([near[0], near[1], far[1], far[0]])
    return patch


def _chord(plane: LightPlane, corners: Array, depth: float) -> Array:
    """Ends (2, 3) of the line in which the plane meets the rectangle `corners` (4, 3) at one depth."""
    signed = plane.distances(corners)
    ends = []
    for i in range(4):
        a, b = signed[i], signed[(i + 1) % 4]
        if (a < 0) != (b < 0):
            ends.append(corners[i] + (corners[(i + 1) % 4] - corners[i]) * (a / (a - b)))
    if len(ends) != 2:
        return np.full((2, 3), np.nan)
    return np.array(sorted(ends, key=lambda end: (end[1], end[0])))
