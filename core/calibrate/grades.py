"""Grades of a calibration: good, fair or poor, by limits that are shown beside them.

A limit of what is good is the one that its advice is given by (`core.calibrate.camera.missing`). Less than `POOR_SHARE`
of it is poor: a convention, to tell what lacks a little from what lacks the most of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from core.calibrate.camera.missing import CAMERA_VIEWS, GOOD_TILT, PLANE_POSES

POOR_SHARE = 0.5
"""Share of the limit of what is good below which it is poor: a convention, as said above."""


class Grade(StrEnum):
    """Grade of a quality: good, fair or poor."""

    GOOD = "good"
    FAIR = "fair"
    POOR = "poor"


@dataclass(frozen=True, slots=True)
class Limit:
    """Limit of a grade: from `good` on it is good; less than `POOR_SHARE` of that is poor."""

    good: float

    @property
    def poor(self) -> float:
        """Value below which the grade is poor, a share of `good`."""
        return POOR_SHARE * self.good

    def grade(self, value: float) -> Grade:
        """Grade a value, the larger the better, as good, fair or poor by this limit."""
        if value >= self.good:
            return Grade.GOOD
        return Grade.FAIR if value >= self.poor else Grade.POOR


VIEWS = Limit(CAMERA_VIEWS.enough)
"""Views that a camera is calibrated from."""
POSES = Limit(PLANE_POSES.enough)
"""Poses that light planes are calibrated from."""
TILT = Limit(GOOD_TILT)
"""rad: largest angle between two views."""
