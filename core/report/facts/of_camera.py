"""What is told of a calibrated camera: how it fits, what its views cover, and its parameters."""

from __future__ import annotations

import math

from core.calibrate.camera.changes import parameter_values
from core.calibrate.camera.expected_error import ExpectedError
from core.calibrate.grades import TILT, VIEWS
from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration
from core.messages import Message, decimals_of, label
from core.report.facts.fact import Fact, Reader
from core.report.facts.pictures import grade, limits_tip, used_fact

PARAMETERS = {
    "alpha": ("α (fx)", "px", label("Focal length across")),
    "beta": ("β (fy)", "px", label("Focal length down")),
    "gamma": (label("γ (skew)"), "px", label("Skew of the pixel's axes")),
    "u0": ("u₀", "px", label("Principal point across")),
    "v0": ("v₀", "px", label("Principal point down")),
    "k1": ("k₁", "", label("Radial distortion")),
    "k2": ("k₂", "", label("Radial distortion, fourth power")),
    "p1": ("p₁", "", label("Tangential distortion")),
    "p2": ("p₂", "", label("Tangential distortion")),
    "k3": ("k₃", "", label("Radial distortion, sixth power")),
}
"""Symbol, unit and meaning of each parameter."""


CORNERS = label("corners off by")
"""What the RMS of a camera's reprojection is called."""


def camera_facts(calibration: CameraCalibration, expected: ExpectedError | None = None) -> tuple[Fact, ...]:
    """Make the facts on a camera calibration; `expected` is the error at the middle depth of its views, if known."""
    if not calibration.views:
        return (Fact(label("views"), label("calibrated by another program")),)
    tilt = math.degrees(calibration.tilt_range)
    facts = [
        Fact(
            CORNERS, calibration.rms_px, "px", 3,
            Message(
                "told.tip_corners",
                "Root mean square distance of the corners from where they should be; on the mean {mean_px:.3f} px",
                mean_px=calibration.mean_px,
            ),
        ),
        used_fact(label("views"), calibration.views, label("Views used, and all there are"), VIEWS),
        Fact(
            label("picture covered"), 100 * calibration.coverage, "%", 0,
            label("Share of the picture where there are corners"),
        ),
        Fact(
            label("tilts"), tilt, "°", 0,
            limits_tip(
                label("Largest angle between the target's planes in two views"),
                math.degrees(TILT.good), math.degrees(TILT.poor), "°",
            ),
            grade=grade(TILT, calibration.tilt_range),
        ),
    ]  # fmt: skip
    if expected is not None:
        tip = Message(
            "told.tip_expected",
            "Standard uncertainty (k = 1) of where a point lies, from the camera alone, at depth {depth_mm:.0f} mm: "
            "half of the picture is below this, the worst is {worst_mm:.3f} mm",
            depth_mm=expected.depth_mm,
            worst_mm=expected.worst_mm,
        )
        facts.append(Fact(label("expected error"), expected.median_mm, "mm", 3, tip))
    apart = calibration.cross_validation_mm
    tip_apart = label("RMS distance over the work volume between the cameras from the odd and from the even views")
    few = label("too few views")
    facts.append(
        Fact(label("halves differ by"), apart if math.isfinite(apart) else few, "mm", 3, tip_apart, Reader.AUDITOR)
    )
    return tuple(facts)


def parameter_facts(calibration: CameraCalibration) -> tuple[Fact, ...]:
    """Make the facts on the camera's parameters with their standard deviations; parameters fixed at 0 are left out."""
    values = zip(CAMERA_PARAMETERS, parameter_values(calibration), strict=True)
    return tuple(
        parameter_fact(name, value, calibration.sd[name]) for name, value in values if value or calibration.sd[name]
    )


def parameter_fact(name: str, value: float, sd: float) -> Fact:
    """Make the fact on the camera parameter `name`; `sd` is its standard deviation, 0 if it has none."""
    symbol, unit, tip = PARAMETERS[name]
    digits, spread = (decimals_of(sd), sd) if sd > 0 else (None, None)
    about = Message("told.tip_parameter", "{what}, with its standard uncertainty u", what=tip)
    return Fact(symbol, value, unit, digits, about, Reader.AUDITOR, sd=spread)
