"""Pictures from light: shot noise, read noise, saturation, whole grey levels.

Light is counted in 8-bit grey levels throughout; 16-bit pictures are the same times 257.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.simulate.effects.sensor import IDEAL_SENSOR, SensorEffects
from core.simulate.rays import Map
from core.simulate.rig import Optics

Picture = NDArray[np.uint8] | NDArray[np.uint16]

NOISE_PLACES = 256
"""Rows down, and columns to the right, that a noise tile can be moved: 65,536 places, four ways round each."""


def generator(seed: int, kind: str, index: int = 0) -> np.random.Generator:
    """Make a random generator for one picture, from `seed`, `kind` and `index` alone: other pictures do not matter."""
    return np.random.default_rng([seed, zlib.crc32(kind.encode()), index])


class NoiseTile:
    """Tile of normal random numbers drawn once; each picture uses its own part, for pictures in real time.

    Parameters
    ----------
    shape
        (height, width) of the pictures.
    rng
        Fills the tile.
    """

    def __init__(self, shape: tuple[int, int], rng: np.random.Generator) -> None:
        self._tile = rng.standard_normal((shape[0] + NOISE_PLACES, shape[1] + NOISE_PLACES), dtype=np.float32)

    def at(self, shape: tuple[int, ...], rng: np.random.Generator) -> Map:
        """Cut the noise (height, width) of one picture from the tile, at a place and mirrored as `rng` chooses."""
        down, right = rng.integers(0, NOISE_PLACES, 2)
        flip, mirror = 1 - 2 * rng.integers(0, 2, 2)
        part: Map = self._tile[down : down + shape[0], right : right + shape[1]][::flip, ::mirror]
        return part


@dataclass(frozen=True, slots=True)
class Sensor:
    """Sensor that turns light into whole grey levels.

    Parameters
    ----------
    optics
        Electrons per grey level, read noise, black level.
    bits
        8 or 16.
    noise
        Factor on the standard deviation of shot and read noise; 0 for none.
    tile
        Where noise is taken from instead of being drawn anew for each picture, which is four times as quick.
    exposure, gain
        Factors on the light collected, and on the signal it makes.
    effects
        What else becomes of light and picture.
    seed
        Says which of the sensor's pixels are hot.
    """

    optics: Optics
    bits: int = 8
    noise: float = 1.0
    tile: NoiseTile | None = None
    exposure: float = 1.0
    gain: float = 1.0
    effects: SensorEffects = IDEAL_SENSOR
    seed: int = 0

    def expose(self, light: Map, rng: np.random.Generator, room: Map | None = None) -> Picture:
        """Make the picture that the sensor takes of `light` (height, width): noise, rounding and saturation added.

        Of that light, `room` (height, width) is white; the rest is the lasers'. The picture is (height, width, 3) where
        the sensor sees colours.
        """
        exposure = self.exposure
        if self.effects.automatic_exposure:
            exposure *= 1 + self.effects.automatic_exposure * rng.uniform(-1, 1)
        if exposure != 1:
            light = np.float32(exposure) * light
            room = None if room is None else np.float32(exposure) * room
        if self.effects != IDEAL_SENSOR:
            light = self.effects.collected(light, room, self.optics.black_level_grey)
            light = self.effects.with_hot_pixels(light, generator(self.seed, "hot pixels"))
        picture: Picture = np.empty(light.shape, np.uint16 if self.bits == 16 else np.uint8)
        figures = (
            self.gain,
            self.optics.electrons_per_grey / self.gain,
            (self.optics.read_noise_grey * self.gain) ** 2,
            self.noise,
            self.optics.black_level_grey,
            257 if self.bits == 16 else 1,
            2**self.bits - 1,
        )
        _expose(light, self._noise(light.shape, rng), np.array(figures, np.float32), picture)
        return self.effects.developed(picture)

    @property
    def further(self) -> dict[int, Sensor]:
        """Sensors with the second and third exposure of each picture, by their numbers; {} if there is one alone."""
        factors = {2: self.effects.second_exposure, 3: self.effects.third_exposure}
        return {n: replace(self, exposure=self.exposure / factor) for n, factor in factors.items() if factor}

    def _noise(self, shape: tuple[int, ...], rng: np.random.Generator) -> Map:
        if self.noise <= 0:
            return np.zeros(shape, np.float32)
        if self.tile is not None:
            return self.tile.at(shape, rng)
        return rng.standard_normal(shape, dtype=np.float32)


@compiled()
def _expose(light, noise, figures, picture):  # type: ignore[no-untyped-def]
    brightness, electrons, read_variance, strength, black, unit, white = figures
    for v in range(light.shape[0]):
        for u in range(light.shape[1]):
            signal = light[v, u] * brightness
            deviation = np.sqrt(signal / electrons + read_variance) * noise[v, u] * strength
            grey = np.rint((signal + black + deviation) * unit)
            picture[v, u] = min(max(grey, np.float32(0)), white)
