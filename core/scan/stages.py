"""One frame of a recording as it is shown: what every stage from picture to crossings makes of it. Light to import."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.image.stripe import StripeSettings
from core.scan.frame_preview import FramePreview

Picture8 = NDArray[np.uint8]
"""(H, W) grey levels for display."""


@dataclass(frozen=True, eq=False, slots=True)
class FrameStages:
    """What every stage makes of one frame.

    Parameters
    ----------
    index, name
        Of the frame, in the order of the recording.
    picture
        As it was recorded.
    difference
        Frame − reference, brightened alike for all frames; what is darker than the reference is black.
    ridge
        Steger's strength at the stripe's scale, brightened in the same way.
    brighter
        Grey levels of `difference` and `ridge` for one grey level of the picture.
    sweep
        The hand-held laser's centrelines.
    fan
        The fan's centrelines, and in `fan_line` the line (from 0) each of them belongs to; −1 where that is not known.
    seen
        Crossings, each good, weak or left out with the reason, as this frame gives them by itself; None without
        calibrations.
    shift_px
        How far the fan's light is from where it is in the reference.
    left_out
        Whether this frame is left out by hand; its stages are shown all the same.
    reason
        Why there is no sweep; empty if there is.
    """

    index: int
    name: str
    picture: Picture8
    difference: Picture8
    ridge: Picture8
    brighter: float
    sweep: tuple[Centreline, ...]
    fan: tuple[Centreline, ...]
    fan_line: tuple[int, ...]
    seen: FramePreview | None
    shift_px: float
    left_out: bool
    reason: str


@dataclass(frozen=True, slots=True)
class SettledScan:
    """What a finished measurement of the recording has settled: how stripes look, and the lines of the fan's pieces."""

    sweep_stripe: StripeSettings | None
    fan_stripe: StripeSettings
    fan_line: tuple[int, ...]
