"""Pictures of calibration plates, lit by the room and with the fan on them."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from core.model import Pose
from core.model.arrays import Array
from core.simulate.blur import blurred
from core.simulate.effects.lens import IDEAL_LENS, LensEffects
from core.simulate.poses import GOLDEN_SHARE
from core.simulate.rays import Map
from core.simulate.rig import Rig
from core.simulate.scene.image import Picture, Sensor, generator
from core.simulate.scene.laser import fan_sheets, laser_light
from core.simulate.scene.patterns import Pattern, draw_pattern
from core.simulate.scene.scene import Scene, SurfaceMaps
from core.simulate.scene.speckle import LEAST_LIGHT, Speckle
from core.simulate.scene.wrong_plates import points_on_bowed, rays_to_bowed

DIFFUSE_SHARE, FRONT_SHARE = 0.35, 0.65
"""Of the room's light on a plate: from all sides, and with the cosine of its tilt."""
NEAREST_MM, FARTHEST_MM = 430.0, 620.0
"""Depths of the plane target: those of the objects, and some more on both sides."""


def room_light(pattern: Pattern, pose: Pose, rays: Map, grey: float) -> tuple[Map, Map]:
    """Compute a plate's points (h, w, 3) in mm and the room's light (h, w) on it; head-on, white has `grey`."""
    points, albedo = draw_pattern(pattern, pose, rays)
    return points, albedo * room_shade(pose, grey)


def room_shade(pose: Pose, grey: float) -> np.float32:
    """Compute the grey level of white on a plate at `pose` in the room's light; `grey` if it faces the camera."""
    return np.float32(grey * (DIFFUSE_SHARE + FRONT_SHARE * abs(pose.rotation[2, 2])))


class RenderContext(NamedTuple):
    """Rig, rays of its camera's pixels (h, w, 2), sensor and lens effects for rendering."""

    rig: Rig
    rays: Map
    sensor: Sensor
    lens: LensEffects = IDEAL_LENS

    def image(self, light: Map, points: Map) -> Map:
        """Image the light (h, w) of surface `points` (h, w, 3) in mm through the lens, with its blur."""
        rig = self.rig
        return self.lens.image(light, rig.blur_px, rig.camera, points[..., 2], rig.scale)


def camera_picture(
    context: RenderContext, pattern: Pattern, pose: Pose, grey: float, rng: np.random.Generator, bow_mm: float = 0.0
) -> Picture:
    """Render one view of a target with the lasers off; white that faces the camera has grey level `grey`.

    The target's left and right edges are bent by `bow_mm` out of its plane.
    """
    rays = rays_to_bowed(pattern, pose, context.rays, bow_mm)
    points, light = room_light(pattern, pose, rays, grey)
    light = context.image(light, points)
    return context.sensor.expose(light, rng, light)


def plane_pictures(
    context: RenderContext, plate: tuple[Pattern, float], pose: Pose, grey: float, seed: int, index: int
) -> dict[str, Picture]:
    """Render the pictures of the plane target at pose number `index`, fan on and off, by the ending of their names.

    With the fan on it is "", else "_off".

    The `plate` is its pattern, and by how many mm its left and right edges are bent out of its plane. A sensor that
    takes further pictures adds those, "@2" and "_off@2" and the like.
    """
    (pattern, bow_mm), (rig, straight, sensor) = plate, context[:3]
    rays = rays_to_bowed(pattern, pose, straight, bow_mm)
    points, light = room_light(pattern, pose, rays, grey)
    points = points_on_bowed(pattern, pose, straight, points, bow_mm)
    light = context.image(light, points)
    albedo = draw_pattern(replace(pattern, background=0.0), pose, rays)[1]
    fan = context.image(bare_fan_light(rig, points, albedo, pose), points)
    fan = speckled(fan, rig, generator(seed, "plane speckle", index))
    pictures = {
        "": sensor.expose(light + fan, generator(seed, "plane on", index), light),
        "_off": sensor.expose(light, generator(seed, "plane off", index), light),
    }
    for number, other in sensor.further.items():
        pictures[f"@{number}"] = other.expose(light + fan, generator(seed, f"plane on@{number}", index), light)
        pictures[f"_off@{number}"] = other.expose(light, generator(seed, f"plane off@{number}", index), light)
    return pictures


def fan_light(rig: Rig, points: Map, albedo: Map, pose: Pose) -> Map:
    """Compute the fan's light (h, w) on a plate through the lens, before speckle."""
    return blurred(bare_fan_light(rig, points, albedo, pose), rig.blur_px)


def bare_fan_light(rig: Rig, points: Map, albedo: Map, pose: Pose) -> Map:
    """Compute the fan's light (h, w) on a plate before lens and speckle."""
    normals = np.broadcast_to((-pose.rotation[:, 2]).astype(np.float32), points.shape)
    maps = SurfaceMaps(points, normals, albedo)
    fan = np.zeros(albedo.shape, np.float32)
    for sheet in fan_sheets(rig, pose.translation):
        laser_light(sheet, Scene(None), maps, fan)
    return fan


def speckled(light: Map, rig: Rig, rng: np.random.Generator) -> Map:
    """Multiply laser light (h, w) by a new speckle pattern that `rng` chooses."""
    if rig.optics.speckle_contrast <= 0:
        return light
    speckle = Speckle(rig.optics.speckle_contrast, rig.grain_px, rng)
    rows, columns = np.nonzero(light > LEAST_LIGHT)
    light[rows, columns] *= speckle.at(rows, columns, rng)
    return light


def fan_centres(rig: Rig, poses: int, nearest_mm: float = NEAREST_MM, farthest_mm: float = FARTHEST_MM) -> list[Array]:
    """Choose `poses` points (3,) in mm on the middle line of the fan, their depths spread and in mixed order."""
    depths = nearest_mm + (farthest_mm - nearest_mm) * ((np.arange(poses) * GOLDEN_SHARE + 0.3) % 1)
    middle = rig.fan.planes[rig.fan.lines // 2].pi
    return [np.array([0.0, (1 - middle[2] * z) / middle[1], z]) for z in depths]
