"""What the commands print: small calm tables for people, one JSON object for machines."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from core.calibrate.results import (
    CAMERA_PARAMETERS,
    CameraCalibration,
    FanCalibration,
    ProposedReadjustment,
    Readjustment,
)
from core.errors import InputError
from core.files.json_text import to_json
from core.files.results.check_file import InterimCheck
from core.files.results.fan_file import fan_id
from core.files.results.gauge_file import gauge_summary
from core.files.results.profile_file import PictureStep
from core.files.results.rig_history import PastCheck, RigHistory
from core.inspect.results import GaugeResult
from core.messages import ENGLISH, Message, as_json, visible
from core.report.wording import count, decimals_of, fixed, grouped, thickness_line, with_uncertainty
from core.scan.features.frames import NO_REASON
from core.scan.results import FrameRecord
from core.study.artefact_check import ArtefactCheck
from core.study.control_chart import ControlChart

Rows = list[tuple[str, str]]
_NAMES_SHOWN = 3
"""So many frames left out for one reason are named in a line."""

PIPE_WIDTH = 1000
"""Columns in a pipe: lines are not wrapped there."""


def notes_json(notes: Sequence[Message]) -> list[dict[str, Any]]:
    """Notes as ``--json`` has them and result files keep them: code, English text and values."""
    return [as_json(note) for note in notes]


def print_json(values: Mapping[str, Any]) -> None:
    """One JSON object on standard output."""
    sys.stdout.write(to_json(values))


def console() -> Console:
    """Standard output, as wide as a screen or, in a pipe, as its lines."""
    out = Console(highlight=False, markup=False, emoji=False)
    if not out.is_terminal:
        out.width = PIPE_WIDTH
    return out


def print_rows(rows: Rows, notes: Sequence[Message] = (), files: Mapping[str, Path] | None = None) -> None:
    """A table of labels and values, the notes below it, then where the files are."""
    out = console()
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    for label, value in rows:
        table.add_row(label, visible(value))
    if files:
        folder = next(iter(files.values())).parent
        table.add_row("written", f"{folder}: {', '.join(path.name for path in files.values())}")
    if table.rows:
        out.print(table)
    for note in notes:
        out.print(f"note: {visible(str(note))}", soft_wrap=True)


def print_times(seconds: Mapping[str, float], wall_s: float) -> None:
    """On standard error: processor time and share of each stage, and how long all of it took."""
    table = Table("stage", box=None, padding=(0, 2, 0, 0))
    for title in ("processor s", "share"):
        table.add_column(title, justify="right")
    total = sum(seconds.values())
    for name, spent in seconds.items():
        table.add_row(name, f"{spent:.2f}", f"{spent / total:.0%}")
    table.add_row("all", f"{total:.2f}", f"{total / wall_s:.1f} processors busy for {wall_s:.1f} s")
    Console(stderr=True, highlight=False).print(table)


def camera_rows(calibration: CameraCalibration) -> Rows:
    """Parameters with standard deviations, and how well the views fit."""
    camera = calibration.camera
    values = [*camera.matrix[[0, 1, 0, 0, 1], [0, 1, 1, 2, 2]], *camera.distortion]
    rows = [
        (name, " ± ".join(with_uncertainty(float(value), calibration.sd[name])))
        for name, value in zip(CAMERA_PARAMETERS, values, strict=True)
        if calibration.sd[name] > 0
    ]
    return [*rows, ("reprojection", camera_summary(calibration)), ("picture covered", f"{calibration.coverage:.0%}")]


def camera_summary(calibration: CameraCalibration) -> str:
    """The camera in one line."""
    used = sum(view.used for view in calibration.views)
    return (
        f"{calibration.rms_px:.3f} px RMS, {calibration.mean_px:.3f} px mean, "
        f"{used} of {count(len(calibration.views), 'view')}"
    )


def fan_rows(calibration: FanCalibration) -> Rows:
    """Every plane, the angles between them, and whether the pencil suits the laser."""
    rows = []
    for number, (plane, rms) in enumerate(zip(calibration.fan.planes, calibration.rms_mm, strict=True), start=1):
        normal = ", ".join(fixed(float(part), 5) for part in plane.normal)
        rows.append((f"plane {number}", f"normal ({normal}), d {plane.d_mm:.3f} mm, RMS {rms:.3f} mm"))
    if calibration.angles:
        rows.append(("angles", ", ".join(f"{math.degrees(angle):.3f}°" for angle in calibration.angles)))
        free = ", ".join(f"{math.degrees(angle):.3f}°" for angle in calibration.free_angles)
        rows.append(("angles, free fit", free))
    used = sum(pose.used for pose in calibration.poses)
    rows.append(("poses", f"{used} of {count(len(calibration.poses), 'pose')} used"))
    if math.isfinite(calibration.cross_validation_mm):
        rows.append(("poses foretold", f"to {calibration.cross_validation_mm:.3f} mm RMS, each by the others"))
    return [*rows, ("verdict", str(calibration.verdict))] if calibration.verdict else rows


def fan_summary(calibration: FanCalibration) -> str:
    """The fan in one line."""
    used = sum(pose.used for pose in calibration.poses)
    rms = ", ".join(f"{value:.3f}" for value in calibration.rms_mm)
    return f"{rms} mm RMS, {used} of {count(len(calibration.poses), 'pose')}"


def gauge_rows(gauge: GaugeResult) -> Rows:
    """Thickness, deviation, verdict and the faces."""
    rows = [("thickness", thickness_line(gauge))]
    if gauge.nominal_mm is not None and gauge.tolerance_mm is not None and gauge.deviation_mm is not None:
        rows.append(("nominal", f"{gauge.nominal_mm:g} mm ± {gauge.tolerance_mm:g} mm"))
        rows.append(("deviation", f"{fixed(gauge.deviation_mm, decimals_of(gauge.U_mm), signed=True)} mm"))
    rows.append(("verdict", gauge.verdict or "none: rig.toml states no nominal value"))
    upper, lower = gauge.points_used
    flatness = f"{gauge.upper.flatness_mm:.3f} mm above, {gauge.lower.flatness_mm:.3f} mm below (95 % of points)"
    return [
        *rows,
        ("flatness", flatness),
        ("parallelism", f"{math.degrees(gauge.parallelism):.3f}°"),
        ("points on faces", f"{grouped(upper)} above, {grouped(lower)} below"),
    ]


def check_rows(check: InterimCheck) -> Rows:
    """Where the stripes are, and what that does to a step of the part's height."""
    return [
        ("poses", f"{check.used} of {count(len(check.poses), 'pose')} used"),
        ("stripes off by", f"{check.offset_px:.3f} px, {check.offset_mm:.4f} mm (RMS)"),
        ("chance", f"p = {check.p:.2g}"),
        (
            f"a step of {check.step_mm:g} mm",
            f"measured wrong by {check.error_mm:+.3f} mm ± {check.unseen_mm:.3f} mm (k = 2) with this calibration",
        ),
        ("verdict", str(check.sentence)),
    ]


def check_json(check: InterimCheck) -> dict[str, Any]:
    """The same for programs; check.json has it stripe by stripe."""
    return {
        "passed": check.passed,
        "p": check.p,
        "offset_px": check.offset_px,
        "offset_mm": check.offset_mm,
        "step_mm": check.step_mm,
        "error_mm": check.error_mm,
        "unseen_mm": check.unseen_mm,
    }


def readjustment_rows(done: ProposedReadjustment) -> Rows:
    """What was changed, how sure that is, and what it does."""
    parts = zip(("fan turned", "fan moved", "picture moved", "focal length"), _changed_parts(done.record), strict=True)
    return [
        ("poses", f"{done.record.poses} used"),
        *((name, f"{change} ± {sd} {unit} (k = 1)") for name, (change, sd, unit) in parts),
        ("stripes off by", f"{done.offset_px[1]:.3f} px, before {done.offset_px[0]:.3f} px (RMS)"),
        ("chance", f"p = {done.record.p_after:.2g}, before {done.record.p_before:.2g}"),
        (
            f"a step of {done.step_mm:g} mm",
            f"measured {done.correction_mm:+.3f} mm larger, ± {2 * done.u_mm:.3f} mm (k = 2) by camera and fan",
        ),
    ]


def _changed_parts(record: Readjustment) -> list[tuple[str, str, str]]:
    """Change, standard uncertainty and unit of turn, shift, drift and focal length."""
    parts = ((1e6, slice(3), "µrad"), (1e3, slice(3, 6), "µm"), (1.0, slice(6, 8), "px"), (1e6, slice(8, 9), "·10⁻⁶"))
    return [
        (
            ", ".join(f"{by * value:+.3g}" for value in record.change[part]),
            ", ".join(f"{by * value:.3g}" for value in record.sd[part]),
            unit,
        )
        for by, part, unit in parts
    ]


def readjustment_json(done: ProposedReadjustment) -> dict[str, Any]:
    """The same for programs; planes.json has it in full."""
    record = done.record
    return {
        "of": record.of,
        "id": fan_id(done.fan.fan),
        "poses": record.poses,
        "change": record.change.tolist(),
        "sd": record.sd.tolist(),
        "p_before": record.p_before,
        "p_after": record.p_after,
        "offset_px": list(done.offset_px),
        "offset_mm": list(done.offset_mm),
        "step_mm": done.step_mm,
        "correction_mm": done.correction_mm,
        "u_mm": done.u_mm,
    }


def artefact_rows(check: ArtefactCheck) -> Rows:
    """What was measured of an artefact, and how that agrees with its certificate."""
    known = check.artefact
    return [
        ("artefact", " ".join(part for part in (known.id, known.certificate and f"({known.certificate})") if part)),
        ("certified", f"{known.value_mm:.4f} mm ± {known.U_mm:.4f} mm (k = {known.k:g})"),
        ("measured", f"{' ± '.join(with_uncertainty(check.measured_mm, 2 * check.u_mm))} mm (k = 2)"),
        ("E_n", f"{check.e_n:.2f}"),
        ("detects", f"errors from {2 * check.u_error_mm:.3f} mm (k = 2)"),
        ("verdict", str(check.sentence)),
    ]


def artefact_json(check: ArtefactCheck) -> dict[str, Any]:
    """The same for programs."""
    return {
        "artefact": check.artefact.id,
        "verdict": check.verdict,
        "measured_mm": check.measured_mm,
        "u_mm": check.u_mm,
        "certified_mm": check.artefact.value_mm,
        "error_mm": check.error_mm,
        "e_n": check.e_n,
        "unseen_mm": 2 * check.u_error_mm,
    }


def history_rows(history: RigHistory) -> Rows:
    """Each check of a rig: when, what came of it, by how much a step was off, and within which limits."""
    if not history.checks:
        return [("rig", f"{history.name}: never checked on this computer")]
    return [
        ("rig", history.name),
        *((ENGLISH.time(one.taken_at.astimezone()), _past_check(one, history.chart(one))) for one in history.checks),
    ]


def _past_check(check: PastCheck, chart: ControlChart) -> str:
    where = "within" if chart.holds(check.error_mm) else "outside"
    rule = f"by {chart.n} checks before" if chart.own else "by its stated stability"
    warm = "" if check.celsius is None else f", {check.celsius:g} °C"
    by = f"{check.offset_px:.2f} px, {check.offset_mm:.3f} mm, p = {check.p:.2g}"
    if check.artefact:
        by = f"{check.artefact}: E_n = {check.e_n:.2f}"
    return (
        f"{check.verdict}, {by}; "
        f"{check.step_mm:g} mm off by {check.error_mm:+.3f} mm, {where} {chart.lower:+.3f} … {chart.upper:+.3f} mm "
        f"{rule}{warm}"
    )


def past_check_json(check: PastCheck, chart: ControlChart) -> dict[str, Any]:
    """The same for programs."""
    limits = {"lower_mm": chart.lower, "upper_mm": chart.upper, "own": chart.own, "n": chart.n}
    return {**asdict(check), "taken_at": check.taken_at.isoformat(), "limits": limits}


def frame_rows(frames: Sequence[FrameRecord], points: int) -> Rows:
    """How many frames gave points, why others did not, and how many points."""
    reasons: dict[str, list[str]] = {}
    for frame in frames:
        if not frame.used:
            reasons.setdefault(str(frame.reason or NO_REASON), []).append(frame.name)
    used = sum(frame.used for frame in frames)
    rows = [("frames", f"{used} of {count(len(frames), 'frame')} used")]
    for reason, names in reasons.items():
        others = ", …" if len(names) > _NAMES_SHOWN else ""
        rows.append(("", f"{len(names)} left out: {reason} ({', '.join(names[:_NAMES_SHOWN])}{others})"))
    return [*rows, ("points", grouped(points))]


def picture_rows(pictures: Sequence[PictureStep]) -> Rows:
    """The step of each picture of the fan alone, or why it gave none."""
    rows = [("pictures", f"{sum(one.reason is None for one in pictures)} of {count(len(pictures), 'picture')} used")]
    for one in pictures:
        step = f"{one.thickness_mm:.3f} mm, own u {one.own_mm:.3f} mm" if one.reason is None else str(one.reason)
        rows.append(("", f"{one.name}: {step}"))
    return rows


def pictures_json(pictures: Sequence[PictureStep]) -> dict[str, Any]:
    """The same for machines."""
    return {
        "pictures": [
            {"name": one.name, "thickness_mm": one.thickness_mm, "own_mm": one.own_mm, "reason": str(one.reason or "")}
            for one in pictures
        ]
    }


def gauge_json(gauge: GaugeResult | None) -> dict[str, Any]:
    """The result for machines; nulls where no thickness was measured."""
    if gauge is None:
        return {"thickness_mm": None, "verdict": ""}
    return {
        **gauge_summary(gauge),
        "points_on_faces": dict(zip(("upper", "lower"), gauge.points_used, strict=True)),
    }


def frames_json(frames: Sequence[FrameRecord], points: int) -> dict[str, Any]:
    """Frames used and left out, and points, for machines."""
    return {
        "points": points,
        "frames_used": sum(frame.used for frame in frames),
        "frames_left_out": [
            {"name": frame.name, "reason": str(frame.reason or NO_REASON)} for frame in frames if not frame.used
        ],
    }


def camera_json(calibration: CameraCalibration) -> dict[str, Any]:
    """The camera for machines."""
    return {
        "rms_px": calibration.rms_px,
        "mean_px": calibration.mean_px,
        "matrix": calibration.camera.matrix,
        "distortion": calibration.camera.distortion,
        "views_used": sum(view.used for view in calibration.views),
        "views_left_out": [
            {"name": view.name, "reason": str(view.reason or "")} for view in calibration.views if not view.used
        ],
    }


def fan_json(calibration: FanCalibration) -> dict[str, Any]:
    """The fan for machines."""
    return {
        "pi": calibration.fan.pis,
        "rms_mm": calibration.rms_mm,
        "cross_validation_mm": calibration.cross_validation_mm,
        "angles_deg": [math.degrees(angle) for angle in calibration.angles],
        "constraint_suits": calibration.constraint_suits,
        "poses_used": sum(pose.used for pose in calibration.poses),
        "poses_left_out": [
            {"name": pose.name, "reason": str(pose.reason or "")} for pose in calibration.poses if not pose.used
        ],
    }


def files_json(files: Mapping[str, Path]) -> dict[str, str]:
    """Paths as text."""
    return {name: str(path) for name, path in files.items()}


def one_of(chosen: str, known: Sequence[str], where: str) -> str:
    """One of `known`, in any case of letters; nothing stays nothing."""
    by_lower = {one.lower(): one for one in known}
    if chosen and chosen.lower() not in by_lower:
        raise InputError(
            Message("export.no_such_choice", 'there is no "{chosen}"', chosen=chosen),
            where=where,
            todo=Message("advice.choose_among", "choose among {choices}", choices=tuple(known)),
        )
    return by_lower.get(chosen.lower(), "")
