"""Checks before a scan: reference, fan lines, exposure, focus and the age of the calibrations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from core.image.exposure import stripe_exposure
from core.image.stripes.centreline import Centreline
from core.messages import Message, plain, plural_message
from core.model import Camera, Fan
from core.scan.changed_section import ChangedSection, Section

Name = Literal["reference", "lines", "exposure", "focus", "calibration", "check", "boards"]
State = Literal["ok", "failed", "unknown"]

FRESH_DAYS = 30.0
"""Age in days above which a calibration is asked for again: screws settle and lasers age."""

SAME_FOCUS, OTHER_FOCUS = 1.25, 1.6
"""Width of the fan's stripes over that in its calibration: up to the first the focus is the same, from the second on
it is not. Parts nearer or farther than the plate was, or rough ones, account for what is between.
tests/scan/preview/test_preflight.py holds them.
"""

IN_FOCUS, OUT_OF_FOCUS = 1 / 600, 1 / 250
"""Where the calibration's width is not known: Gaussian σ of the stripes over the picture's width, in the same way."""

_NO_REFERENCE = Message("scan.check_no_reference", "Take the reference first.")
_DAY_S = 86_400.0
"""Seconds of a day."""


@dataclass(frozen=True, slots=True)
class Check:
    """One check made before a scan: its name, its result and what to tell the technician."""

    name: Name
    state: State
    message: Message


@dataclass(frozen=True, eq=False, slots=True)
class Preflight:
    """Facts known before a scan, such as reference and calibrations, and the checks that follow from them.

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
        Why the latest picture does not suit the reference; None if it does.
    camera, fan
        The calibrations; None where there is none.
    age_s
        Time since the older of the two was made; None if that is not known.
    stripe_px
        Median width (σ) of the fan's stripes when it was calibrated; None if that is not known.
    fresh_days
        For how many days a calibration holds.
    section
        Whether the fan's stripes are skewed otherwise than in its calibration.
    boards, boards_missing
        Names of the boards that lie beside the part, and of those whose picture is not taken yet.
    """

    lines: int
    image_size: tuple[int, int]
    fan_lines: tuple[tuple[Centreline, ...], ...] | None = None
    full_scale: float = 255.0
    departed: Message | None = None
    camera: Camera | None = None
    fan: Fan | None = None
    age_s: float | None = None
    stripe_px: float | None = None
    fresh_days: float = FRESH_DAYS
    section: ChangedSection | Section = Section.SAME
    boards: tuple[str, ...] = ()
    boards_missing: tuple[str, ...] = ()

    def checks(self) -> tuple[Check, ...]:
        """Make the checks before a scan: boards, reference, what rests on it (lines, exposure, focus), calibration."""
        boards = (self._boards_seen(),) if self.boards else ()
        if not self.lines:
            return *boards, self._reference(), self._calibration()
        return *boards, self._reference(), self._lines(), self._exposure(), self._focus(), self._calibration()

    def _boards_seen(self) -> Check:
        if self.boards_missing:
            missing = Message(
                "scan.check_boards_missing",
                "Not seen yet: {boards:and}.",
                boards=tuple(plain(name) for name in self.boards_missing),
            )
            return Check("boards", "unknown" if self.fan_lines is None else "failed", missing)
        seen = Message(
            "scan.check_boards",
            "The boards are seen: {boards:and}.",
            boards=tuple(plain(name) for name in self.boards),
        )
        return Check("boards", "ok", seen)

    def _reference(self) -> Check:
        if self.fan_lines is None:
            return Check("reference", "unknown", _NO_REFERENCE)
        if self.departed is not None:
            departed = Message(
                "scan.check_reference_lost", "The reference does not hold any more: {why}.", why=self.departed
            )
            return Check("reference", "failed", departed)
        return Check("reference", "ok", Message("scan.check_reference", "The reference holds."))

    def _lines(self) -> Check:
        if self.fan_lines is None:
            return Check("lines", "unknown", _NO_REFERENCE)
        if self.camera is None or self.fan is None:
            untold = Message(
                "scan.check_lines_unknown", "The fan's lines can be told apart once camera and fan are calibrated."
            )
            return Check("lines", "unknown", untold)
        seen = sum(bool(pieces) for pieces in self.fan_lines)
        if seen < self.lines:
            few = Message(
                "scan.check_lines_few",
                "Only {n} of the fan's {all} lines can be made out on the part.",
                n=seen,
                all=self.lines,
            )
            return Check("lines", "failed", few)
        return Check("lines", "ok", Message("scan.check_lines", "All {n} lines of the fan are seen.", n=self.lines))

    def _exposure(self) -> Check:
        exposure = stripe_exposure(self._stripes, self.full_scale)
        if self.fan_lines is None:
            return Check("exposure", "unknown", _NO_REFERENCE)
        if exposure is None:
            little = Message("scan.check_exposure_unknown", "Too little of the fan is seen to tell.")
            return Check("exposure", "unknown", little)
        if exposure.is_good:
            good = Message("scan.check_exposure", "The fan's stripes reach {level:.0%} of white.", level=exposure.level)
            return Check("exposure", "ok", good)
        if exposure.factor < 1:
            bright = Message(
                "scan.check_overexposed", "{share:.0%} of the fan's stripes are overexposed.", share=exposure.saturated
            )
            return Check("exposure", "failed", bright)
        faint = Message(
            "scan.check_faint",
            "The fan's stripes are faint: they reach {level:.0%} of white.",
            level=exposure.level,
        )
        return Check("exposure", "failed", faint)

    def _focus(self) -> Check:
        stripes = self._stripes
        if not sum(map(len, stripes)):
            return Check("focus", "unknown", _NO_REFERENCE)
        width = stripe_width(stripes)
        assert width is not None
        if self.stripe_px is None:
            sharp, blurred = IN_FOCUS * self.image_size[0], OUT_OF_FOCUS * self.image_size[0]
            said = Message("scan.stripe_width", "The fan's stripes are {width_px:.1f} px wide (σ)", width_px=width)
            todo = Message("scan.advice_focus", "focus camera and laser, then calibrate again")
        else:
            sharp, blurred = SAME_FOCUS * self.stripe_px, OTHER_FOCUS * self.stripe_px
            said, todo = _width_changed(width, self.stripe_px), _REFOCUS
        if width >= blurred:
            return Check("focus", "failed", _out_of_focus(said, todo))
        if isinstance(self.section, ChangedSection):
            return Check("focus", "failed", self.section.note)
        if self.section is Section.NOT_KNOWN:
            unknown = Message(
                "scan.check_section_unknown",
                "{width}. Whether they reach as far to one side as when the fan was calibrated cannot be told.",
                width=said,
            )
            return Check("focus", "unknown", unknown)
        return Check(
            "focus", "ok" if width <= sharp else "unknown", Message("scan.check_focus", "{width}.", width=said)
        )

    def _calibration(self) -> Check:
        failed: tuple[Name, State] = ("calibration", "failed")
        if self.camera is None:
            return Check(
                *failed, Message("scan.check_no_camera", "The camera is not calibrated: the scan would give no points.")
            )
        if self.fan is None and self.lines:
            return Check(
                *failed, Message("scan.check_no_fan", "The fan is not calibrated: the scan would give no points.")
            )
        if self.camera.image_size != self.image_size:
            (width, height), (then_width, then_height) = self.image_size, self.camera.image_size
            other_size = Message(
                "scan.check_other_size",
                "The pictures have {width} × {height} pixels, but the camera was calibrated at "
                "{then_width} × {then_height}.",
                width=width,
                height=height,
                then_width=then_width,
                then_height=then_height,
            )
            return Check(*failed, other_size)
        if self.age_s is None:
            unknown = (
                Message("scan.check_age_unknown", "It is not known when camera and fan were calibrated.")
                if self.lines
                else Message("scan.check_camera_age_unknown", "It is not known when the camera was calibrated.")
            )
            return Check("calibration", "unknown", unknown)
        days = self.age_s / _DAY_S
        if days > self.fresh_days:
            old = Message("scan.check_old", "The calibration is {n:.0f} days old: calibrate again.", n=days)
            return Check(*failed, old)
        if days < 1:
            today = (
                Message("scan.check_fresh", "Camera and fan were calibrated less than a day ago.")
                if self.lines
                else Message("scan.check_camera_fresh", "The camera was calibrated less than a day ago.")
            )
            return Check("calibration", "ok", today)
        age = (
            plural_message(
                "scan.check_age",
                "Camera and fan were calibrated {n} day ago.",
                "Camera and fan were calibrated {n} days ago.",
                n=round(days),
            )
            if self.lines
            else plural_message(
                "scan.check_camera_age",
                "The camera was calibrated {n} day ago.",
                "The camera was calibrated {n} days ago.",
                n=round(days),
            )
        )
        return Check("calibration", "ok", age)

    @property
    def _stripes(self) -> Sequence[Centreline]:
        return [piece for pieces in self.fan_lines or () for piece in pieces]


def stripe_width(pieces: Iterable[Centreline]) -> float | None:
    """Compute the median width (σ) of stripes in pixels; None where there is none."""
    widths = np.concatenate([np.empty(0), *(piece.width for piece in pieces)])
    return float(np.median(widths)) if len(widths) else None


def other_focus(width_px: float, then_px: float) -> Message | None:
    """Make the complaint that the fan's stripes are so much wider than in its calibration that the focus differs.

    Widths are σ in px. None if they are not.
    """
    return _out_of_focus(_width_changed(width_px, then_px), _REFOCUS) if width_px >= OTHER_FOCUS * then_px else None


_REFOCUS = Message(
    "scan.advice_refocus",
    "set the focus of camera and laser back, and look for a smeared lens; else calibrate again",
)


def _width_changed(width_px: float, then_px: float) -> Message:
    return Message(
        "scan.stripe_width_changed",
        "The fan's stripes are {width_px:.1f} px wide (σ), {then_px:.1f} px when the fan was calibrated",
        width_px=width_px,
        then_px=then_px,
    )


def _out_of_focus(width: Message, todo: Message) -> Message:
    return Message("scan.check_out_of_focus", "{width}: {todo}.", width=width, todo=todo)
