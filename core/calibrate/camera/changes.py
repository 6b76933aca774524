"""Comparison of two calibrations of one camera."""

from __future__ import annotations

import math
from dataclasses import dataclass

from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration
from core.progress import Progress, silent

UNLIKELY = 3.0
"""Standard deviations beyond which chance alone hardly explains a change: 0.3 %."""


@dataclass(frozen=True, slots=True)
class ParameterChange:
    """Change of one parameter between two calibrations.

    `change` is second − first, `sd` the standard deviation to expect of it, the calibrations being of different views;
    `unlikely` if it is more than three of them.
    """

    name: str
    first: float
    second: float
    change: float
    sd: float

    @property
    def unlikely(self) -> bool:
        """Whether the parameter has changed by more than three of the standard deviations to be expected."""
        return abs(self.change) > UNLIKELY * self.sd > 0


@dataclass(frozen=True, eq=False, slots=True)
class CameraChanges:
    """Differences between two calibrations: parameters, RMS in px, and how many views were used."""

    parameters: tuple[ParameterChange, ...]
    rms_px: tuple[float, float]
    views: tuple[int, int]


def camera_changes(first: CameraCalibration, second: CameraCalibration, progress: Progress = silent) -> CameraChanges:
    """Compare two calibrations of a camera: each parameter, the RMS residuals and the views used."""
    progress("comparing", 0, 1)
    values, sds = [parameter_values(one) for one in (first, second)], [first.sd, second.sd]
    return CameraChanges(
        tuple(
            ParameterChange(name, a, b, b - a, math.hypot(sds[0][name], sds[1][name]))
            for name, a, b in zip(CAMERA_PARAMETERS, *values, strict=True)
        ),
        (first.rms_px, second.rms_px),
        (_used(first), _used(second)),
    )


def parameter_values(calibration: CameraCalibration) -> tuple[float, ...]:
    """List the values of the camera's parameters in the order of CAMERA_PARAMETERS."""
    matrix, distortion = calibration.camera.matrix, calibration.camera.distortion
    values = [matrix[0, 0], matrix[1, 1], matrix[0, 1], matrix[0, 2], matrix[1, 2], *distortion]
    return tuple(float(value) for value in values)


def _used(calibration: CameraCalibration) -> int:
    return sum(view.used for view in calibration.views)
