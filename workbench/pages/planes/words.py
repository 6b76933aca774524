"""What the laser planes page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from core.calibrate.fan.left_out import note_on_left_out
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.grades import POSES
from core.calibrate.results import FanCalibration, PlanePose
from workbench.language import joined, named, number, sentence, text_of, tr
from workbench.pages.calibration.words import history_row, used_row
from workbench.pages.words import degrees, mm, px
from workbench.views.colours import Level
from workbench.views.lists.value_rows import ValueRow


def quality_rows(calibration: FanCalibration | None) -> list[ValueRow]:
    """How well the stripes lie on their planes."""
    if calibration is None:
        return []
    rows: list[ValueRow] = [
        (
            tr("Line {line}, RMS", line=line),
            mm(rms),
            tr("Root mean square distance of the points on this line from its plane"),
            "",
        )
        for line, rms in enumerate(calibration.rms_mm, start=1)
    ]
    rows.append(used_row(tr("Poses"), calibration.poses, tr("Poses used, and all there are"), POSES))
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
        named(f"{len(names)} × {reason}", joined(names))
        for reason, names in sorted(reasons.items(), key=lambda entry: -len(entry[1]))
    ]


def verdict_sentence(calibration: FanCalibration | None) -> str:
    """Whether the laser is the pencil it is said to be, as a sentence."""
    verdict = text_of((calibration and calibration.verdict) or "")
    return sentence(verdict) if verdict else ""


def notes(calibration: FanCalibration | None) -> str:
    """What else is to be said of a calibration, a sentence a line; the poses left out are listed by themselves."""
    if calibration is None:
        return ""
    of_poses = note_on_left_out(calibration.poses)
    shown = [note for note in calibration.notes if note != of_poses]
    return "\n".join(text_of(note) if note.is_sentence else sentence(text_of(note)) for note in shown)


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
    angles = zip(calibration.angles, calibration.free_angles, calibration.free.angle_sds, strict=True)
    for line, (held, free, sd) in enumerate(angles, start=1):
        name = tr("Angle {line}–{next}", line=line, next=line + 1)
        text = tr("{held} held, {free} ± {sd} free", held=degrees(held), free=degrees(free), sd=degrees(sd))
        tip = tr("Between neighbouring planes: held to one pencil, and each plane calibrated on its own")
        rows.append((name, text, tip, suits))
    if not math.isnan(calibration.pencil_gap_mm):
        tip = tr("Largest distance of the free planes from those of one pencil, within the work volume")
        rows.append((tr("Off one axis"), mm(calibration.pencil_gap_mm), tip, suits))
    return rows


def pose_sentence(name: str, pose: PlanePose | None, reason: str = "") -> str:
    """What is to be said of one pose."""
    if pose is None:
        return tr("{name}: left out ({reason})", name=name, reason=reason) if reason else name
    if not pose.used:
        reason = text_of(pose.reason or "") or tr("no reason recorded")
        if math.isfinite(pose.rms_mm):
            return tr(
                "{name}: left out ({reason}); its stripes are {rms} off the planes",
                name=name,
                reason=reason,
                rms=mm(pose.rms_mm),
            )
        return tr("{name}: left out ({reason})", name=name, reason=reason)
    seen = sum(len(points) > 0 for points in pose.points)
    return tr(
        "{name}: stripes RMS {rms} from their planes, target RMS {target}, {lines}",
        name=name,
        rms=mm(pose.rms_mm),
        target=px(pose.target_rms_px),
        lines=tr("1 line seen") if seen == 1 else tr("{count} lines seen", count=seen),
    )


def history_rows(entries: tuple[Any, ...], accepted: str) -> list[tuple[str, ...]]:
    """The kept planes: when, RMS of each line, poses, id, camera, whether in use."""
    return [
        history_row(
            entry, accepted, joined(number(rms, ".3f") for rms in entry.rms_mm), f"{entry.used}/{entry.total}",
            entry.id, entry.camera_id,
        )
        for entry in entries
    ]  # fmt: skip
