"""What is looked at before a scan is worth its time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from core.image.centreline import Centreline
from core.image.exposure import stripe_exposure
from core.model import Camera, Fan

Name = Literal["reference", "lines", "exposure", "focus", "calibration"]
State = Literal["ok", "failed", "unknown"]

FRESH_DAYS = 30.0
"""A calibration older than this is asked for again: screws settle and lasers age."""

AS_SHARP, BLURRED = 1.25, 1.6
"""Width of the fan's stripes over that in its calibration: up to the first the focus is the same, from the second on
it is not. Parts nearer or farther than the plate was, or rough ones, account for what is between.
"""

IN_FOCUS, OUT_OF_FOCUS = 1 / 600, 1 / 250
"""Where the calibration's width is not known: Gaussian σ of the stripes over the picture's width, in the same way."""

_NO_REFERENCE = "Take the reference first."
_DAY_S = 86_400.0


@dataclass(frozen=True, slots=True)
class Check:
    """One thing that was looked at, what came of it, and a sentence."""

    name: Name
    state: State
    sentence: str


@dataclass(frozen=True, eq=False, slots=True)
class Preflight:
    """What is known before a scan.

    Parameters
    ----------
    lines
        How many lines the fan has.
    image_size
        (width, height) of the pictures that come now.
    fan_lines
        The reference's centrelines by line number, as far as they are settled; None before there is a reference.
    full_scale
        Largest grey level of the pictures.
    departed
        Why the latest picture does not suit the reference, or "".
    camera, fan
        The calibrations; None where there is none.
    age_s
        Time since the older of the two was made; None if that is not known.
    stripe_px
        Median width (σ) of the fan's stripes when it was calibrated; None if that is not known.
    """

    lines: int
    image_size: tuple[int, int]
    fan_lines: tuple[tuple[Centreline, ...], ...] | None = None
    full_scale: float = 255.0
    departed: str = ""
    camera: Camera | None = None
    fan: Fan | None = None
    age_s: float | None = None
    stripe_px: float | None = None

    def checks(self) -> tuple[Check, ...]:
        """All checks, the reference first: the next three rest on it."""
        return self._reference(), self._lines(), self._exposure(), self._focus(), self._calibration()

    def _reference(self) -> Check:
        if self.fan_lines is None:
            return Check("reference", "unknown", _NO_REFERENCE)
        if self.departed:
            return Check("reference", "failed", f"The reference does not hold any more: {self.departed}.")
        return Check("reference", "ok", "The reference holds.")

    def _lines(self) -> Check:
        if self.fan_lines is None:
            return Check("lines", "unknown", _NO_REFERENCE)
        if self.camera is None or self.fan is None:
            return Check("lines", "unknown", "The fan's lines can be told apart once camera and fan are calibrated.")
        seen = sum(bool(pieces) for pieces in self.fan_lines)
        if seen < self.lines:
            return Check("lines", "failed", f"Only {seen} of the fan's {self.lines} lines can be made out on the part.")
        return Check("lines", "ok", f"All {self.lines} lines of the fan are seen.")

    def _exposure(self) -> Check:
        exposure = stripe_exposure(self._stripes, self.full_scale)
        if self.fan_lines is None or exposure is None:
            sentence = _NO_REFERENCE if self.fan_lines is None else "Too little of the fan is seen to tell."
            return Check("exposure", "unknown", sentence)
        if exposure.is_good:
            return Check("exposure", "ok", f"The fan's stripes reach {exposure.level:.0%} of white.")
        if exposure.factor < 1:
            return Check("exposure", "failed", f"{exposure.saturated:.0%} of the fan's stripes are overexposed.")
        return Check("exposure", "failed", f"The fan's stripes are faint: they reach {exposure.level:.0%} of white.")

    def _focus(self) -> Check:
        stripes = self._stripes
        if not sum(map(len, stripes)):
            return Check("focus", "unknown", _NO_REFERENCE)
        width = float(np.median(np.concatenate([piece.width for piece in stripes])))
        said = f"The fan's stripes are {width:.1f} px wide (σ)"
        if self.stripe_px is None:
            sharp, blurred = IN_FOCUS * self.image_size[0], OUT_OF_FOCUS * self.image_size[0]
            todo = "focus camera and laser, then calibrate again"
        else:
            sharp, blurred = AS_SHARP * self.stripe_px, BLURRED * self.stripe_px
            said = f"{said}, {self.stripe_px:.1f} px when the fan was calibrated"
            todo = "set the focus of camera and laser back, and look for a smeared lens; else calibrate again"
        if width >= blurred:
            return Check("focus", "failed", f"{said}: {todo}.")
        return Check("focus", "ok" if width <= sharp else "unknown", f"{said}.")

    def _calibration(self) -> Check:
        if self.camera is None or self.fan is None:
            missing = "camera" if self.camera is None else "fan"
            return Check("calibration", "failed", f"The {missing} is not calibrated: the scan would give no points.")
        if self.camera.image_size != self.image_size:
            now, then = ("{} × {}".format(*size) for size in (self.image_size, self.camera.image_size))
            sentence = f"The pictures have {now} pixels, but the camera was calibrated at {then}."
            return Check("calibration", "failed", sentence)
        if self.age_s is None:
            return Check("calibration", "unknown", "It is not known when camera and fan were calibrated.")
        days = self.age_s / _DAY_S
        if days > FRESH_DAYS:
            return Check("calibration", "failed", f"The calibration is {days:.0f} days old: calibrate again.")
        age = "less than a day" if days < 1 else f"{days:.0f} day{'s' if round(days) != 1 else ''}"
        return Check("calibration", "ok", f"Camera and fan were calibrated {age} ago.")

    @property
    def _stripes(self) -> Sequence[Centreline]:
        return [piece for pieces in self.fan_lines or () for piece in pieces]
