"""The pictures of a scan: a still object under the fan, and one sweep a frame."""

from __future__ import annotations

import cv2
import numpy as np

from core.model.arrays import Array
from core.simulate.image import Picture, Sensor, blurred, generator
from core.simulate.laser import Sheet, fan_sheets, laser_light
from core.simulate.rays import Map
from core.simulate.rig import Rig
from core.simulate.scene import Scene, SurfaceMaps, surface_maps
from core.simulate.speckle import Speckle

LAMP = np.array([-0.35, -0.5, -0.79])
"""Direction (3,) from the scene to the lamp that gives the room's light its shade, in the camera frame."""


class ScanStage:
    """A still scene before a rig, everything that does not change from frame to frame computed once.

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

    def frame(self, index: int, sheet: Sheet) -> Picture:
        """Frame number `index`, the hand-held laser at `sheet`."""
        rng = generator(self.seed, "frame", index)
        return self.sensor.expose(self.lit_by(sheet, rng), rng)

    @property
    def room_light(self) -> Map:
        """The room's light (h, w) alone, in grey levels: all lasers off."""
        return self._room_light

    @property
    def still(self) -> Map:
        """Light (h, w) in grey levels that is the same in every frame: the room's and the fan's."""
        return self._still

    def lit_by(self, sheet: Sheet, rng: np.random.Generator, *, fan: bool = True) -> Map:
        """Light (h, w) in grey levels with the hand-held laser at `sheet`; `rng` chooses its speckle."""
        light = blurred(laser_light(sheet, self.scene, self.maps), self.rig.blur_px)
        light = self._sparkling(light, rng)
        light += self._still if fan else self._room_light
        return light

    def fan_light(self, aim: Array) -> Map:
        """Light of the fan's sheets (h, w) before lens and speckle, in grey levels."""
        light = np.zeros(self.maps.albedo.shape, np.float32)
        for sheet in fan_sheets(self.rig, aim):
            laser_light(sheet, self.scene, self.maps, light)
        return light

    def _fan(self, aim: Array) -> Map:
        return self._sparkling(blurred(self.fan_light(aim), self.rig.blur_px), generator(self.seed, "fan"))

    def _room(self, grey: float) -> Map:
        facing = np.maximum(self.maps.normals @ (LAMP / np.linalg.norm(LAMP)).astype(np.float32), 0)
        return blurred(self.maps.albedo * (np.float32(grey) * (0.4 + 0.6 * facing)), self.rig.blur_px)

    def _sparkling(self, light: Map, rng: np.random.Generator) -> Map:
        if self._speckle is None:
            return light
        rows, columns = np.nonzero(light > 0.02)
        light[rows, columns] *= self._speckle.at(rows, columns, rng)
        return light


def _textured(maps: SurfaceMaps, texture: float, scale: float, seed: int) -> SurfaceMaps:
    """The maps with blotchy albedo: smooth patches of about 30 pixels at full resolution."""
    if texture <= 0:
        return maps
    height, width = maps.albedo.shape
    step = max(4, round(30 * scale))
    rng = generator(seed, "texture")
    coarse = rng.standard_normal((height // step + 2, width // step + 2), dtype=np.float32)
    patches = cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC)
    albedo = maps.albedo * np.clip(1 + np.float32(texture) * patches, 0.2, 1.6)
    return SurfaceMaps(maps.points, maps.normals, albedo, maps.table)
