"""What the laser planes page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtCore import QCoreApplication

from core.calibrate.results import FanCalibration, PlanePose
from workbench.views.colours import Level

Row = tuple[str, str, str, Level]


def quality_rows(calibration: FanCalibration | None) -> list[Row]:
    """How well the stripes lie on their planes."""
    if calibration is None:
        return []
    used, total = sum(pose.used for pose in calibration.poses), len(calibration.poses)
    rows: list[Row] = [
        (
            _tr("Line {0}, RMS").format(line),
            mm(rms),
            _tr("Root mean square distance of the points on this line from its plane"),
            "",
        )
        for line, rms in enumerate(calibration.rms_mm, start=1)
    ]
    rows.append((_tr("Poses"), _tr("{0} of {1} count").format(used, total), _tr("Poses used, and all there are"), ""))
    if not math.isnan(calibration.stripe_sd_mm):
        tip = _tr("How far a whole stripe is off its plane beyond its own noise: flatness of the plate, the lens")
        rows.append((_tr("Stripes, sd"), mm(calibration.stripe_sd_mm), tip, ""))
    return rows


def angle_rows(calibration: FanCalibration | None) -> list[Row]:
    """The angles between neighbouring planes, held to one pencil and free."""
    if calibration is None or not calibration.free_angles:
        return []
    suits: Level = "" if calibration.constraint_suits is None else "good" if calibration.constraint_suits else "warn"
    rows: list[Row] = []
    for line, (held, free) in enumerate(zip(calibration.angles, calibration.free_angles, strict=True), start=1):
        name = _tr("Angle {0}–{1}").format(line, line + 1)
        text = _tr("{0} held, {1} free").format(degrees(held), degrees(free))
        rows.append((name, text, _tr("Between neighbouring planes: as calibrated, and each plane on its own"), suits))
    if not math.isnan(calibration.pencil_gap_mm):
        tip = _tr("Largest distance of the free planes from those of one pencil, within the work volume")
        rows.append((_tr("Off one pencil"), mm(calibration.pencil_gap_mm), tip, suits))
    return rows


def pose_sentence(name: str, pose: PlanePose | None, reason: str = "") -> str:
    """What is to be said of one pose."""
    if pose is None:
        return _tr("{0}: {1}").format(name, reason) if reason else name
    seen = sum(len(points) > 0 for points in pose.points)
    figures = _tr("stripes RMS {0} from their planes, target RMS {1}, {2} lines seen").format(
        mm(pose.rms_mm), px(pose.target_rms_px), seen
    )
    if pose.used:
        return _tr("{0}: {1}").format(name, figures)
    return _tr("{0}: left out ({1})").format(name, pose.reason or _tr("no reason recorded"))


def history_rows(entries: tuple[Any, ...], accepted: str) -> list[tuple[str, ...]]:
    """The kept planes: when, RMS of each line, poses, id, camera, whether accepted."""
    return [
        (
            entry.kept_at.astimezone().strftime("%Y-%m-%d %H:%M"),
            ", ".join(f"{rms:.3f}" for rms in entry.rms_mm),
            f"{entry.used}/{entry.total}",
            entry.id,
            entry.camera_id,
            _tr("accepted") if entry.id == accepted else "",
        )
        for entry in entries
    ]


def mm(value: float, digits: int = 3) -> str:
    """A length in millimetres."""
    return "–" if math.isnan(value) else f"{value:.{digits}f} mm"


def px(value: float) -> str:
    """A length in pixels."""
    return "–" if math.isnan(value) else f"{value:.3f} px"


def degrees(value: float) -> str:
    """An angle, given in rad."""
    return f"{math.degrees(value):.3f}°"


def _tr(text: str) -> str:
    return QCoreApplication.translate("Planes", text)
