"""Rasteriser of triangles: a z-buffer with exact ray–triangle intersection at every pixel centre.

In undistorted ray coordinates (x, y) = (X/Z, Y/Z) a triangle stays a triangle and 1/Z is linear over it, so inside-test
and depth are exact whatever the lens distorts; distortion only matters for the box of pixels that is looked at.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.model import Camera
from core.model.arrays import Array
from core.simulate.rays import Map

NEAREST_MM = 1.0
"""Depth nearer than which nothing is drawn."""
MARGIN_PX, MARGIN_SHARE = 2.0, 0.02
"""Px, and share of a triangle's extent, around its box that are looked at: a distorted edge bends out of the box of its
ends."""


def draw_triangles(triangles: Array, camera: Camera, rays: Map, depth: Map, face: NDArray[np.int32]) -> None:
    """Render `triangles` (T, 3, 3) in mm, camera frame, into the maps `depth` and `face` (index), (height, width) each.

    Where a triangle is nearer than what `depth` holds, depth and the triangle's number are overwritten. Triangles that
    reach behind the camera are left out.
    """
    visible = np.flatnonzero((triangles[:, :, 2] > NEAREST_MM).all(axis=1))
    if not len(visible):
        return
    corners = camera.project(triangles[visible].reshape(-1, 3)).reshape(-1, 3, 2)
    low, high = corners.min(axis=1), corners.max(axis=1)
    margin = MARGIN_PX + MARGIN_SHARE * (high - low)
    size = np.array(camera.image_size)
    first = np.clip(np.floor(low - margin), 0, size).astype(np.int64)
    last = np.clip(np.ceil(high + margin) + 1, 0, size).astype(np.int64)
    _draw(triangles, visible, first, last, rays, depth, face)


@compiled()
def _draw(triangles, visible, first, last, rays, depth, face):  # type: ignore[no-untyped-def]
    for i in range(len(visible)):
        t = visible[i]
        z0, z1, z2 = triangles[t, 0, 2], triangles[t, 1, 2], triangles[t, 2, 2]
        x0, y0 = triangles[t, 0, 0] / z0, triangles[t, 0, 1] / z0
        x1, y1 = triangles[t, 1, 0] / z1, triangles[t, 1, 1] / z1
        x2, y2 = triangles[t, 2, 0] / z2, triangles[t, 2, 1] / z2
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if abs(area) < 1e-14:
            continue
        for v in range(first[i, 1], last[i, 1]):
            for u in range(first[i, 0], last[i, 0]):
                x, y = rays[v, u, 0], rays[v, u, 1]
                a = ((x1 - x) * (y2 - y) - (x2 - x) * (y1 - y)) / area
                b = ((x2 - x) * (y0 - y) - (x0 - x) * (y2 - y)) / area
                c = 1.0 - a - b
                if a < -1e-9 or b < -1e-9 or c < -1e-9:
                    continue
                z = 1.0 / (a / z0 + b / z1 + c / z2)
                if z < depth[v, u]:
                    depth[v, u] = z
                    face[v, u] = t
