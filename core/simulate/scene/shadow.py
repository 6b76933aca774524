"""Shadows of a sheet of light: one exact shadow ray for each lit point.

A sheet is thin, so only triangles that come near its plane can shade a point in it. They are sorted into sectors by
their polar angle about the emitter, and each shadow ray is tried against the triangles of its own sector only.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.model import LightPlane
from core.model.arrays import Array
from core.simulate.scene.scene import Scene

SECTORS = 4096
"""Sectors all round the emitter: 0.09° each, so that one holds few triangles."""
CLEARANCE_MM = 0.02
"""Mm before a point at which a shadow ray ends: a surface does not shade itself by the rounding of its own points."""


class ShadowCaster(NamedTuple):
    """Occluders that can shade points near one sheet: triangles by sector (compressed rows), and spheres.

    `frame` holds two unit vectors (2, 3) in the sheet; polar angles are counted from the first, all round.
    """

    emitter: Array
    frame: Array
    triangles: Array
    sector_start: NDArray[np.int64]
    sector_triangles: NDArray[np.int64]
    centres: Array
    radii: Array

    @classmethod
    def near_plane(cls, scene: Scene, plane: LightPlane, emitter: Array, axis: Array, reach: float) -> ShadowCaster:
        """Collect what can shadow a light `plane`: triangles within `reach` mm of it, and all spheres."""
        triangles = scene.occluders
        off = triangles @ plane.normal - plane.d_mm
        triangles = triangles[(off.min(axis=1) <= reach) & (off.max(axis=1) >= -reach)]
        frame = np.array([axis, np.cross(plane.normal, axis)])
        start, members = _sectors(triangles, emitter, frame)
        centres = np.array([sphere.centre for sphere in scene.spheres]).reshape(-1, 3)
        radii = np.array([sphere.radius for sphere in scene.spheres], dtype=np.float64)
        return cls(np.array(emitter), frame, triangles, start, members, centres, radii)

    def visible(self, points: Array) -> NDArray[np.bool_]:
        """Flag the `points` (N, 3) in mm that the emitter sees past all triangles: (N,), True if seen."""
        visible: NDArray[np.bool_] = _sees(points, self)
        return visible


def _sectors(triangles: Array, emitter: Array, frame: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles of each sector as compressed rows: `start` (SECTORS + 1,) and the triangles' numbers."""
    angles = _sector_angle((triangles - emitter) @ frame.T)
    low, high = angles.min(axis=1, initial=np.inf), angles.max(axis=1, initial=-np.inf)
    wraps = high - low > SECTORS / 2  # behind the emitter: rare, and then tried everywhere
    margin = 0.01  # of a sector, for rounding
    first = np.where(wraps, 0, np.floor(low - margin)).astype(np.int64).clip(0, SECTORS - 1)
    last = np.where(wraps, SECTORS - 1, np.floor(high + margin)).astype(np.int64).clip(0, SECTORS - 1)
    counts = last - first + 1
    members = np.repeat(np.arange(len(triangles)), counts)
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    sector = np.repeat(first, counts) + within
    order = np.argsort(sector, kind="stable")
    start = np.searchsorted(sector[order], np.arange(SECTORS + 1))
    return start.astype(np.int64), members[order].astype(np.int64)


def _sector_angle(plane_coordinates: Array) -> Array:
    angle: Array = np.arctan2(plane_coordinates[..., 1], plane_coordinates[..., 0])
    return (angle + np.pi) * (SECTORS / (2 * np.pi))


@compiled()
def _sees(points, caster):  # type: ignore[no-untyped-def]
    emitter, frame, triangles, start, members, centres, radii = caster
    visible = np.ones(len(points), np.bool_)
    for i in range(len(points)):
        ray = points[i] - emitter
        length = np.sqrt(np.dot(ray, ray))
        limit = 1.0 - CLEARANCE_MM / length
        angle = np.arctan2(np.dot(ray, frame[1]), np.dot(ray, frame[0]))
        sector = min(int((angle + np.pi) * (SECTORS / (2 * np.pi))), SECTORS - 1)
        for j in range(start[sector], start[sector + 1]):
            if _hits_triangle(triangles[members[j]], emitter, ray, limit):
                visible[i] = False
                break
        for j in range(len(radii)):
            if visible[i] and _hits_sphere(centres[j] - emitter, radii[j], ray, limit):
                visible[i] = False
    return visible


@inlined()
def _hits_triangle(triangle, origin, ray, limit):  # type: ignore[no-untyped-def]
    """Whether origin + t ray, 0 < t < limit, meets the triangle (Möller–Trumbore)."""
    ax, ay, az = triangle[0]
    e1x, e1y, e1z = triangle[1, 0] - ax, triangle[1, 1] - ay, triangle[1, 2] - az
    e2x, e2y, e2z = triangle[2, 0] - ax, triangle[2, 1] - ay, triangle[2, 2] - az
    px, py, pz = ray[1] * e2z - ray[2] * e2y, ray[2] * e2x - ray[0] * e2z, ray[0] * e2y - ray[1] * e2x
    determinant = e1x * px + e1y * py + e1z * pz
    if abs(determinant) < 1e-12:
        return False
    sx, sy, sz = origin[0] - ax, origin[1] - ay, origin[2] - az
    a = (sx * px + sy * py + sz * pz) / determinant
    if a < 0.0 or a > 1.0:
        return False
    qx, qy, qz = sy * e1z - sz * e1y, sz * e1x - sx * e1z, sx * e1y - sy * e1x
    b = (ray[0] * qx + ray[1] * qy + ray[2] * qz) / determinant
    if b < 0.0 or a + b > 1.0:
        return False
    t = (e2x * qx + e2y * qy + e2z * qz) / determinant
    return 0.0 < t < limit


@inlined()
def _hits_sphere(to_centre, radius, ray, limit):  # type: ignore[no-untyped-def]
    """Whether the ray enters the sphere at 0 < t < limit."""
    a = np.dot(ray, ray)
    b = np.dot(ray, to_centre)
    root = b * b - a * (np.dot(to_centre, to_centre) - radius * radius)
    if root <= 0.0:
        return False
    t = (b - np.sqrt(root)) / a
    return 0.0 < t < limit
