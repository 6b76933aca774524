"""Pictures of a scan: a still object under the fan, and one sweep a frame."""

from __future__ import annotations

import cv2
import numpy as np

from core.model.arrays import Array
from core.simulate.rig import Rig
from core.simulate.scene.image import Picture, Sensor, blurred, generator
from core.simulate.scene.laser import Sheet, fan_sheets, laser_light
from core.simulate.scene.rays import Map
from core.simulate.scene.scene import Scene, SurfaceMaps, surface_maps
from core.simulate.scene.speckle import LEAST_LIGHT, Speckle

LAMP = np.array([-0.35, -0.5, -0.79])
"""Direction (3,) from the scene to the lamp that gives the room's light its shade, in the camera frame."""
DIFFUSE_SHARE, LAMP_SHARE = 0.4, 0.6
"""Of the room's light, from all sides and from the lamp."""

# Uneven albedo: smooth patches, never black and never more than a white sheet.
PATCH_PX = 30
"""Side in px at full resolution."""
LEAST_FACTOR, LARGEST_FACTOR = 0.2, 1.6
"""Of the surface's albedo."""


class ScanStage:
    """Renders a still scene before a rig; what does not change from frame to frame is computed once.

    Parameters
    ----------
    rig, scene
        Camera, lasers and what they look at.
    sensor
        Noise and bits.
    seed
        All chance comes from it; each picture has its own stream.
    ambient_grey
        8-bit grey level of a white surface facing the lamp.
    texture
        Relative standard deviation of the surfaces' albedo.
    aim
        Point (3,) in mm the fan's middle is turned to.
    """

    def __init__(
        self,
        rig: Rig,
        scene: Scene,
        sensor: Sensor,
        *,
        seed: int,
        ambient_grey: float = 45.0,
        texture: float = 0.0,
        aim: Array,
    ) -> None:
        self.rig, self.scene, self.sensor, self.seed = rig, scene, sensor, seed
        self.maps = _textured(surface_maps(scene, rig.camera), texture, rig.scale, seed)
        contrast = rig.optics.speckle_contrast
        self._speckle = Speckle(contrast, rig.grain_px, generator(seed, "speckle")) if contrast > 0 else None
        self._room_light = self._room(ambient_grey)
        self._still = self._room_light + self._fan(aim)

    def reference(self) -> Picture:
        """The picture with the hand-held laser off: room light and fan."""
        return self.sensor.expose(self._still, generator(self.seed, "reference"))

    def frame(self, index: int, *sheets: Sheet) -> Picture:
        """Frame number `index`, the hand-held laser at one sheet, or at several in the course of the exposure."""
        rng = generator(self.seed, "frame", index)
        return self.sensor.expose(self.lit_by(*sheets, rng=rng), rng)

    @property
    def room_light(self) -> Map:
        """The room's light (h, w) alone, in grey levels: all lasers off."""
        return self._room_light

    @property
    def still(self) -> Map:
        """Light (h, w) in grey levels that is the same in every frame: the room's and the fan's."""
        return self._still

    def lit_by(self, *sheets: Sheet, rng: np.random.Generator, fan: bool = True) -> Map:
        """Light (h, w) in grey levels, the mean with the hand-held laser at `sheets`; `rng` chooses its speckle."""
        light = laser_light(sheets[0], self.scene, self.maps)
        for sheet in sheets[1:]:
            laser_light(sheet, self.scene, self.maps, light)
        if len(sheets) > 1:
            light /= len(sheets)
        light = blurred(light, self.rig.blur_px)
        light = self._with_speckle(light, rng)
        light += self._still if fan else self._room_light
        return light

    def fan_light(self, aim: Array) -> Map:
        """Light of the fan's sheets (h, w) before lens and speckle, in grey levels."""
        light = np.zeros(self.maps.albedo.shape, np.float32)
        for sheet in fan_sheets(self.rig, aim):
            laser_light(sheet, self.scene, self.maps, light)
        return light

    def _fan(self, aim: Array) -> Map:
        return self._with_speckle(blurred(self.fan_light(aim), self.rig.blur_px), generator(self.seed, "fan"))

    def _room(self, grey: float) -> Map:
        facing = np.maximum(self.maps.normals @ (LAMP / np.linalg.norm(LAMP)).astype(np.float32), 0)
        return blurred(self.maps.albedo * (np.float32(grey) * (DIFFUSE_SHARE + LAMP_SHARE * facing)), self.rig.blur_px)

    def _with_speckle(self, light: Map, rng: np.random.Generator) -> Map:
        if self._speckle is None:
            return light
        rows, columns = np.nonzero(light > LEAST_LIGHT)
        light[rows, columns] *= self._speckle.at(rows, columns, rng)
        return light


def _textured(maps: SurfaceMaps, texture: float, scale: float, seed: int) -> SurfaceMaps:
    """The maps with blotchy albedo: smooth patches of about 30 pixels at full resolution."""
    if texture <= 0:
        return maps
    height, width = maps.albedo.shape
    step = max(4, round(PATCH_PX * scale))
    rng = generator(seed, "texture")
    coarse = rng.standard_normal((height // step + 2, width // step + 2), dtype=np.float32)
    patches = cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC)
    albedo = maps.albedo * np.clip(1 + np.float32(texture) * patches, LEAST_FACTOR, LARGEST_FACTOR)
    return SurfaceMaps(maps.points, maps.normals, albedo, maps.table)
