"""What the camera page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtCore import QCoreApplication

from core.calibrate.camera_changes import CameraChanges, parameter_values
from core.calibrate.expected_error import ExpectedError
from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration, ViewQuality
from core.calibrate.views_judgement import ViewsJudgement
from workbench.views.colours import Level

Row = tuple[str, str, str, Level]


def quality_rows(calibration: CameraCalibration | None, judgement: ViewsJudgement | None) -> list[Row]:
    """How good the calibration is: label, value with unit, tip, level."""
    if calibration is None:
        return []
    used, total = sum(view.used for view in calibration.views), len(calibration.views)
    rows: list[Row] = [
        (
            _tr("RMS"),
            px(calibration.rms_px),
            _tr("Root mean square distance of the corners from where they should be"),
            "",
        ),
        (_tr("Mean"), px(calibration.mean_px), _tr("Mean distance of the corners from where they should be"), ""),
        (_tr("Views"), _tr("{0} of {1}").format(used, total), _tr("Views used, and all there are"), ""),
        (
            _tr("Coverage"),
            f"{100 * calibration.coverage:.0f} %",
            _tr("Share of the picture where there are corners"),
            "",
        ),
        (
            _tr("Tilts"),
            f"{math.degrees(calibration.tilt_range):.0f}°",
            _tr("Largest angle between the target's planes in two views; 30° and more is good"),
            "",
        ),
    ]
    if not math.isnan(calibration.cross_validation_mm):
        tip = _tr("RMS distance between what cameras from the odd and from the even views see, over the work volume")
        rows.append((_tr("Halves differ"), mm(calibration.cross_validation_mm), tip, ""))
    if judgement is not None and judgement.expected:
        expected = judgement.expected[1]
        tip = _tr("Standard uncertainty (k = 1) of where a point lies, from the camera alone, at depth {0}").format(
            mm(expected.depth_mm, 0)
        )
        text = _tr("{0}, worst {1}").format(mm(expected.median_mm), mm(expected.worst_mm))
        rows.append((_tr("Expected error"), text, tip, ""))
    return rows


def parameter_rows(calibration: CameraCalibration | None) -> list[Row]:
    """The parameters, each ± its standard deviation."""
    if calibration is None:
        return []
    return [
        (label, with_sd(value, calibration.sd[name], unit), f"{tip} (± sd)", "")
        for (name, value) in zip(CAMERA_PARAMETERS, parameter_values(calibration), strict=True)
        for label, unit, tip in [_parameters()[name]]
        if value or calibration.sd[name]
    ]


def change_rows(changes: CameraChanges | None) -> list[tuple[str, ...]]:
    """What is different: parameter, then, now, change, its sd."""
    if changes is None:
        return []
    rows: list[tuple[str, ...]] = [
        (_tr("RMS [px]"), f"{changes.rms_px[0]:.3f}", f"{changes.rms_px[1]:.3f}", "", ""),
        (_tr("Views"), str(changes.views[0]), str(changes.views[1]), "", ""),
    ]
    for one in changes.parameters:
        if not (one.first or one.second):
            continue
        label, unit, _ = _parameters()[one.name]
        digits = _digits(one.sd)
        mark = "  ▲" if one.unlikely else ""
        rows.append(
            (
                f"{label} ({unit})" if unit else label,
                f"{one.first:.{digits}f}",
                f"{one.second:.{digits}f}",
                f"{one.change:+.{digits}f}{mark}",
                f"{one.sd:.{digits}f}",
            )
        )
    return rows


def history_rows(entries: tuple[Any, ...], accepted: str) -> list[tuple[str, ...]]:
    """The kept calibrations: when, RMS, views, id, whether in use."""
    return [
        (
            entry.kept_at.astimezone().strftime("%Y-%m-%d %H:%M"),
            f"{entry.rms_px:.3f}",
            f"{entry.used}/{entry.total}",
            entry.id,
            _tr("in use") if entry.id == accepted else "",
        )
        for entry in entries
    ]


def view_sentence(name: str, quality: ViewQuality | None) -> str:
    """What is to be said of one view."""
    if quality is None:
        return name
    if quality.used:
        left = int((~quality.counted).sum())
        more = _tr(", {0} corners left out").format(left) if left else ""
        return _tr("{0}: RMS {1}, tilt {2}°, {3} corners{4}").format(
            name, px(quality.rms_px), f"{math.degrees(quality.tilt):.0f}", len(quality.view.uv), more
        )
    if math.isnan(quality.rms_px):
        return _tr("{0}: {1}").format(name, quality.reason)
    return _tr("{0}: {1}; RMS {2}").format(name, quality.reason, px(quality.rms_px))


def expected_sentence(expected: ExpectedError) -> str:
    """What the map of expected errors shows."""
    return _tr(
        "Standard uncertainty (k = 1) of where a point at depth {0} is seen, from the camera's calibration alone: "
        "{1} over half of the picture, {2} at worst. Where no corner was seen, the camera is extrapolated."
    ).format(mm(expected.depth_mm, 0), mm(expected.median_mm), mm(expected.worst_mm))


def missing_sentence(judgement: ViewsJudgement | None) -> str:
    """What to record next, or that nothing is missing."""
    if judgement is None:
        return ""
    return "\n".join(judgement.missing) if judgement.missing else _tr("Nothing is missing: the views cover enough.")


def px(value: float) -> str:
    """A length in pixels."""
    return "–" if math.isnan(value) else f"{value:.3f} px"


def mm(value: float, digits: int = 3) -> str:
    """A length in millimetres."""
    return "–" if math.isnan(value) else f"{value:.{digits}f} mm"


def with_sd(value: float, sd: float, unit: str) -> str:
    """A value ± its standard deviation, to two digits of it."""
    text = f"{value:.{_digits(sd)}f}" + (f" ± {sd:.{_digits(sd)}f}" if sd > 0 else "")
    return f"{text} {unit}".strip().replace("-", "−")


def _digits(sd: float) -> int:
    return min(max(1 - math.floor(math.log10(sd)), 0), 8) if sd > 0 else 3


def _parameters() -> dict[str, tuple[str, str, str]]:
    return {
        "alpha": ("α (fx)", "px", _tr("Focal length across")),
        "beta": ("β (fy)", "px", _tr("Focal length down")),
        "gamma": ("γ", "px", _tr("Skew of the pixel's axes")),
        "u0": ("u₀", "px", _tr("Principal point across")),
        "v0": ("v₀", "px", _tr("Principal point down")),
        "k1": ("k₁", "", _tr("Radial distortion")),
        "k2": ("k₂", "", _tr("Radial distortion, fourth power")),
        "p1": ("p₁", "", _tr("Tangential distortion")),
        "p2": ("p₂", "", _tr("Tangential distortion")),
        "k3": ("k₃", "", _tr("Radial distortion, sixth power")),
    }


def _tr(text: str) -> str:
    return QCoreApplication.translate("Camera", text)
