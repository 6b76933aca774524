"""Pictures of a scan: a still object under the fan, and one sweep a frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from core.calibrate.change import displaced_fan
from core.model.arrays import Array
from core.simulate.effects.lens import IDEAL_LENS, LensEffects
from core.simulate.effects.room import STEADY_ROOM, RoomEffects
from core.simulate.effects.transport import ONE_WAY, Transport
from core.simulate.effects.warming import NO_WARMING, Warming
from core.simulate.rays import Map
from core.simulate.rig import Rig
from core.simulate.scene.bounce import bounced_light
from core.simulate.scene.image import Picture, Sensor, generator
from core.simulate.scene.laser import Sheet, fan_sheets, laser_light
from core.simulate.scene.mirrors import mirrored_light
from core.simulate.scene.scene import Scene, SurfaceMaps, surface_maps
from core.simulate.scene.speckle import LEAST_LIGHT, Speckle
from core.simulate.scene.window import hand_hides, visible_window_share, window_places

LAMP = np.array([-0.35, -0.5, -0.79])
"""Direction (3,) from the scene to the lamp that gives the room's light its shade, in the camera frame."""
LOW_LAMP, LOW_LAMP_DEG = np.array([0.1, 0.8, -0.6]), 3.0
"""The same of a lamp low in front, and half of the angle that it has: it casts shadows of objects behind them."""
DIFFUSE_SHARE, LAMP_SHARE = 0.4, 0.6
"""Of the room's light, from all sides and from the lamp."""

# Uneven albedo: smooth patches, never black and never more than a white sheet.
PATCH_PX = 30
"""Side in px at full resolution."""
LEAST_FACTOR, LARGEST_FACTOR = 0.2, 1.6
"""Of the surface's albedo."""


@dataclass(frozen=True, slots=True)
class StageEffects:
    """Further effects in a scan.

    `mirror_share` of the lasers' light is mirrored by flat sides of the objects; `frames` is how many pictures are
    taken, over which the rig warms; `readout_s` the time from the first row of a picture to the last. `transport` says
    what light does beyond a single way.
    """

    lens: LensEffects = IDEAL_LENS
    room: RoomEffects = STEADY_ROOM
    warming: Warming = NO_WARMING
    mirror_share: float = 0.0
    frames: int = 1
    readout_s: float = 0.0
    transport: Transport = ONE_WAY
    low_lamp: bool = False
    """Whether the room's light comes low from the front."""

    def over(self, index: int) -> float:
        """Compute the share of the scan, 0 to 1, that has passed at frame `index`; 0 for the reference, index −1."""
        return (index + 1) / max(self.frames, 1)


STILL = StageEffects()


class ScanStage:
    """Renderer of a still scene before a rig; what does not change from frame to frame is computed once.

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
    effects
        What else happens.
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
        effects: StageEffects = STILL,
    ) -> None:
        self.rig, self.scene, self.sensor, self.seed = rig, scene, sensor, seed
        self.effects, self._aim = effects, aim
        self.maps = _textured(surface_maps(scene, rig.camera), texture, rig.scale, seed)
        contrast = rig.optics.speckle_contrast
        self._speckle = Speckle(contrast, rig.grain_px, generator(seed, "speckle")) if contrast > 0 else None
        self._lamp_light: Map | None = None
        self._room_light = self._room(ambient_grey)
        self._fan_light = self._fan(rig)
        self._still = self._room_light + self._fan_light

    def reference(self) -> Picture:
        """Render the reference picture: room light and fan, the hand-held laser off."""
        return self._taken(self._still, -1, generator(self.seed, "reference"), self.sensor)

    def boards(self, number: int, grey: float) -> Picture:
        """Render picture `number` of the boards as they lie, all lasers off; white that faces the lamp has `grey`."""
        light = self.lit_by_room(grey)
        return self.sensor.expose(light, generator(self.seed, "boards", number), light)

    def lit_by_room(self, grey: float) -> Map:
        """Compute the light (height, width) of the room alone; white that faces the lamp has the 8-bit `grey`."""
        return self._room(grey)

    def frame(self, index: int, *sheets: Sheet) -> Picture:
        """Render frame `index`, lit by one of the hand-held laser's `sheets`, or by several during its exposure."""
        rng = generator(self.seed, "frame", index)
        return self._taken(self.lit_by(*sheets, rng=rng), index, rng, self.sensor, self._hidden_by_hand(sheets))

    def further_references(self) -> dict[int, Picture]:
        """Render the reference in the sensor's second and third exposure, by their numbers; {} if it has one alone."""
        return {
            number: self._taken(self._still, -1, generator(self.seed, f"reference@{number}"), sensor)
            for number, sensor in self.sensor.further.items()
        }

    def further_frames(self, index: int, *sheets: Sheet) -> dict[int, Picture]:
        """Render frame `index` in the sensor's second and third exposure, by their numbers; {} if it has one alone."""
        if not self.sensor.further:
            return {}
        light = self.lit_by(*sheets, rng=generator(self.seed, "frame", index))
        hidden = self._hidden_by_hand(sheets)
        return {
            number: self._taken(light, index, generator(self.seed, f"frame@{number}", index), sensor, hidden)
            for number, sensor in self.sensor.further.items()
        }

    def _taken(
        self, light: Map, index: int, rng: np.random.Generator, sensor: Sensor, hidden: Map | None = None
    ) -> Picture:
        """The picture of frame `index` (−1: the reference) of the `light` (h, w) before anything has changed.

        Of the room's light, `hidden` (h, w) does not arrive.
        """
        effects, room, over = self.effects, self._room_light, self.effects.over(index)
        if hidden is not None:
            light, room = light - hidden, room - hidden
        if effects.warming.scan_urad and over:
            turn = np.array([over * effects.warming.scan_urad * 1e-6, 0.0, 0.0])
            turned = replace(self.rig, fan=displaced_fan(self.rig.fan, turn, self.rig.fan_emitter))
            light = light + (self._fan(turned) - self._fan_light)
        brightness = np.float32(self.sensor.effects.brightness)
        if brightness != 1:
            light = room + brightness * (light - room)
        added = effects.room.added(index, room.shape, effects.readout_s, generator(self.seed, "room", index + 1))
        if added is not None:
            light, room = light + added * room, (1 + added) * room
        light, room = (effects.warming.at(over, each, self.rig.camera) for each in (light, room))
        return sensor.expose(light, rng, room)

    @property
    def room_light(self) -> Map:
        """Light (h, w) of the room alone, in grey levels: all lasers off."""
        return self._room_light

    @property
    def still(self) -> Map:
        """Light (h, w) in grey levels that is in every frame: the room's and that of the fan fixed to the rig."""
        return self._still

    def lit_by(self, *sheets: Sheet, rng: np.random.Generator, fan: bool = True) -> Map:
        """Compute the light (h, w) in grey levels of the scene, the mean over the hand-held laser's `sheets`.

        `rng` chooses its speckle.
        """
        light = self._sheets_light(sheets)
        if len(sheets) > 1:
            light /= len(sheets)
        light = self._image(light)
        light = self._with_speckle(light, rng)
        light += self._still if fan else self._room_light
        return light

    def _fan(self, rig: Rig) -> Map:
        light = self._image(self._sheets_light(fan_sheets(rig, self._aim)))
        return self._with_speckle(light, generator(self.seed, "fan"))

    def _sheets_light(self, sheets: Sequence[Sheet]) -> Map:
        """Light of all sheets (h, w) before lens and speckle, in grey levels, with what is mirrored."""
        light = np.zeros(self.maps.albedo.shape, np.float32)
        for sheet in sheets:
            laser_light(sheet, self.scene, self.maps, light)
            if self.effects.mirror_share:
                mirrored_light(sheet, self.scene, self.maps, self.effects.mirror_share, light)
        if self.effects.transport.bounced:
            light += bounced_light(light, self.maps, self.rig.camera.focal)
        return light

    def _image(self, light: Map) -> Map:
        rig = self.rig
        return self.effects.lens.image(light, rig.blur_px, rig.camera, self.maps.depth, rig.scale)

    def _room(self, grey: float) -> Map:
        low, transport = self.effects.low_lamp, self.effects.transport
        lamp = LOW_LAMP if low else LAMP
        facing = np.maximum(self.maps.normals @ (lamp / np.linalg.norm(lamp)).astype(np.float32), 0)
        window = np.radians(transport.window_deg or (LOW_LAMP_DEG if low else 0.0))
        if window:
            facing *= visible_window_share(self.scene, self.maps, window_places(lamp, float(window)))
            self._lamp_light = self.maps.albedo * (np.float32(grey * LAMP_SHARE) * facing)
        return self._image(self.maps.albedo * (np.float32(grey) * (DIFFUSE_SHARE + LAMP_SHARE * facing)))

    def _hidden_by_hand(self, sheets: Sequence[Sheet]) -> Map | None:
        """The room's light (h, w) that the hand takes which holds the laser at `sheets`; None: nothing."""
        transport = self.effects.transport
        if self._lamp_light is None or not transport.hand_mm or not sheets:
            return None
        sheet = sheets[len(sheets) // 2]
        lamp = LOW_LAMP if self.effects.low_lamp else LAMP
        behind = sheet.emitter - transport.hand_mm * sheet.axis
        window = float(np.radians(transport.window_deg))
        return self._image(self._lamp_light * hand_hides(self.maps, lamp, window, (behind, transport.hand_mm)))

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
    return replace(maps, albedo=albedo)
