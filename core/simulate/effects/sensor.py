"""A sensor that blooms and smears, has hot pixels or a colour mosaic, and pictures kept as JPEG."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from core.simulate.effects.ranges import require_ranges

if TYPE_CHECKING:  # a window that starts reads scenarios, and loads no compiled loops
    from core.simulate.rays import Map

LASER_AT = (1.0, 0.12, 0.06)
"""Response of red, green and blue sites to light of 650 nm over that of the red ones."""
FULL_GREY = 255.0
"""Grey level of a full pixel of the simulated 8-bit sensor."""


@dataclass(frozen=True, slots=True)
class SensorEffects:
    """Effects of a sensor beyond noise, and of the files of its pictures.

    Parameters
    ----------
    brightness
        Factor on the lasers' light in the pictures of the scan: exposed too long, stripes saturate.
    bloom
        Share of the light beyond saturation that a full pixel passes on to the one below it. Frame-transfer CCDs
        without drains pass nearly all on, sensors with anti-blooming gates leave less than 0.1.
    smear
        Of the light of a column that all its pixels collect while it is read out: −100 to −60 dB in interline CCDs,
        1e-5 to 1e-3.
    hot_share
        Of the pixels that have a large dark current, by up to half of full scale: 1e-5 to 1e-3 in warm sensors.
    colour
        A Bayer mosaic, red at its first site, demosaiced bilinearly: pictures of three colours. The lasers are red.
    raw
        With `colour`: the mosaic as it was read, not demosaiced; rig.toml says so.
    second_exposure, third_exposure
        Every picture but those of the camera's target is taken again, exposed so many times shorter, or longer if it is
        below 1; 0: it is not.
    automatic_exposure
        Each picture is exposed longer or shorter than the others by up to this share, by chance.
    jpeg_quality
        Pictures are JPEG files of this quality with colours at half the size both ways (4:2:0); 0: lossless.

    References
    ----------
    Theuwissen, A., Solid-State Imaging with Charge-Coupled Devices (1995), 5.5 (blooming, smear). EMVA Standard 1288,
    release 4.0, 8 (defect pixels). ITU-T T.81 (JPEG). Bayer, B. E., US 3,971,065 (1976).
    """

    brightness: float = 1.0
    bloom: float = 0.0
    smear: float = 0.0
    hot_share: float = 0.0
    colour: bool = False
    raw: bool = False
    jpeg_quality: int = 0
    second_exposure: float = 0.0
    third_exposure: float = 0.0
    automatic_exposure: float = 0.0

    def __post_init__(self) -> None:
        require_ranges(
            self,
            (
                ("brightness", 0.01, 100.0),
                ("bloom", 0.0, 0.99),
                ("smear", 0.0, 0.1),
                ("hot_share", 0.0, 0.1),
                ("jpeg_quality", 0, 100),
                ("second_exposure", 0.0, 1000.0),
                ("third_exposure", 0.0, 1000.0),
                ("automatic_exposure", 0.0, 0.9),
            ),
        )

    def collected(self, light: Map, room: Map | None, black: float) -> Map:
        """Compute the light (h, w) that a colour mosaic, smear and blooming leave at each pixel, before noise.

        `room` (h, w) is the white share of it, the rest is red.
        """
        if self.colour:
            white = np.zeros_like(light) if room is None else room
            light = white + (light - white) * _response(light.shape)
        if self.smear:
            light = (
                light + np.float32(self.smear) * light.mean(axis=0, keepdims=True, dtype=np.float32) * light.shape[0]
            )
        if self.bloom:
            light = _bloomed(light, np.float32(FULL_GREY - black), np.float32(self.bloom))
        return light

    def with_hot_pixels(self, light: Map, rng: np.random.Generator) -> Map:
        """Add the dark current of hot pixels to light (h, w); an `rng` of the same seed gives the same pixels."""
        if not self.hot_share:
            return light
        hot = rng.random(light.shape, dtype=np.float32) < self.hot_share
        light = light.copy()
        light[hot] += rng.uniform(0, FULL_GREY / 2, np.count_nonzero(hot)).astype(np.float32)
        return light

    def developed(self, picture: NDArray[np.uint8] | NDArray[np.uint16]) -> NDArray[np.uint8] | NDArray[np.uint16]:
        """Interpolate a colour mosaic (h, w) to (h, w, 3) blue, green, red for its file; keep grey and raw."""
        if not self.colour or self.raw:
            return picture
        return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BayerRGGB2BGR), dtype=picture.dtype)  # type: ignore[return-value]

    @property
    def suffix(self) -> str:
        """Ending of the pictures' file names, with its point."""
        return ".jpg" if self.jpeg_quality else ".png"

    def file_of(self, picture: NDArray[np.uint8] | NDArray[np.uint16]) -> bytes:
        """Encode a picture (h, w) or (h, w, 3) as the bytes of a file of this sensor's format."""
        settings = [cv2.IMWRITE_JPEG_QUALITY, self.jpeg_quality]
        settings += [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420]
        done, data = cv2.imencode(self.suffix, picture, settings if self.jpeg_quality else [])
        assert done
        return bytes(data)


IDEAL_SENSOR = SensorEffects()
"""Of nothing but noise, its pictures lossless."""


def _response(shape: tuple[int, ...]) -> Map:
    """Response (h, w) of a mosaic's sites to the lasers."""
    red, green, blue = LASER_AT
    tile = np.array([[red, green], [green, blue]], np.float32)
    return np.tile(tile, ((shape[0] + 1) // 2, (shape[1] + 1) // 2))[: shape[0], : shape[1]]


def _bloomed(light: Map, full: np.float32, share: np.float32) -> Map:
    """Light (h, w) with what full pixels pass on to those below them."""
    out = light.copy()
    over = np.zeros_like(out[0])
    for row in out:
        row += over
        over = np.maximum(row - full, np.float32(0)) * share
    return out
