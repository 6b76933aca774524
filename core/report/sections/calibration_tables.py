"""Tables of the calibrations: parameters, light planes, how good they are, and since when they hold."""

from __future__ import annotations

import math

from reportlab.lib.units import mm
from reportlab.platypus import Flowable, Table

from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration, FanCalibration
from core.messages import label, plural_message
from core.report.content import CalibrationMark, ReportContent
from core.report.layout.blocks import heads, ruled_table
from core.report.layout.style import ReportLook
from core.report.wording import decimals_of

SYMBOLS = {
    **{"alpha": "α", "beta": "β", "gamma": "γ ({skew})", "u0": "u₀", "v0": "v₀"},
    **{"k1": "k₁", "k2": "k₂", "p1": "p₁", "p2": "p₂", "k3": "k₃"},
}
UNITS = {"alpha": "px", "beta": "px", "gamma": "px", "u0": "px", "v0": "px"}

KINDS = {"camera": label("Camera"), "fan": label("Fixed laser (fan)")}

HOURS_A_DAY = 24
"""An age is told in days from two days on, else in hours."""


def marks_table(look: ReportLook, content: ReportContent, width: float) -> Table:
    """Id, date, age and hash of every calibration the result rests on."""
    rows: list[list[Flowable]] = [heads(look, "Calibration", "id", "made", "age", "SHA-256 of its file")]
    for mark in content.calibrations:
        made = look.words("not known") if mark.made_at is None else look.words.time(mark.made_at)
        rows.append(
            [
                look.say(KINDS[mark.of], "small"),
                look.text(mark.id, "small"),
                look.text(made, "small"),
                look.text(age_words(look, mark, content), "small"),
                look.text(mark.sha256, "mono"),
            ]
        )
    fixed = [25 * mm, 22 * mm, 25 * mm, 21 * mm]  # an id of twelve wide digits stays in one line
    return ruled_table(rows, [*fixed, width - sum(fixed)])


def age_words(look: ReportLook, mark: CalibrationMark, content: ReportContent) -> str:
    """'3 days', 'under 1 hour', 'not known': how old a calibration was when it was measured with."""
    age = mark.age(content.timestamp)
    if age is None:
        return look.words("not known")
    hours = int(age.total_seconds() // 3600)
    if hours < 1:
        return look.words("under 1 hour")
    if hours >= 2 * HOURS_A_DAY:
        return look.words(plural_message("report.days", "{n:,} day", "{n:,} days", n=hours // HOURS_A_DAY))
    return look.words(plural_message("report.hours", "{n:,} hour", "{n:,} hours", n=hours))


def camera_table(look: ReportLook, calibration: CameraCalibration, width: float) -> Table:
    """The camera's parameters with their standard deviations."""
    camera, words = calibration.camera, look.words
    A = camera.matrix
    values = dict(
        zip(CAMERA_PARAMETERS, [A[0, 0], A[1, 1], A[0, 1], A[0, 2], A[1, 2], *camera.distortion], strict=True)
    )
    known = any(calibration.sd.values())
    rows: list[list[Flowable]] = [heads(look, "Parameter", "value", "standard deviation", numbers=(1, 2))]
    for name in CAMERA_PARAMETERS:
        value, sd = values[name], calibration.sd[name]
        if sd <= 0 and value == 0:
            continue  # a coefficient the model leaves out
        decimals = decimals_of(sd) if sd > 0 else 6
        unit = UNITS.get(name, "")
        label = SYMBOLS.get(name, name).format(skew=words("skew"))
        label = words.in_unit(label, unit) if unit else label
        spread = words.fixed(sd, decimals) if sd > 0 else words("fixed" if known else "unknown")
        rows.append(
            [look.text(label, "small"), look.text(words.fixed(value, decimals), "number"), look.text(spread, "number")]
        )
    return ruled_table(rows, [0.34 * width, 0.28 * width, 0.38 * width])


def camera_facts(look: ReportLook, calibration: CameraCalibration) -> dict[str, str]:
    """How good the camera's calibration is."""
    words = look.words
    used, apart = sum(view.used for view in calibration.views), calibration.cross_validation_mm
    if not calibration.views:
        return {words("Views"): words("calibrated by another program")}
    views = plural_message("report.views", "{n:,} view", "{n:,} views", n=len(calibration.views))
    return {
        words("Views"): words(
            "{n} of {all} used",
            n=used,
            all=words(views),
        ),
        words("Corner error"): words(
            "mean {mean} px, rms {rms} px",
            mean=words.fixed(calibration.mean_px, 3),
            rms=words.fixed(calibration.rms_px, 3),
        ),
        words("Coverage"): words(
            "{share} % of the picture, tilts {tilt}°",
            share=words.fixed(100 * calibration.coverage, 0),
            tilt=words.fixed(math.degrees(calibration.tilt_range), 0),
        ),
        words("Odd/even views"): words("{distance} mm apart over the work volume", distance=words.fixed(apart, 3))
        if math.isfinite(apart)
        else words("too few views"),
    }


def fan_table(look: ReportLook, calibration: FanCalibration, width: float) -> Table:
    """The fan's planes: normal, distance from the camera, fit, and the angle to the next one."""
    fixed = look.words.fixed
    rows: list[list[Flowable]] = [
        heads(look, "Line", "normal (x, y, z)", "d, mm", "rms, mm", "to the next, ° (free fit)", numbers=(2, 3, 4))
    ]
    for index, plane in enumerate(calibration.fan.planes):
        between = ", " if look.words.language.decimal != "," else "; "
        normal = between.join(fixed(float(value), 4) for value in plane.normal)
        angle = ""
        if index < len(calibration.angles):
            angles = (math.degrees(calibration.angles[index]), math.degrees(calibration.free_angles[index]))
            angle = f"{fixed(angles[0], 3)} ({fixed(angles[1], 3)})"
        rms = calibration.rms_mm[index] if index < len(calibration.rms_mm) else math.nan
        numbers = (fixed(plane.d_mm, 2), fixed(rms, 3), angle)
        rows.append(
            [look.text(f"{index + 1}", "small"), look.text(normal, "small"), *(look.text(n, "number") for n in numbers)]
        )
    return ruled_table(rows, [width * share for share in (0.085, 0.395, 0.13, 0.15, 0.24)])


def fan_facts(look: ReportLook, calibration: FanCalibration) -> dict[str, str]:
    """How good the fan's calibration is."""
    words = look.words
    used = sum(pose.used for pose in calibration.poses)
    poses = words(plural_message("report.poses", "{n:,} pose", "{n:,} poses", n=len(calibration.poses)))
    facts = {words("Poses"): words("{n} of {all} of the plane target used", n=used, all=poses)}
    if calibration.constraint_suits is not None:
        gap = words.fixed(calibration.pencil_gap_mm, 3)
        facts[words("Free planes from one pencil")] = words("at most {gap} mm in the work volume", gap=gap)
    if calibration.readjusted is not None:
        facts[words("Re-adjusted")] = words.known(calibration.readjusted.note)
    if calibration.verdict:
        facts[words("Check of the constraint")] = words.known(calibration.verdict)
    return facts
