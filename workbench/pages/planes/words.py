"""What the laser planes page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from core.calibrate.fan.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration, PlanePose
from workbench.language import text_of, tr
from workbench.views.colours import Level
from workbench.views.lists.value_rows import ValueRow


def quality_rows(calibration: FanCalibration | None) -> list[ValueRow]:
    """How well the stripes lie on their planes."""
    if calibration is None:
        return []
    used, total = sum(pose.used for pose in calibration.poses), len(calibration.poses)
    rows: list[ValueRow] = [
        (
            tr("Line {0}, RMS").format(line),
            mm(rms),
            tr("Root mean square distance of the points on this line from its plane"),
            "",
        )
        for line, rms in enumerate(calibration.rms_mm, start=1)
    ]
    rows.append((tr("Poses"), tr("{0} of {1}").format(used, total), tr("Poses used, and all there are"), ""))
    if not math.isnan(calibration.stripe_sd_mm):
        tip = tr("How far a whole stripe is off its plane beyond its own noise: flatness of the plate, the lens")
        off = calibration.stripe_sd_mm
        rows.append((tr("Stripes beyond noise"), mm(off) if off >= 0.0005 else tr("below 0.001 mm"), tip, ""))
    return rows


def left_out_lines(poses: Sequence[PlanePose | PoseFeatures]) -> list[str]:
    """Which poses do not count and why, one line a reason: how many first, then their names."""
    reasons: dict[str, list[str]] = {}
    for pose in poses:
        if pose.reason:
            reasons.setdefault(text_of(pose.reason), []).append(pose.name)
    return [
        tr("{0} × {1}: {2}").format(len(names), text_of(reason), ", ".join(names))
        for reason, names in sorted(reasons.items(), key=lambda entry: -len(entry[1]))
    ]


def verdict_sentence(calibration: FanCalibration | None) -> str:
    """Whether the laser is the pencil it is said to be, as a sentence."""
    verdict = text_of((calibration and calibration.verdict) or "")
    return f"{verdict[:1].upper()}{verdict[1:]}." if verdict else ""


def notes(calibration: FanCalibration | None) -> str:
    """What else is to be said of a calibration, a sentence a line; the poses left out are listed by themselves."""
    if calibration is None:
        return ""
    said = [text_of(note) for note in calibration.notes if note.code != "fan.poses_left_out"]
    return "\n".join(f"{note[:1].upper()}{note[1:]}." if note[-1:] != "." else note for note in said)


def short_names(names: Sequence[str]) -> list[str]:
    """Only the numbers of names that differ by nothing else, for where there is little room: 00 for pose00."""
    words = {name.rstrip("0123456789") for name in names}
    numbered = len(words) == 1 and not words & set(names)
    return [name.removeprefix(*words) for name in names] if numbered else list(names)


def angle_rows(calibration: FanCalibration | None) -> list[ValueRow]:
    """The angles between neighbouring planes, held to one pencil and free."""
    if calibration is None or not calibration.free_angles:
        return []
    suits: Level = "" if calibration.constraint_suits is None else "good" if calibration.constraint_suits else "warn"
    rows: list[ValueRow] = []
    for line, (held, free) in enumerate(zip(calibration.angles, calibration.free_angles, strict=True), start=1):
        name = tr("Angle {0}–{1}").format(line, line + 1)
        text = tr("{0} held, {1} free").format(degrees(held), degrees(free))
        tip = tr("Between neighbouring planes: held to one pencil, and each plane calibrated on its own")
        rows.append((name, text, tip, suits))
    if not math.isnan(calibration.pencil_gap_mm):
        tip = tr("Largest distance of the free planes from those of one pencil, within the work volume")
        rows.append((tr("Off one pencil"), mm(calibration.pencil_gap_mm), tip, suits))
    return rows


def pose_sentence(name: str, pose: PlanePose | None, reason: str = "") -> str:
    """What is to be said of one pose."""
    if pose is None:
        return tr("{0}: left out ({1})").format(name, text_of(reason)) if reason else name
    seen = sum(len(points) > 0 for points in pose.points)
    lines = tr("1 line seen") if seen == 1 else tr("{0} lines seen").format(seen)
    figures = tr("stripes RMS {0} from their planes, target RMS {1}, {2}").format(
        mm(pose.rms_mm), px(pose.target_rms_px), lines
    )
    if pose.used:
        return tr("{0}: {1}").format(name, figures)
    return tr("{0}: left out ({1})").format(name, text_of(pose.reason or "") or tr("no reason recorded"))


def history_rows(entries: tuple[Any, ...], accepted: str) -> list[tuple[str, ...]]:
    """The kept planes: when, RMS of each line, poses, id, camera, whether in use."""
    return [
        (
            entry.kept_at.astimezone().strftime("%Y-%m-%d %H:%M"),
            ", ".join(f"{rms:.3f}" for rms in entry.rms_mm),
            f"{entry.used}/{entry.total}",
            entry.id,
            entry.camera_id,
            tr("in use") if entry.id == accepted else "",
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
