"""The picture with the fan alone, as features: what all frames of a scan are compared with."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.image.centreline import Centreline
from core.image.noise import NoiseModel, estimate_noise
from core.image.stripe import StripeSettings
from core.image.stripe_settings import choose_settings
from core.image.stripes import extract_centrelines
from core.model import Camera
from core.scan.crossings import CrossingWindow
from core.scan.reference import Picture, picture_difference

LIGHT_SHARE, LIGHT_FLOOR = 0.2, 0.02
"""A change of the background counts as one of the room's light from this share of it, and of the full scale, on."""


@dataclass(frozen=True, slots=True)
class FeatureOptions:
    """How pictures become features; None means chosen from the pictures.

    A frame in which a stretch of the fan has moved by more than `move_limit_px` since the reference is left out. With
    a `camera`, centrelines are crossed as they would be without its distortion.
    """

    sweep_stripe: StripeSettings | None = None
    fan_stripe: StripeSettings | None = None
    window: CrossingWindow = field(default_factory=CrossingWindow)
    move_limit_px: float = 0.3
    camera: Camera | None = None


@dataclass(frozen=True, eq=False, slots=True)
class ReferenceFeatures:
    """What the picture with the fan alone shows, and what frames are compared with.

    `base` (H, W) is the picture as it came, `full_scale` its largest possible grey level, `noise` that of a frame minus
    the picture; `fan` the fan's centrelines, `stripe` how they were looked for.
    """

    base: Picture
    full_scale: float
    noise: NoiseModel
    fan: tuple[Centreline, ...]
    stripe: StripeSettings

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        height, width = self.base.shape
        return width, height

    def difference(self, picture: Picture) -> NDArray[np.int16] | NDArray[np.float32]:
        """A frame minus the picture, both (H, W)."""
        return picture_difference(picture, self.base)

    def light_change(self, grey: float) -> float:
        """A change of the background by `grey` levels as a share of it; 0 where stripes do not feel it."""
        background = max(float(np.median(self.base[::16, ::16])), 1.0)
        if abs(grey) < max(LIGHT_SHARE * background, LIGHT_FLOOR * self.full_scale):
            return 0.0
        return grey / background


def read_reference(picture: Picture, options: FeatureOptions | None = None) -> ReferenceFeatures:
    """The fan's centrelines in the picture with the fan alone.

    Raises
    ------
    InputError
        If it shows no fan line.
    """
    options = options or FeatureOptions()
    full_scale = float(np.iinfo(picture.dtype).max)
    base = picture.astype(np.float32)
    noise = estimate_noise(base)
    stripe, fan = _fan_centrelines(base, full_scale, noise, options)
    return ReferenceFeatures(picture, full_scale, noise.of_difference(float(np.median(base))), fan, stripe)


def _fan_centrelines(
    base: NDArray[np.float32], full_scale: float, noise: NoiseModel, options: FeatureOptions
) -> tuple[StripeSettings, tuple[Centreline, ...]]:
    settings = options.fan_stripe or choose_settings(base, full_scale)
    fan = () if settings is None else extract_centrelines(base, settings, noise=noise, saturated=base >= full_scale)
    if settings is None or not fan:
        raise InputError(
            "shows no line of the fan, so nothing can be measured",
            where="scan reference",
            todo="switch the three-line laser on, expose longer, or darken the room",
        )
    return settings, fan
