"""What the camera page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

import math

from core.calibrate.camera.changes import CameraChanges
from core.calibrate.camera.expected_error import ExpectedError
from core.calibrate.camera.views import ViewsJudgement
from core.calibrate.results import CameraCalibration, ViewQuality
from core.report.facts.fact import Fact, heading
from core.report.facts.of_camera import camera_facts, parameter_facts
from core.report.facts.of_kept import CHANGE_HEADS, change_cells
from workbench.language import named, text_of, tr
from workbench.pages.words import mm, px, wording


def facts(calibration: CameraCalibration | None, judgement: ViewsJudgement | None) -> tuple[Fact, ...]:
    """Make the facts (name, value, unit) on the camera calibration; () without one."""
    if calibration is None:
        return ()
    expected = judgement.expected[1] if judgement is not None and judgement.expected else None
    return (*camera_facts(calibration, expected), *parameter_facts(calibration))


def change_rows(changes: CameraChanges | None) -> list[tuple[str, ...]]:
    """Make a table row of each parameter that differs: name, then, now, change, its sd; ▲ if beyond chance."""
    said = wording()
    rows = () if changes is None else change_cells(changes)
    return [
        (
            heading(row[0].column(said)),
            *(fact.parts(said)[0] + ("  ▲" if fact.grade else "") for fact in row),
            *[""] * (len(CHANGE_HEADS) - 1 - len(row)),
        )
        for row in rows
    ]


def view_sentence(name: str, quality: ViewQuality | None) -> str:
    """Make the sentence on one view: its RMS, tilt and corners, or why it is left out."""
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
    """Make the sentence on the expected error at one depth: median and worst, in mm."""
    return tr(
        "Standard uncertainty (k = 1) of where a point at depth {depth} is seen, from the camera's calibration alone: "
        "{median} over half of the picture, {worst} at worst. Where no corner was seen, the camera is extrapolated.",
        depth=mm(expected.depth_mm, 0),
        median=mm(expected.median_mm),
        worst=mm(expected.worst_mm),
    )


def missing_sentence(judgement: ViewsJudgement | None) -> str:
    """Make the sentence on which views to record next, or that they cover enough; "" if not known."""
    if judgement is None:
        return ""
    return "\n".join(map(text_of, judgement.missing)) or tr("Nothing is missing: the views cover enough.")
