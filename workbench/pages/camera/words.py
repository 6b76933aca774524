"""What the camera page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

import math
from typing import Any

from core.calibrate.camera.changes import CameraChanges
from core.calibrate.camera.expected_error import ExpectedError
from core.calibrate.camera.views import ViewsJudgement
from core.calibrate.results import CameraCalibration, ViewQuality
from core.report.facts.fact import Fact
from core.report.facts.of_camera import camera_facts, parameter_fact, parameter_facts
from core.report.wording import decimals_of
from workbench.language import named, number, text_of, tr
from workbench.pages.calibration.words import history_row
from workbench.pages.words import mm, px, wording


def facts(calibration: CameraCalibration | None, judgement: ViewsJudgement | None) -> tuple[Fact, ...]:
    """What is told of the calibration."""
    if calibration is None:
        return ()
    expected = judgement.expected[1] if judgement is not None and judgement.expected else None
    return (*camera_facts(calibration, expected), *parameter_facts(calibration))


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
        fact = parameter_fact(one.name, one.second, one.sd)
        digits = decimals_of(one.sd)
        mark = "  ▲" if one.unlikely else ""
        rows.append(
            (
                fact.column(wording()),
                wording().fixed(one.first, digits),
                wording().fixed(one.second, digits),
                wording().fixed(one.change, digits, signed=True) + mark,
                wording().fixed(one.sd, digits),
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
