"""What the laser planes page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QCoreApplication

from core.calibrate.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration, PlanePose
from workbench.views.colours import Level
from workbench.wording import in_the_window

Row = tuple[str, str, str, Level]

_LEFT_OUT = re.compile(r"\d+ of \d+ poses left out")


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
    rows.append((_tr("Poses"), _tr("{0} of {1}").format(used, total), _tr("Poses used, and all there are"), ""))
    if not math.isnan(calibration.stripe_sd_mm):
        tip = _tr("How far a whole stripe is off its plane beyond its own noise: flatness of the plate, the lens")
        off = calibration.stripe_sd_mm
        rows.append((_tr("Stripes beyond noise"), mm(off) if off >= 0.0005 else _tr("below 0.001 mm"), tip, ""))
    return rows


def left_out_lines(poses: Sequence[PlanePose | PoseFeatures]) -> list[str]:
    """Which poses do not count and why, one line a reason: how many first, then their names."""
    reasons: dict[str, list[str]] = {}
    for pose in poses:
        if pose.reason:
            reasons.setdefault(pose.reason, []).append(pose.name)
    return [
        _tr("{0} × {1}: {2}").format(len(names), in_the_window(reason), ", ".join(names))
        for reason, names in sorted(reasons.items(), key=lambda entry: -len(entry[1]))
    ]


def verdict_sentence(calibration: FanCalibration | None) -> str:
    """Whether the laser is the pencil it is said to be, as a sentence."""
    verdict = calibration.verdict if calibration is not None else ""
    return f"{verdict[:1].upper()}{verdict[1:]}." if verdict else ""


def notes(calibration: FanCalibration | None) -> str:
    """What else is to be said of a calibration, a sentence a line; the poses left out are listed by themselves."""
    if calibration is None:
        return ""
    said = [in_the_window(note) for note in calibration.notes if not _LEFT_OUT.match(note)]
    return "\n".join(f"{note[:1].upper()}{note[1:]}." if note[-1:] != "." else note for note in said)


def short_names(names: Sequence[str]) -> list[str]:
    """Only the numbers of names that differ by nothing else, for where there is little room: 00 for pose00."""
    words = {name.rstrip("0123456789") for name in names}
    numbered = len(words) == 1 and not words & set(names)
    return [name.removeprefix(*words) for name in names] if numbered else list(names)


def angle_rows(calibration: FanCalibration | None) -> list[Row]:
    """The angles between neighbouring planes, held to one pencil and free."""
    if calibration is None or not calibration.free_angles:
        return []
    suits: Level = "" if calibration.constraint_suits is None else "good" if calibration.constraint_suits else "warn"
    rows: list[Row] = []
    for line, (held, free) in enumerate(zip(calibration.angles, calibration.free_angles, strict=True), start=1):
        name = _tr("Angle {0}–{1}").format(line, line + 1)
        text = _tr("{0} held, {1} free").format(degrees(held), degrees(free))
        tip = _tr("Between neighbouring planes: held to one pencil, and each plane calibrated on its own")
        rows.append((name, text, tip, suits))
    if not math.isnan(calibration.pencil_gap_mm):
        tip = _tr("Largest distance of the free planes from those of one pencil, within the work volume")
        rows.append((_tr("Off one pencil"), mm(calibration.pencil_gap_mm), tip, suits))
    return rows


def pose_sentence(name: str, pose: PlanePose | None, reason: str = "") -> str:
    """What is to be said of one pose."""
    if pose is None:
        return _tr("{0}: left out ({1})").format(name, in_the_window(reason)) if reason else name
    seen = sum(len(points) > 0 for points in pose.points)
    lines = _tr("1 line seen") if seen == 1 else _tr("{0} lines seen").format(seen)
    figures = _tr("stripes RMS {0} from their planes, target RMS {1}, {2}").format(
        mm(pose.rms_mm), px(pose.target_rms_px), lines
    )
    if pose.used:
        return _tr("{0}: {1}").format(name, figures)
    return _tr("{0}: left out ({1})").format(name, in_the_window(pose.reason) or _tr("no reason recorded"))


def history_rows(entries: tuple[Any, ...], accepted: str) -> list[tuple[str, ...]]:
    """The kept planes: when, RMS of each line, poses, id, camera, whether in use."""
    return [
        (
            entry.kept_at.astimezone().strftime("%Y-%m-%d %H:%M"),
            ", ".join(f"{rms:.3f}" for rms in entry.rms_mm),
            f"{entry.used}/{entry.total}",
            entry.id,
            entry.camera_id,
            _tr("in use") if entry.id == accepted else "",
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
