"""The reference: what the camera sees without the hand-held laser, as features, and whether that still holds.

The fan and the object stand still during a scan, so the sweep's stripe is the frame minus the reference. When there is
no reference picture, one is made of the frames (`core.image.background`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.errors import InputError
from core.image.mosaic import ALL_SITES, Sites
from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import extract_centrelines
from core.image.stripes.noise import UNCOMPRESSED, Compression, NoiseModel, estimate_noise
from core.image.stripes.running_statistics import median
from core.image.stripes.settings import choose_settings
from core.image.stripes.stripe import USUAL_STRIPE, StripeSettings
from core.image.stripes.told_width import as_measured
from core.messages import Message
from core.model import Camera
from core.model.arrays import Array
from core.scan.features.board_print import without_marks
from core.scan.features.crossings import CrossingWindow
from core.scan.features.fan_light import FanLight
from core.scan.features.room_light import RoomLight

Picture = NDArray[np.uint8] | NDArray[np.uint16]


def picture_difference(picture: Picture, base: Picture) -> NDArray[np.int16] | NDArray[np.float32]:
    """Compute `picture` − `base` (H, W), as int16 if both are of 8 bits, else as float32.

    Pictures of 8 bits are what a camera sends a hundred times a second: a compiled loop takes a third of the time that
    OpenCV takes for different types of input and output.
    """
    if picture.dtype == np.uint8 == base.dtype:
        return _difference(picture, base)
    return np.asarray(cv2.subtract(picture, base, dtype=cv2.CV_32F), dtype=np.float32)


@compiled()
def _difference(picture: Picture, base: Picture) -> NDArray[np.int16]:
    height, width = picture.shape
    found = np.empty((height, width), np.int16)
    for j in range(height):
        line, under, out = picture[j], base[j], found[j]
        for i in range(width):
            out[i] = np.int16(line[i]) - np.int16(under[i])
    return found


STRETCH = 48
"""Points of a stretch of the fan's light whose shift is watched: short enough to see a part that turns, long
enough that a sweep across it does not matter to its median."""


@dataclass(frozen=True, eq=False, slots=True)
class ReferenceCheck:
    """Departure of a frame from the reference: shifts in px of the fan's light, its loss, and change of background.

    `shift_px` is the largest median shift of any of the fan's centrelines across itself; `lost` says that a whole
    stretch of the fan's light is gone; `light` the change of the background in grey levels. `shifts_px` (C,) are the
    median shifts across itself of the fan's light, stretch by stretch as `fan_stretches` cuts it.
    """

    shift_px: float
    lost: bool
    light: float
    shifts_px: Array


def check_reference(difference: NDArray[np.int16] | NDArray[np.float32], fan: Sequence[Centreline]) -> ReferenceCheck:
    """Measure how the fan's light has shifted, vanished or changed in a frame, from `difference` = frame − reference.

    A stripe A exp(−x²/2s²) shifted by δ leaves ±δ A exp(−½)/s at x = ±s, so δ follows from the two flanks; a sweep
    crosses few of a stripe's points, and the median over them does not see it.
    """
    light = float(np.median(difference[::16, ::16]))
    worst, lost = 0.0, False
    for piece in fan:
        piece = piece.select(np.arange(0, len(piece), 3))
        piece = piece.select(np.flatnonzero(piece.strength > 0))  # what has none tells nothing
        uv, width, strength = piece.uv.copy(), piece.width, piece.strength
        if len(uv) < 20:
            continue
        offset = piece.normal * width[:, None]
        flank_plus = _sample(difference, uv + offset)
        flank_minus = _sample(difference, uv - offset)
        centre = _sample(difference, uv)
        slope = 2 * np.exp(-0.5) * strength / width
        shift = abs(median((flank_plus - flank_minus) / slope))
        lost = lost or median((centre - light) / strength) < -0.5
        worst = max(worst, shift)
    return ReferenceCheck(worst, lost, light, _shifts(difference, fan))


def fan_stretches(fan: Sequence[Centreline]) -> list[tuple[int, slice]]:
    """Divide the fan's centrelines into stretches of STRETCH points, in each of which its light is watched.

    Each is the index of a centreline and the slice of its points; a shorter rest of a centreline is in none, nor is one
    with points without strength, whose shift cannot be told.
    """
    return [
        (number, slice(STRETCH * k, STRETCH * (k + 1)))
        for number, piece in enumerate(fan)
        for k in np.flatnonzero(_lit(piece)).tolist()
    ]


def _lit(piece: Centreline) -> NDArray[np.bool_]:
    """Of each stretch of a centreline, whether all of its points have strength."""
    return np.asarray((_by_stretch(piece.strength) > 0).all(axis=1))


def _by_stretch(values: Array) -> Array:
    """Values (N,) of a centreline's points by stretches (K, STRETCH), without the shorter rest."""
    return values[: len(values) // STRETCH * STRETCH].reshape(-1, STRETCH)


def _shifts(difference: NDArray[np.int16] | NDArray[np.float32], fan: Sequence[Centreline]) -> Array:
    """Median shift (C,) in px of each stretch along its normals."""
    found = [np.zeros((0, STRETCH))]
    for piece in fan:
        lit = _lit(piece)
        offset = piece.normal * piece.width[:, None]
        flanks = _sample(difference, piece.uv + offset) - _sample(difference, piece.uv - offset)
        slope = 2 * np.exp(-0.5) * _by_stretch(piece.strength)[lit]
        found.append(_by_stretch(flanks * piece.width)[lit] / slope)
    return np.asarray(np.median(np.concatenate(found), axis=1))


@compiled()
def _sample(picture: NDArray[np.int16] | NDArray[np.float32], uv: Array) -> Array:
    """Bilinear values (N,) of `picture` at `uv` (N, 2), which lie inside it or count as on its rim."""
    height, width = picture.shape
    values = np.empty(len(uv))
    for k in range(len(uv)):
        u, v = min(max(uv[k, 0], 0.0), width - 1.0), min(max(uv[k, 1], 0.0), height - 1.0)
        i, j = min(int(u), width - 2), min(int(v), height - 2)
        a, b = u - i, v - j
        above = (1 - a) * picture[j, i] + a * picture[j, i + 1]
        below = (1 - a) * picture[j + 1, i] + a * picture[j + 1, i + 1]
        values[k] = (1 - b) * above + b * below
    return values


LIGHT_SHARE, LIGHT_FLOOR = 0.2, 0.02
"""A change of the background counts as one of the room's light from this share of it, and of the full scale, on."""


@dataclass(frozen=True, slots=True)
class FeatureOptions:
    """Options of extracting features from pictures; a stripe that is None is chosen from the pictures.

    A stripe's width that the pictures contradict gives way to the measured one.

    A frame in which a stretch of the fan has moved by more than `move_limit_px` since the reference is left out. With
    a `camera`, centrelines are crossed as they would be without its distortion. `compression` is that of each picture.
    Of whole pictures only the `sites` are handed in; what is found is in px of the whole pictures. `has_fan`: whether
    there is a fan whose lines are looked for. On the `marks` (H, W) that are printed on boards nothing is looked for.
    """

    sweep_stripe: StripeSettings | None = None
    fan_stripe: StripeSettings | None = None
    window: CrossingWindow = field(default_factory=CrossingWindow)
    move_limit_px: float = 0.3
    camera: Camera | None = None
    compression: Compression = UNCOMPRESSED
    sites: Sites = ALL_SITES
    has_fan: bool = True
    marks: NDArray[np.bool_] | None = None


class LaserLight(NamedTuple):
    """Difference of a frame from the reference picture, after changes of exposure and of the room's light are removed.

    `difference` (H, W) is what is left; `room` what the room's light has changed, in grey levels, as `RoomLight.change`
    states it, 0 where it was too small to be taken off; `gain` the factor of the frame's light over the reference's.
    """

    difference: NDArray[np.int16] | NDArray[np.float32]
    room: float
    gain: float


@dataclass(frozen=True, eq=False, slots=True)
class ReferenceFeatures:
    """Features of the picture with the fan alone, and this picture itself, which frames are compared with.

    `base` (H, W) is the picture as it came, `full_scale` its largest possible grey level, `noise` that of a frame minus
    the picture; `fan` the fan's centrelines, `stripe` how they were looked for; `room` and `light` are what
    it shows of the room's light and of the fan's. On `marks` (H, W) no stripe is looked for.
    """

    base: Picture
    full_scale: float
    noise: NoiseModel
    fan: tuple[Centreline, ...]
    stripe: StripeSettings
    room: RoomLight
    light: FanLight
    marks: NDArray[np.bool_] | None = None

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height in px of the picture with the fan alone."""
        height, width = self.base.shape
        return width, height

    def difference(self, picture: Picture) -> NDArray[np.int16] | NDArray[np.float32]:
        """Compute `picture` − reference (H, W), the reference being the picture with the fan alone."""
        return picture_difference(picture, self.base)

    def of_lasers(self, picture: Picture) -> LaserLight:
        """Subtract the reference from a `picture` (H, W), then what changes of exposure and room light leave."""
        difference, room = self.difference(picture), 0.0
        changed = self.room.change(difference)
        if changed is not None:
            difference, room = difference.astype(np.float32) - changed[0], changed[1]
        gain = self.light.gain(difference)
        if gain != 1:
            self.light.take_off(difference, gain)
        return LaserLight(difference, room, gain)

    def light_change(self, seen: LaserLight) -> float:
        """Compute by what share of the background room light has changed, apart from exposure; 0 if too little."""
        background = max(float(np.median(self.base[::16, ::16])), 1.0)
        grey = seen.room - (seen.gain - 1) * background if seen.room else 0.0
        if abs(grey) < max(LIGHT_SHARE * background, LIGHT_FLOOR * self.full_scale):
            return 0.0
        return grey / background


def read_reference(
    picture: Picture, options: FeatureOptions | None = None, first: ReferenceFeatures | None = None
) -> ReferenceFeatures:
    """Extract the fan's centrelines from a `picture` (H, W) with the fan alone, and its room light and noise.

    Given `first`, what was read from the first exposure, a further one may show no line of the fan.

    Raises
    ------
    InputError
        If it shows no line of a fan that is there; a further exposure may show none, where the first one is not
        saturated.
    """
    options = options or FeatureOptions()
    full_scale = float(np.iinfo(picture.dtype).max)
    base = picture.astype(np.float32)
    noise = replace(estimate_noise(base), compression=options.compression)
    try:
        stripe, fan = _fan_centrelines(base, full_scale, noise, options)
    except InputError:
        if first is None:
            raise
        stripe, fan = first.stripe, ()
    room = RoomLight.of(picture, fan, full_scale)
    return ReferenceFeatures(
        picture,
        full_scale,
        noise.of_difference(float(np.median(base))),
        fan,
        stripe,
        room,
        FanLight.of(picture, room.bare, full_scale),
        options.marks,
    )


def _fan_centrelines(
    base: NDArray[np.float32], full_scale: float, noise: NoiseModel, options: FeatureOptions
) -> tuple[StripeSettings, tuple[Centreline, ...]]:
    if not options.has_fan:
        return options.fan_stripe or USUAL_STRIPE, ()

    def look(settings: StripeSettings) -> tuple[Centreline, ...]:
        return extract_centrelines(base, settings, noise=noise, saturated=base >= full_scale, ignore=options.marks)

    settings = options.fan_stripe or choose_settings(without_marks(base, options.marks), full_scale)
    fan = tuple[Centreline, ...]()
    if settings is not None:
        settings, fan = as_measured(settings, look) if options.fan_stripe else (settings, look(settings))
    if settings is None or not fan:
        raise InputError(
            Message("scan.no_fan_line", "shows no line of the fan, so nothing can be measured"),
            where="scan reference",
            todo=Message(
                "scan.advice_light_the_fan", "switch the three-line laser on, expose longer, or darken the room"
            ),
        )
    return settings, fan
