"""From light to a picture: lens blur, shot noise, read noise, saturation, whole grey levels.

Light is counted in 8-bit grey levels throughout; 16-bit pictures are the same times 257.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from core.simulate.rays import Map
from core.simulate.rig import Optics

Picture = NDArray[np.uint8] | NDArray[np.uint16]


def generator(seed: int, kind: str, index: int = 0) -> np.random.Generator:
    """The random numbers of one picture: the same in whatever order, and on however many threads, it is rendered."""
    return np.random.default_rng([seed, zlib.crc32(kind.encode()), index])


def blurred(light: Map, sigma_px: float) -> Map:
    """`light` as pixels see it through a lens of Gaussian blur `sigma_px`: each integrates over its own area."""
    reach = int(np.ceil(4.5 * sigma_px + 0.5))
    edges = np.arange(-reach, reach + 2) - 0.5
    kernel = np.diff(erf(edges / (sigma_px * np.sqrt(2)))) if sigma_px > 0 else np.ones(1)
    kernel = (kernel / kernel.sum()).astype(np.float32)
    smooth = cv2.sepFilter2D(light, cv2.CV_32F, kernel, kernel, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(smooth, dtype=np.float32)


@dataclass(frozen=True, slots=True)
class Sensor:
    """What turns light into whole grey levels.

    Parameters
    ----------
    optics
        Electrons per grey level, read noise, black level.
    bits
        8 or 16.
    noise
        Factor on the standard deviation of shot and read noise; 0 for none.
    """

    optics: Optics
    bits: int = 8
    noise: float = 1.0

    def expose(self, light: Map, rng: np.random.Generator) -> Picture:
        """A picture of `light` (height, width), saturated where it is too bright."""
        grey = light + np.float32(self.optics.black_level_grey)
        if self.noise > 0:
            variance = light / np.float32(self.optics.electrons_per_grey)
            variance += np.float32(self.optics.read_noise_grey**2)
            np.sqrt(variance, out=variance)
            variance *= rng.standard_normal(light.shape, dtype=np.float32)
            variance *= np.float32(self.noise)
            grey += variance
        if self.bits == 16:
            grey *= np.float32(257)
        np.rint(grey, out=grey)
        np.clip(grey, 0, 2**self.bits - 1, out=grey)
        return grey.astype(np.uint16) if self.bits == 16 else grey.astype(np.uint8)
