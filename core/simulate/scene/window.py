"""The room's light through a window: soft shadows of objects, and of the hand that holds the laser.

The window is a disk of directions about the lamp's, all alike bright. A point is lit by the share of it that it sees.
Objects hide what their convex hulls do (a hollow part's own shadow is larger than it is); the hand is a ball, of which
the share that it hides of the window is that of two disks, taken to be as soft as the smaller one.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from core.compiled import compiled
from core.model.arrays import Array
from core.simulate.rays import Map
from core.simulate.scene.scene import Scene, SurfaceMaps

PLACES = 24
"""Directions that stand for the window."""
CLEARANCE_MM = 0.05
"""Before a point from where on something may hide the window from it."""


def window_places(towards: Array, half_angle: float) -> Array:
    """Spread unit vectors (PLACES, 3) evenly over a disk of `half_angle` in rad about the direction `towards` (3,)."""
    middle = towards / np.linalg.norm(towards)
    aside = np.cross(middle, [0.0, 0.0, 1.0] if abs(middle[2]) < 0.9 else [1.0, 0.0, 0.0])
    aside /= np.linalg.norm(aside)
    number = np.arange(PLACES) + 0.5
    radius, angle = np.tan(half_angle) * np.sqrt(number / PLACES), number * np.pi * (3 - np.sqrt(5))
    found = middle + radius[:, None] * (
        np.cos(angle)[:, None] * aside + np.sin(angle)[:, None] * np.cross(middle, aside)
    )
    return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])


def visible_window_share(scene: Scene, maps: SurfaceMaps, places: Array) -> Map:
    """Compute the share (h, w) of a window's `places` (P, 3) that each pixel's point sees past all objects."""
    hulls = [_hull(mesh.triangles) for mesh in scene.meshes]
    starts = np.cumsum([0, *map(len, hulls)]).astype(np.int64)
    planes = np.concatenate(hulls) if hulls else np.zeros((0, 4))
    balls = np.array([[*ball.centre, ball.radius] for ball in scene.spheres]).reshape(-1, 4)
    return np.asarray(_seen(maps.points, places, planes, starts, balls))


def hand_hides(maps: SurfaceMaps, towards: Array, half_angle: float, hand: tuple[Array, float]) -> Map:
    """Compute the share (h, w) of a window that a hand, a ball of centre (3,) and radius in mm, hides from each point.

    The window is a disk of `half_angle` in rad about the direction `towards`.
    """
    middle, radius = hand
    way = middle.astype(np.float32) - maps.points
    distance = np.linalg.norm(way, axis=2)
    own = np.arcsin(np.clip(radius / np.maximum(distance, radius), 0.0, 1.0))
    unit = (towards / np.linalg.norm(towards)).astype(np.float32)
    apart = np.arccos(np.clip(way @ unit / np.maximum(distance, 1e-6), -1.0, 1.0))
    softness = np.minimum(own, half_angle)
    whole = np.minimum((own / half_angle) ** 2, 1.0)
    rise = np.clip((own + half_angle - apart) / (2 * softness), 0.0, 1.0)
    return np.asarray(whole * rise**2 * (3 - 2 * rise), dtype=np.float32)


def _hull(triangles: Array) -> Array:
    """Planes (F, 4) of the convex hull of some triangles: outward unit normal and offset, n·X + d ≤ 0 inside."""
    return np.asarray(np.unique(ConvexHull(triangles.reshape(-1, 3)).equations.round(9), axis=0))


@compiled()
def _seen(points, places, planes, starts, balls):  # type: ignore[no-untyped-def]
    height, width = points.shape[:2]
    share = np.ones((height, width), np.float32)
    for v in range(height):
        for u in range(width):
            x, y, z = points[v, u, 0], points[v, u, 1], points[v, u, 2]
            hidden = 0
            for p in range(len(places)):
                dx, dy, dz = places[p, 0], places[p, 1], places[p, 2]
                meets = False
                for h in range(len(starts) - 1):
                    enters, leaves = CLEARANCE_MM, np.inf
                    for k in range(starts[h], starts[h + 1]):
                        slope = planes[k, 0] * dx + planes[k, 1] * dy + planes[k, 2] * dz
                        off = planes[k, 0] * x + planes[k, 1] * y + planes[k, 2] * z + planes[k, 3]
                        if abs(slope) < 1e-12:
                            if off > 0:
                                leaves = -1.0
                        elif slope < 0:
                            enters = max(enters, -off / slope)
                        else:
                            leaves = min(leaves, -off / slope)
                    meets = meets or leaves > enters + CLEARANCE_MM
                for b in range(len(balls)):
                    cx, cy, cz = balls[b, 0] - x, balls[b, 1] - y, balls[b, 2] - z
                    along = cx * dx + cy * dy + cz * dz
                    square = cx * cx + cy * cy + cz * cz - along * along
                    inside = balls[b, 3] * balls[b, 3] - square
                    meets = meets or (inside > 0 and along + np.sqrt(inside) > CLEARANCE_MM and along > CLEARANCE_MM)
                hidden += meets
            share[v, u] = 1.0 - hidden / len(places)
    return share
