"""A shaded axonometric picture of the surface, without OpenGL: every triangle into a depth buffer.

Parallel projection, so lengths along one direction are to scale everywhere. Light: a diffuse lamp above the left
shoulder of the viewer over an even ambient, and edges darkened where the depth buffer jumps, which tells a step
from a change of colour.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.inspect.shown.seen_from import SeenFrom
from core.inspect.shown.view_frame import Ground
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh

AZIMUTH, ELEVATION = np.radians(-32.0), np.radians(42.0)
"""From where the viewer looks, about the up direction and above the ground."""

LAMP = np.array([-0.45, 0.75, 0.65]) / np.linalg.norm([-0.45, 0.75, 0.65])
"""Direction to the lamp in the viewer's frame (right, up, towards the viewer)."""


def viewer_axes() -> Array:
    """Return the default view's axes in the ground frame, as rows (3, 3): right, up, and towards the viewer."""
    sin_a, cos_a, sin_e, cos_e = np.sin(AZIMUTH), np.cos(AZIMUTH), np.sin(ELEVATION), np.cos(ELEVATION)
    towards = np.array([sin_a * cos_e, -cos_a * cos_e, sin_e])
    right = np.array([cos_a, sin_a, 0.0])
    return np.array([right, np.cross(towards, right), towards])


@dataclass(frozen=True, eq=False, slots=True)
class Viewpoint:
    """Direction and part of the viewer's plane that a picture shows.

    `axes` are the viewer's right, up and towards-the-viewer as rows (3, 3) of the ground's frame; `extent` is left,
    right, bottom, top in mm of the viewer's plane, None for all there is.
    """

    axes: Array
    extent: tuple[float, float, float, float] | None = None


def usual_viewpoint() -> Viewpoint:
    """Make the default viewpoint: the whole surface from the front, the left and above."""
    return Viewpoint(viewer_axes())


def left_viewpoint(view: SeenFrom, ground: Ground, aspect: float) -> Viewpoint:
    """Convert the view that the user chose in 3D to a viewpoint that shows all of it in a picture of `aspect`."""
    axes = view.axes @ ground.axes.T
    x, y = (axes @ ground.local(view.focal[None])[0])[:2]
    half = view.half_height_mm * max(1.0, view.aspect / aspect)
    return Viewpoint(axes, (x - half * aspect, x + half * aspect, y - half, y + half))


@dataclass(frozen=True, eq=False, slots=True)
class SurfacePicture:
    """Picture of the surface from a viewpoint.

    `height` (H, W) in mm above the ground and `shade` (H, W) 0…1 are NaN where nothing is seen; `extent` is left,
    right, bottom, top in mm of the viewer's plane.
    """

    height: Array
    shade: Array
    extent: tuple[float, float, float, float]


def surface_picture(
    mesh: Mesh,
    cloud: Cloud,
    ground: Ground,
    width_px: int,
    aspect: float,
    progress: Progress = silent,
    viewpoint: Viewpoint | None = None,
) -> SurfacePicture:
    """Draw a shaded picture, `width_px` wide, of the mesh, or of the cloud's points if the mesh is empty.

    Parameters
    ----------
    width_px
        Width of the picture; its height is `width_px` / `aspect`.
    viewpoint
        From where it is seen; None: the usual one.

    Raises
    ------
    ValueError
        If there is neither a triangle nor a point.
    """
    solid = len(mesh.triangles) > 0
    vertices, normals = (mesh.vertices, mesh.normals) if solid else (cloud.points, cloud.normals)
    if not len(vertices):
        raise ValueError("neither a triangle nor a point to draw")
    local = ground.local(np.asarray(vertices))
    viewpoint = viewpoint or usual_viewpoint()
    seen = local @ viewpoint.axes.T
    drawn = np.full(len(seen), not solid)
    drawn[mesh.triangles] = True
    extent = viewpoint.extent or _extent(seen[drawn], aspect)
    scale = width_px / (extent[1] - extent[0])
    rows = round(width_px / aspect)
    column, row = (seen[:, 0] - extent[0]) * scale - 0.5, (extent[3] - seen[:, 1]) * scale - 0.5
    bright = _lambert(np.asarray(normals) @ ground.axes.T, viewpoint)
    corners = np.column_stack([column, row, seen[:, 2], local[:, 2], bright])
    layers = np.full((3, rows, width_px), np.nan)
    layers[0] = -np.inf
    progress("surface", 0, 2)
    if solid:
        _fill_triangles(corners, mesh.triangles, layers)
    else:
        # squares that just close the gaps of points spread evenly over half the picture
        reach = int(np.clip(0.35 * np.sqrt(rows * width_px / len(corners)), 1, 6))
        _splat_points(corners, reach, layers)
    progress("surface", 1, 2)
    layers[2] *= _edges(layers[0], scale)
    progress("surface", 2, 2)
    return SurfacePicture(layers[1], layers[2], extent)


def _extent(seen: Array, aspect: float) -> tuple[float, float, float, float]:
    """Limits around all that is seen, widened to the aspect, with a margin for the dimension lines."""
    low, high = np.quantile(seen[:, :2], 0.0005, axis=0), np.quantile(seen[:, :2], 0.9995, axis=0)
    centre, half = (low + high) / 2, np.maximum((high - low) / 2, 0.5) * 1.05
    half_width = max(half[0] * 1.1, half[1] * 1.14 * aspect)
    half_height = half_width / aspect
    middle = centre[1] - 0.06 * half[1]
    return (
        float(centre[0] - half_width),
        float(centre[0] + half_width),
        float(middle - half_height),
        float(middle + half_height),
    )


def _lambert(normals: Array, viewpoint: Viewpoint) -> Array:
    """Brightness 0…1 of vertices with these normals (ground's frame); even where the normal is unknown."""
    facing = normals @ viewpoint.axes.T
    bright: Array = 0.42 + 0.58 * np.clip(facing @ LAMP, 0.0, 1.0)
    return np.where(np.any(normals != 0, axis=1), bright, 0.85)


def _edges(depth: Array, scale: float) -> Array:
    """Darkening (1: none) just behind jumps of the depth buffer (mm; −inf where empty); `scale` in px/mm."""
    seen = np.isfinite(depth)
    if not seen.any():
        return np.ones_like(depth)
    filled = np.where(seen, depth, depth[seen].min()).astype(np.float32)
    shade = np.zeros_like(filled)
    for share in (0.003, 0.009):  # of the picture's height: a sharp rim and a soft shadow
        reach = max(1, round(share * len(depth)))
        around = cv2.blur(filled, (2 * reach + 1, 2 * reach + 1))
        shade += np.clip((around - filled) * scale / (6.0 * reach), 0.0, 1.0) / 2
    darkening = shade.astype(np.float64)
    darkening *= 0.5
    return np.subtract(1.0, darkening, out=darkening)


@compiled()
def _fill_triangles(corners: Array, triangles: NDArray[np.int64], layers: Array) -> None:
    """Each pixel keeps the nearest triangle's depth, height and shade, linear between its corners."""
    _, rows, columns = layers.shape
    for t in range(triangles.shape[0]):
        a, b, c = corners[triangles[t, 0]], corners[triangles[t, 1]], corners[triangles[t, 2]]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0.0 or not np.isfinite(area):
            continue
        left = max(int(np.ceil(min(a[0], b[0], c[0]))), 0)
        right = min(int(np.floor(max(a[0], b[0], c[0]))), columns - 1)
        top = max(int(np.ceil(min(a[1], b[1], c[1]))), 0)
        bottom = min(int(np.floor(max(a[1], b[1], c[1]))), rows - 1)
        for y in range(top, bottom + 1):
            for x in range(left, right + 1):
                wb = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
                wc = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
                wa = 1.0 - wb - wc
                # a hair of slack: no pixel on a shared edge stays empty
                if wa < -1e-9 or wb < -1e-9 or wc < -1e-9:
                    continue
                depth = wa * a[2] + wb * b[2] + wc * c[2]
                if depth > layers[0, y, x]:
                    layers[0, y, x] = depth
                    layers[1, y, x] = wa * a[3] + wb * b[3] + wc * c[3]
                    layers[2, y, x] = wa * a[4] + wb * b[4] + wc * c[4]


@compiled()
def _splat_points(corners: Array, reach: int, layers: Array) -> None:
    """Each point as a small square; the nearest wins."""
    _, rows, columns = layers.shape
    for p in range(corners.shape[0]):
        corner = corners[p]
        if not np.isfinite(corner[0] + corner[1] + corner[2]):
            continue
        column, row = int(np.round(corner[0])), int(np.round(corner[1]))
        for y in range(max(row - reach, 0), min(row + reach, rows - 1) + 1):
            for x in range(max(column - reach, 0), min(column + reach, columns - 1) + 1):
                if corner[2] > layers[0, y, x]:
                    layers[0, y, x] = corner[2]
                    layers[1, y, x] = corner[3]
                    layers[2, y, x] = corner[4]
