"""What is told of the fan's light planes: how well the stripes lie on them, and whether they are one pencil."""

from __future__ import annotations

import math
from itertools import chain

import numpy as np

from core.calibrate.grades import POSES
from core.calibrate.results import FanCalibration, PlanePose
from core.messages import Message, decimals_of, label, plural_message
from core.report.facts.fact import Fact, Grade, Reader, named
from core.report.facts.pictures import used_fact
from core.scan.features.frames import NO_REASON

_HELD = 1e-9
"""Standard deviation in rad below which an angle is not fitted but held to what is stated."""


def planes_facts(calibration: FanCalibration) -> tuple[Fact, ...]:
    """Make the facts on the fan's calibration: each plane's fit, normal, distance and angle, then all together."""
    lines = (named(line_name(n), cells) for n, cells in enumerate(plane_cells(calibration), start=1))
    return (*chain(*lines), *rest_of_planes(calibration))


def rest_of_planes(calibration: FanCalibration) -> tuple[Fact, ...]:
    """Make the facts on the fan's calibration as a whole: poses used, and how well the planes form one pencil."""
    facts = [used_fact(label("poses"), calibration.poses, label("Poses used, and all there are"), POSES)]
    if math.isfinite(calibration.pencil_gap_mm):
        tip = label("Largest distance of the free planes from those of one pencil, within the work volume")
        facts.append(
            Fact(
                label("off one axis"), calibration.pencil_gap_mm, "mm", decimals_of(calibration.pencil_gap_sd_mm), tip,
                Reader.AUDITOR, grade=_suits(calibration),
            )
        )  # fmt: skip
    if math.isfinite(calibration.cross_validation_mm):
        tip = label("RMS distance of the stripes of each pose from the planes that the other poses give")
        facts.append(Fact(label("poses predicted to"), calibration.cross_validation_mm, "mm", 3, tip, Reader.AUDITOR))
    if math.isfinite(calibration.stripe_sd_mm):
        tip = label("How far a whole stripe is off its plane beyond its own noise: flatness of the plate, the lens")
        off = calibration.stripe_sd_mm
        facts.append(
            Fact(
                label("stripes beyond noise"), off, "mm", 3, tip, Reader.METROLOGIST, above_zero=True,
            )
        )  # fmt: skip
    return tuple(facts)


def line_name(number: int) -> Message:
    """Return the name of the fan's laser line number `number`, from 1, and of its light plane."""
    return Message("told.line", "line {number}", number=number)


def plane_cells(calibration: FanCalibration) -> tuple[tuple[Fact, ...], ...]:
    """Make the table rows of the light planes, one each: fit, normal, distance, and the angle to the next plane."""
    about = label("Root mean square distance of the points on this line from its plane")
    held = label("Angle between neighbouring planes that are held to one pencil")
    free = label("The same where each plane is calibrated on its own, with its standard uncertainty u")
    sds = calibration.free.angle_sds if calibration.free.has_covariance else ()
    fan = calibration.fan
    of_d, of_kept = (fan.distance_sds, fan.angle_sds) if fan.has_covariance else ((), ())
    held_used = not np.array_equal(fan.pis, calibration.free.pis)
    rows: list[tuple[Fact, ...]] = []
    for place, plane in enumerate(calibration.fan.planes):
        rms = calibration.rms_mm[place] if place < len(calibration.rms_mm) else math.nan
        x, y, z = (float(part) for part in plane.normal)
        normal = Message("told.normal", "{x:.4f}; {y:.4f}; {z:.4f}", x=x, y=y, z=z)
        row = [
            Fact(label("RMS"), rms, "mm", 3, about),
            Fact(label("normal (x, y, z)"), normal, tip=label("As the camera sees it"), level=Reader.AUDITOR),
            Fact(
                label("d"), plane.d_mm, "mm", decimals_of(of_d[place]) if of_d else 2,
                label("Distance of the plane from the camera"), Reader.AUDITOR,
            ),
        ]  # fmt: skip
        if place < len(calibration.free_angles):
            angle, sd = calibration.free_angles[place], sds[place] if sds else None
            if place < len(calibration.angles):
                kept = math.degrees(calibration.angles[place])
                digits = (_angle_digits(of_kept[place]) if held_used else None) if of_kept else 3
                row.append(
                    Fact(label("to the next"), kept, "°", digits, held, Reader.AUDITOR, grade=_suits(calibration))
                )
            row.append(
                Fact(
                    label("to the next, free"), math.degrees(angle), "°", 3, free, Reader.AUDITOR,
                    sd=None if sd is None else math.degrees(sd),
                )
            )  # fmt: skip
        rows.append(tuple(row))
    return tuple(rows)


def _angle_digits(sd: float) -> int | None:
    """Decimals of an angle in degrees with this standard deviation in rad; of one that is held, as it was stated."""
    return None if sd < _HELD else decimals_of(math.degrees(sd))


def planes_sentences(calibration: FanCalibration) -> tuple[Message, ...]:
    """Make the sentences on whether the planes form the stated pencil, and on a re-adjustment if there was one."""
    verdict = calibration.verdict
    moved = () if calibration.readjusted is None else (calibration.readjusted.note,)
    return (*(() if verdict is None else (Message("told.sentence", "{what:capital}.", what=verdict),)), *moved)


def sentence_on_pose(pose: PlanePose) -> Message:
    """Make the sentence on how well a pose of the plane target fits, and how many laser lines are seen in it.

    Of a pose that is left out: why, and how far off it is.
    """
    if pose.used:
        return plural_message(
            "told.pose",
            "{name}: stripes RMS {rms_mm:.3f} mm from their planes, target RMS {target_px:.3f} px, {n} line seen",
            "{name}: stripes RMS {rms_mm:.3f} mm from their planes, target RMS {target_px:.3f} px, {n} lines seen",
            n=sum(len(points) > 0 for points in pose.points),
            name=pose.name, rms_mm=pose.rms_mm, target_px=pose.target_rms_px,
        )  # fmt: skip
    left_out = Message("told.pose_left_out", "{name}: left out ({reason})", name=pose.name,
                       reason=pose.reason or NO_REASON)  # fmt: skip
    if not math.isfinite(pose.rms_mm):
        return left_out
    return Message(
        "told.pose_off", "{left_out}; its stripes are {rms_mm:.3f} mm off the planes",
        left_out=left_out, rms_mm=pose.rms_mm,
    )  # fmt: skip


def _suits(calibration: FanCalibration) -> Grade:
    if calibration.constraint_suits is None:
        return ""
    return "good" if calibration.constraint_suits else "warn"
