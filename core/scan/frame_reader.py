"""One frame of a scan to the sweep's centrelines, or to the reason there are none."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.image.stripe import StripeSettings
from core.image.stripes import extract_centrelines
from core.scan.reference import Picture, check_reference
from core.scan.reference_features import FeatureOptions, ReferenceFeatures
from core.stage_times import StageTimes, stage

MOVED = "object or camera moved during the scan: the fan's light lies elsewhere than in the reference"
LOST = "the fan's light is gone: object or camera moved far during the scan, or the three-line laser was off"
NO_STRIPE = "no stripe of the hand-held laser"

Frame = tuple[str, Picture | str]
"""A frame's name and its picture, or the sentence that says why it could not be read."""


@dataclass(frozen=True, eq=False, slots=True)
class FrameFeatures:
    """The sweep's centrelines in one frame, or the `reason` there are none.

    Against the reference: `shift_px` of the fan's light, and `light_change` of the background as a share of it, 0 where
    it is too small to tell.
    """

    index: int
    name: str
    centrelines: tuple[Centreline, ...]
    reason: str = ""
    shift_px: float = 0.0
    light_change: float = 0.0


@dataclass(frozen=True, eq=False, slots=True)
class FrameReader:
    """A frame and its number to features, against one reference; called from several threads."""

    reference: ReferenceFeatures
    stripe: StripeSettings | None
    move_limit_px: float = FeatureOptions().move_limit_px
    times: StageTimes | None = None

    def __call__(self, item: tuple[int, Frame]) -> FrameFeatures:
        index, (name, picture) = item
        if isinstance(picture, str):
            return FrameFeatures(index, name, (), picture)
        base, full_scale, fan = self.reference.base, self.reference.full_scale, self.reference.fan
        if picture.shape != base.shape:
            return FrameFeatures(index, name, (), _sizes_differ(picture, base))
        if nothing := _shows_nothing(picture, full_scale):
            return FrameFeatures(index, name, (), nothing)
        with stage(self.times, "difference"):
            difference = self.reference.difference(picture)
            check = check_reference(difference, fan)
            light = self.reference.light_change(check.light)
        if check.lost:
            return FrameFeatures(index, name, (), LOST, check.shift_px, light)
        if check.shift_px > self.move_limit_px:
            return FrameFeatures(index, name, (), MOVED, check.shift_px, light)
        if self.stripe is None:
            return FrameFeatures(index, name, (), NO_STRIPE, check.shift_px, light)
        with stage(self.times, "extraction"):
            saturated = saturated_pixels(picture)
            pieces = extract_centrelines(difference, self.stripe, noise=self.reference.noise, saturated=saturated)
        reason = "" if pieces else NO_STRIPE
        return FrameFeatures(index, name, pieces, reason, check.shift_px, light)


def saturated_pixels(picture: Picture) -> NDArray[np.bool_]:
    """True (H, W) where a picture holds its largest possible value."""
    highest = np.iinfo(picture.dtype).max
    _, found = cv2.threshold(picture, highest - 1, 1, cv2.THRESH_BINARY)
    return np.asarray(found, dtype=np.uint8).view(np.bool_)


def _shows_nothing(picture: Picture, full_scale: float) -> str:
    """Why a picture without any contrast is of no use, or nothing."""
    sample = picture[::61, ::67]
    if sample.max() <= 0.01 * full_scale or sample.min() >= 0.99 * full_scale:
        sample = picture[::4, ::4]
    if sample.max() <= 0.01 * full_scale:
        return "the picture is all black"
    if sample.min() >= 0.99 * full_scale:
        return "the picture is all white"
    return ""


def _sizes_differ(picture: Picture, base: Picture) -> str:
    (height, width), (base_height, base_width) = picture.shape, base.shape
    return f"its size {width} × {height} differs from the reference's {base_width} × {base_height}"
