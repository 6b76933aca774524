"""What the camera page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

import math
from typing import Any

from core.calibrate.camera.changes import CameraChanges, parameter_values
from core.calibrate.camera.expected_error import ExpectedError
from core.calibrate.camera.views import ViewsJudgement
from core.calibrate.grades import TILT, VIEWS
from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration, ViewQuality
from workbench.language import named, number, text_of, tr
from workbench.pages.calibration.words import graded_row, history_row, used_row
from workbench.pages.words import degrees, mm, percent, px
from workbench.views.lists.value_rows import ValueRow


def quality_rows(calibration: CameraCalibration | None, judgement: ViewsJudgement | None) -> list[ValueRow]:
    """How good the calibration is: label, value with unit, tip, level."""
    if calibration is None:
        return []
    rows: list[ValueRow] = [
        (
            tr("RMS"),
            px(calibration.rms_px),
            tr(
                "Root mean square distance of the corners from where they should be; on the mean {mean}",
                mean=px(calibration.mean_px),
            ),
            "",
        ),
        used_row(tr("Views"), calibration.views, tr("Views used, and all there are"), VIEWS),
        (
            tr("Coverage"),
            percent(calibration.coverage),
            tr("Share of the picture where there are corners"),
            "",
        ),
        graded_row(
            tr("Tilts"),
            degrees(calibration.tilt_range, 0),
            tr("Largest angle between the target's planes in two views"),
            calibration.tilt_range,
            TILT,
            (degrees(TILT.good, 0), degrees(TILT.poor, 0)),
        ),
    ]
    if judgement is not None and judgement.expected:
        expected = judgement.expected[1]
        tip = tr(
            "Standard uncertainty (k = 1) of where a point lies, from the camera alone, at depth {depth}",
            depth=mm(expected.depth_mm, 0),
        )
        if not math.isnan(calibration.cross_validation_mm):
            tip += "\n" + tr(
                "Cameras from the odd and from the even views differ by {distance} RMS over the work volume",
                distance=mm(calibration.cross_validation_mm),
            )
        text = tr("{median}, worst {worst}", median=mm(expected.median_mm), worst=mm(expected.worst_mm))
        rows.append((tr("Expected error"), text, tip, ""))
    return rows


def parameter_rows(calibration: CameraCalibration | None) -> list[ValueRow]:
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
        (tr("RMS [px]"), number(changes.rms_px[0], ".3f"), number(changes.rms_px[1], ".3f"), "", ""),
        (tr("Views"), str(changes.views[0]), str(changes.views[1]), "", ""),
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
                number(one.first, f".{digits}f"),
                number(one.second, f".{digits}f"),
                number(one.change, f"+.{digits}f") + mark,
                number(one.sd, f".{digits}f"),
            )
        )
    return rows


def history_rows(entries: tuple[Any, ...], accepted: str) -> list[tuple[str, ...]]:
    """The kept calibrations: when, RMS, views, id, whether in use."""
    return [
        history_row(entry, accepted, number(entry.rms_px, ".3f"), f"{entry.used}/{entry.total}", entry.id)
        for entry in entries
    ]


def view_sentence(name: str, quality: ViewQuality | None) -> str:
    """What is to be said of one view."""
    if quality is None:
        return name
    if quality.used:
        left = int((~quality.counted).sum())
        return tr(
            "{name}: RMS {rms}, tilt {tilt:.0f}°, {count} corners{more}",
            name=name,
            rms=px(quality.rms_px),
            tilt=math.degrees(quality.tilt),
            count=len(quality.view.uv),
            more=tr(", {count} corners left out", count=left) if left else "",
        )
    reason = text_of(quality.reason or "")
    if math.isnan(quality.rms_px):
        return named(name, reason)
    return tr("{name}: {reason}; RMS {rms}", name=name, reason=reason, rms=px(quality.rms_px))


def expected_sentence(expected: ExpectedError) -> str:
    """What the map of expected errors shows."""
    return tr(
        "Standard uncertainty (k = 1) of where a point at depth {depth} is seen, from the camera's calibration alone: "
        "{median} over half of the picture, {worst} at worst. Where no corner was seen, the camera is extrapolated.",
        depth=mm(expected.depth_mm, 0),
        median=mm(expected.median_mm),
        worst=mm(expected.worst_mm),
    )


def missing_sentence(judgement: ViewsJudgement | None) -> str:
    """What to record next, or that nothing is missing."""
    if judgement is None:
        return ""
    return "\n".join(map(text_of, judgement.missing)) or tr("Nothing is missing: the views cover enough.")


def with_sd(value: float, sd: float, unit: str) -> str:
    """A value ± its standard deviation, to two digits of it."""
    spec = f".{_digits(sd)}f"
    text = number(value, spec) + (f" ± {number(sd, spec)}" if sd > 0 else "")
    return f"{text} {unit}".strip()


def _digits(sd: float) -> int:
    return min(max(1 - math.floor(math.log10(sd)), 0), 8) if sd > 0 else 3


def _parameters() -> dict[str, tuple[str, str, str]]:
    return {
        "alpha": ("α (fx)", "px", tr("Focal length across")),
        "beta": ("β (fy)", "px", tr("Focal length down")),
        "gamma": ("γ", "px", tr("Skew of the pixel's axes")),
        "u0": ("u₀", "px", tr("Principal point across")),
        "v0": ("v₀", "px", tr("Principal point down")),
        "k1": ("k₁", "", tr("Radial distortion")),
        "k2": ("k₂", "", tr("Radial distortion, fourth power")),
        "p1": ("p₁", "", tr("Tangential distortion")),
        "p2": ("p₂", "", tr("Tangential distortion")),
        "k3": ("k₃", "", tr("Radial distortion, sixth power")),
    }
