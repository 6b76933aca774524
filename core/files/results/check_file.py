"""check.json: what an interim check says of camera and laser, picture by picture and stripe by stripe."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from core import __version__
from core.calibrate.change import P_TOLD, PROVES_NOTHING
from core.files.complaints import checked_json
from core.files.json_text import write_json
from core.files.reading import read_json
from core.files.tables import RESULT, Finite, LengthAbove0, OptionalMessage, OrNan, Probability, Time, kept
from core.messages import Command, Message

CheckVerdict = Literal["passed", "doubtful", "failed"]

_TODO = Message("advice.check_first", "check first{command}", command=Command("trisect check SET --out DIR"))


@dataclass(frozen=True, slots=True)
class CheckedLine:
    """Stripe of the fan's `line` (from 1): its distance from its light plane, with standard uncertainty.

    `offset_px` is the same in the picture.
    """

    line: int
    offset_mm: Finite
    offset_px: Finite
    sd_mm: Finite
    __pydantic_config__ = RESULT


@dataclass(frozen=True, slots=True)
class CheckedPicture:
    """Pose of the target in a check: its stripes, or the `reason` why it is not used."""

    name: str
    reason: OptionalMessage = None
    lines: tuple[CheckedLine, ...] = ()
    __pydantic_config__ = RESULT

    @property
    def used(self) -> bool:
        """Whether the pose takes part in the check: it has no reason against it."""
        return self.reason is None


@dataclass(frozen=True, slots=True)
class InterimCheck:
    """Result of an interim check.

    Parameters
    ----------
    calibration_id
        The camera and the fan that were checked.
    pictures_id
        Names the pictures by what is in them: the same pictures checked again are no other check.
    taken_at
        When the newest of them was taken.
    p
        Probability that chance alone would set stripes and calibrations this far apart.
    poses
        What each pose showed.
    step_mm
        Height of the step that the errors are told for.
    error_mm
        By how much camera and laser as they are now would measure such a step too high with the calibrations.
    unseen_mm
        Expanded uncertainty (k = 2) of that: an error this large could have been overlooked.
    stated_mm
        Standard uncertainty of such a step by how stable the rig is stated, or assumed, to be.

    The lengths are NaN where no stripe was found again.
    """

    calibration_id: str
    pictures_id: str
    taken_at: Time
    p: Probability
    poses: tuple[CheckedPicture, ...]
    step_mm: LengthAbove0
    error_mm: OrNan = math.nan
    unseen_mm: OrNan = math.nan
    stated_mm: OrNan = math.nan
    __pydantic_config__ = RESULT

    @property
    def passed(self) -> bool:
        """Whether the check's verdict is passed: its stripes agree with the calibrations."""
        return self.verdict == "passed"

    @property
    def verdict(self) -> CheckVerdict:
        """Verdict on the check, by the probability `p` that chance explains it: passed, doubtful or failed."""
        return "passed" if self.p >= P_TOLD else "doubtful" if self.p >= PROVES_NOTHING else "failed"

    @property
    def used(self) -> int:
        """Number of poses that take part in the check."""
        return sum(pose.used for pose in self.poses)

    @property
    def offset_px(self) -> float:
        """RMS distance in px of the check's stripes from where the calibrations expect them; NaN without stripes."""
        return _rms([line.offset_px for pose in self.poses for line in pose.lines])

    @property
    def offset_mm(self) -> float:
        """RMS distance in mm on the target of the check's stripes from the expected ones; NaN without any."""
        return _rms([line.offset_mm for pose in self.poses for line in pose.lines])

    @property
    def sentence(self) -> Message:
        """Sentence that tells the check's verdict and what to do."""
        values = {"offset_px": self.offset_px, "offset_mm": self.offset_mm, "p": self.p}
        if not self.used:
            return Message(
                "check.fan_is_elsewhere",
                "No stripe is where the calibration has the fan: laser or camera were moved; calibrate again.",
            )
        if self.verdict == "passed":
            return Message(
                "check.passed",
                "In order. A {step_mm:g} mm step may be off by {unseen_mm:.2g} mm.",
                step_mm=self.step_mm,
                unseen_mm=self.unseen_mm,
                **values,
            )
        if self.verdict == "doubtful":
            return Message(
                "check.doubtful",
                "Camera or laser may have changed: the stripes are off by {offset_px:.2f} px, {offset_mm:.3f} mm "
                "(probability that it is chance: {p:.1g}); check again, and calibrate if it stays.",
                **values,
            )
        return Message(
            "check.failed",
            "Camera or laser have changed since they were calibrated: the stripes are off by {offset_px:.2f} px, "
            "{offset_mm:.3f} mm (probability that it is chance: {p:.1g}); calibrate again.",
            **values,
        )


def write_check(path: Path, check: InterimCheck) -> None:
    """Write an interim check as check.json; InputError if it cannot be written."""
    write_json(
        path,
        {
            "calibration_id": check.calibration_id,
            "pictures_id": check.pictures_id,
            "taken_at": check.taken_at.isoformat(),
            "passed": check.passed,
            "verdict": check.verdict,
            "p": check.p,
            "offset_px": check.offset_px,
            "offset_mm": check.offset_mm,
            "step_mm": check.step_mm,
            "error_mm": check.error_mm,
            "unseen_mm": check.unseen_mm,
            "stated_mm": check.stated_mm,
            "sentence": kept(check.sentence),
            "poses": [
                {
                    "name": pose.name,
                    "reason": kept(pose.reason),
                    "lines": [asdict(line) for line in pose.lines],
                }
                for pose in check.poses
            ],
            "version": __version__,
        },
    )


def read_check(path: Path) -> InterimCheck:
    """Read an interim check from check.json; InputError if it is missing, no JSON, or a value is wrong."""
    return checked_json(InterimCheck, read_json(path, todo=_TODO), path)


def _rms(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values else math.nan
