"""The ray of every pixel of a camera, computed once per camera."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.model import Camera

Map = NDArray[np.float32]
"""A picture-sized array, (height, width) or (height, width, channels)."""


def ray_map(camera: Camera) -> Map:
    """Compute undistorted ray coordinates x/z, y/z (height, width, 2) of all pixel centres, to float32 (1.5e-4 px).

    The same Newton iteration as :meth:`core.model.Camera.undistort`, compiled, each pixel started from its left
    neighbour's solution.
    """
    width, height = camera.image_size
    a, b = camera.matrix[0, 0], camera.matrix[1, 1]
    offset = (camera.matrix[0, 1], camera.matrix[0, 2], camera.matrix[1, 2])
    rays: Map = _ray_map(width, height, a, b, offset, camera.distortion)
    return rays


@compiled()
def _ray_map(width, height, alpha, beta, offset, distortion):  # type: ignore[no-untyped-def]
    skew, u0, v0 = offset
    k1, k2, p1, p2, k3 = distortion
    rays = np.empty((height, width, 2), np.float32)
    for v in range(height):
        yd = (v - v0) / beta
        x = y = 0.0
        for u in range(width):
            xd = (u - u0 - skew * yd) / alpha
            if u == 0:
                x, y = xd, yd
            for _ in range(20):
                r2 = x * x + y * y
                radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
                slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3))
                ex = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) - xd
                ey = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y - yd
                a = radial + slope * x * x + 2 * p1 * y + 6 * p2 * x
                b = slope * x * y + 2 * p1 * x + 2 * p2 * y
                d = radial + slope * y * y + 6 * p1 * y + 2 * p2 * x
                determinant = a * d - b * b
                dx = (d * ex - b * ey) / determinant
                dy = (a * ey - b * ex) / determinant
                x -= dx
                y -= dy
                if abs(dx) + abs(dy) < 1e-11:
                    break
            rays[v, u, 0] = x
            rays[v, u, 1] = y
    return rays
