"""How wide a sheet of light is seen where it meets a surface: the footprint of a mm across it, in px.

A sheet that meets a surface obliquely is wider there, by 1/cos of the angle it makes with the surface's normal, as the
camera sees it. Sheets and surface are known once a scan is solved.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.model import Camera
from core.model.arrays import Array
from core.model.residuals import over_picture
from core.scan.network.datum import MAIN_PLANE_MM, main_plane
from core.scan.network.geometry import inverse_depth_gradient
from core.scan.surface.cloud import Cloud

GRID = (16, 12)
"""Columns and rows of the parts of a picture whose surface is taken for one plane."""
FEWEST_POINTS, MOST_POINTS = 12, 300
"""Points in a part by which its surface is known, at least; more than the second say no more of it."""
LEAST_ACROSS = 0.08
"""Of a part's width that these spread across their stripe at least (standard deviation), or they tell no surface."""


def surfaces_of(cloud: Cloud, camera: Camera) -> Array:
    """Find for each of the G cells of a GRID over the picture the plane π (G, 3) that most of its points lie on.

    NaN where none is known.
    """
    planes = np.full((GRID[0] * GRID[1], 3), np.nan)
    part = over_picture(cloud.uv, camera.image_size, GRID)
    for one in np.unique(part):
        mine = np.flatnonzero(part == one)
        mine = mine[:: max(1, len(mine) // MOST_POINTS)]
        if len(mine) < FEWEST_POINTS:
            continue
        rays = camera.rays(cloud.uv[mine])
        plane, on_it = _face(rays, 1 / cloud.points[mine, 2])
        across = np.linalg.svd(rays[on_it] - rays[on_it].mean(axis=0), compute_uv=False)[1] / np.sqrt(on_it.sum())
        if across * camera.focal * GRID[0] > LEAST_ACROSS * camera.image_size[0]:
            planes[one] = plane
    return planes


def _face(rays: Array, inverse_depths: Array) -> tuple[Array, NDArray[np.bool_]]:
    """As `main_plane`; where all points lie on one plane no trials are needed."""
    plane = np.asarray(np.linalg.lstsq(rays, inverse_depths, rcond=None)[0], dtype=np.float64)
    near = np.abs(rays @ plane - inverse_depths) < MAIN_PLANE_MM * inverse_depths**2
    return (plane, near) if near.all() else main_plane(rays, inverse_depths)


def px_per_mm(uv: Array, sheet: Array, surfaces: Array, camera: Camera) -> Array:
    """Compute by how many px (N,) a stripe at `uv` (N, 2) moves when its sheet of light moves 1 mm along its normal.

    `surfaces` are those of the parts of the picture. NaN where no surface is known, or the light lies on another one.
    """
    return footprint(uv, sheet, surfaces[over_picture(uv, camera.image_size, GRID)], camera)


def footprint(uv: Array, sheet: Array, surface: Array, camera: Camera) -> Array:
    """Compute by how many px (N,) a stripe at `uv` (N, 2) on the plane `surface` moves when its sheet moves 1 mm.

    `surface` (N, 3) or (3,) is in inverse-depth form; NaN where the light does not lie on it.

    With ρ the surface's plane, n·X − d = d·(π·r/ρ·r − 1) on the surface; its gradient over the picture is
    z·(π − ρ)·∂r/|π| where the two meet.
    """
    rays, surface = camera.rays(uv), np.broadcast_to(surface, (len(uv), 3))
    inverse_depth = rays @ sheet
    gradient = inverse_depth_gradient(sheet - surface, camera.ray_jacobian(rays))
    on_it = np.abs(np.einsum("ni,ni->n", rays, surface) - inverse_depth) < MAIN_PLANE_MM * inverse_depth**2
    moved = np.linalg.norm(gradient, axis=1) / np.where(on_it, inverse_depth, np.nan)
    return np.asarray(np.linalg.norm(sheet) / moved)
