"""Second bounces: a sheet of light that flat sides of an object mirror, and what it lights then.

Behind a plane mirror stands the laser's image: a sheet from the mirrored emitter, in the mirrored plane. It lights what
is in front of the mirror and whose rays have come through the mirror's face. Each plane face of the meshes is one
mirror; light is bounced once, and bounced light is not shadowed by anything else.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from core.model import LightPlane
from core.model.arrays import Array
from core.simulate.rays import Map
from core.simulate.scene.laser import Sheet, laser_light
from core.simulate.scene.scene import Scene, SurfaceMaps

LEAST_AREA_MM2 = 50.0
"""Of a face that counts as a mirror."""
_ROUND_NORMAL, _ROUND_MM = 4, 2
"""Digits to which normals and distances of triangles agree that are one face."""
_BEFORE_MM = 0.05
"""A point counts as before a mirror from here on: the mirror itself is not lit by its own image."""


@dataclass(frozen=True, eq=False, slots=True)
class Mirror:
    """Plane mirroring face.

    Outward unit `normal` (3,), its distance from the origin in mm, and `triangles` (T, 3, 3).
    """

    normal: Array
    distance: float
    triangles: Array

    def image(self, sheet: Sheet) -> Sheet | None:
        """Reflect a laser sheet in the mirror's plane; None if its emitter is behind the mirror."""
        off = float(self.normal @ sheet.emitter) - self.distance
        if off <= 0:
            return None
        emitter = sheet.emitter - 2 * off * self.normal
        normal = sheet.plane.normal - 2 * (sheet.plane.normal @ self.normal) * self.normal
        axis = sheet.axis - 2 * (sheet.axis @ self.normal) * self.normal
        beam = replace(sheet.beam, bow=0.0)
        return Sheet(LightPlane(normal / (normal @ emitter)), emitter, axis, beam)

    def passes(self, emitter: Array, points: Array) -> NDArray[np.bool_]:
        """Flag the points (N, 3) that the mirrored `emitter` (3,) lights through the mirror's face, (N,)."""
        before = points @ self.normal - self.distance
        share = -(emitter @ self.normal - self.distance) / (before - (emitter @ self.normal - self.distance))
        through = emitter + share[:, None] * (points - emitter)
        inside = np.zeros(len(points), np.bool_)
        for triangle in self.triangles:
            edges = np.roll(triangle, -1, axis=0) - triangle
            sides = [
                np.cross(edge, through - corner) @ self.normal for edge, corner in zip(edges, triangle, strict=True)
            ]
            inside |= np.all(np.array(sides) >= 0, axis=0)
        return np.asarray(inside & (before > _BEFORE_MM))


def mirrors_of(scene: Scene) -> tuple[Mirror, ...]:
    """Find the plane faces of a scene's meshes that are large enough to be mirrors."""
    found: list[Mirror] = []
    for mesh in scene.meshes:
        triangles = mesh.triangles
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        areas = np.linalg.norm(normals, axis=1) / 2
        whole = areas > 0
        triangles, areas, normals = triangles[whole], areas[whole], normals[whole] / (2 * areas[whole, None])
        distances = np.einsum("ni,ni->n", normals, triangles[:, 0])
        keys = np.column_stack([normals.round(_ROUND_NORMAL) + 0.0, distances.round(_ROUND_MM) + 0.0])
        _, face = np.unique(keys, axis=0, return_inverse=True)
        for number in range(int(face.max(initial=-1)) + 1):
            mine = face.ravel() == number
            if areas[mine].sum() >= LEAST_AREA_MM2:
                found.append(Mirror(normals[mine][0], float(distances[mine][0]), triangles[mine]))
    return tuple(found)


def mirrored_light(sheet: Sheet, scene: Scene, maps: SurfaceMaps, share: float, out: Map) -> None:
    """Add to `out` (h, w) the light of `sheet` that faces of the scene's objects mirror, `share` of what meets them."""
    bounced = np.zeros_like(out)
    for mirror in mirrors_of(scene):
        image = mirror.image(sheet)
        if image is not None:
            laser_light(image, scene, maps, bounced, partial(mirror.passes, image.emitter))
    out += np.float32(share) * bounced
