"""Features of a plan and what they gave, in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication

from core.inspect.feature_spec import Kind
from core.report.wording import decision_sentence, grouped, shown_unit, value_line, with_uncertainty
from workbench.pages.inspect_words import Row

if TYPE_CHECKING:
    from core.inspect.characteristic import Characteristic
    from core.inspect.feature_spec import FeatureSpec
    from core.inspect.shown_features import ShownDeviations, ShownFeature

SYMBOLS: dict[Kind, str] = {
    "plane": "mdi6.square-outline",
    "sphere": "mdi6.sphere",
    "cylinder": "mdi6.cylinder",
    "point": "mdi6.crosshairs",
    "thickness": "mdi6.ruler-square",
    "steps": "mdi6.stairs",
    "distance": "mdi6.arrow-expand-horizontal",
    "angle": "mdi6.angle-acute",
    "section": "mdi6.chart-line-variant",
    "deviation": "mdi6.compare",
}

WORST_FIRST = ("not conforming", "not proven", "conforming")


def title(kind: Kind) -> str:
    """What a kind of feature is called in a menu."""
    return {
        "plane": _tr("Plane, flatness"),
        "sphere": _tr("Sphere, diameter"),
        "cylinder": _tr("Cylinder, diameter"),
        "point": _tr("Point"),
        "thickness": _tr("Thickness of two faces"),
        "steps": _tr("Step heights"),
        "distance": _tr("Distance of two features"),
        "angle": _tr("Angle of two features"),
        "section": _tr("Cross-section"),
        "deviation": _tr("Deviation from a nominal surface …"),
    }[kind]


def help_of(kind: Kind) -> str:
    """What a kind of feature measures."""
    return {
        "plane": _tr("A plane fitted to a face: its flatness, and what other features are measured from"),
        "sphere": _tr("A sphere fitted robustly: its diameter and form"),
        "cylinder": _tr("A cylinder fitted robustly: its diameter and form"),
        "point": _tr("The middle of a small region, on the surface: something to measure distances from"),
        "thickness": _tr("The distance of two parallel faces, as the thickness above, with regions of its own"),
        "steps": _tr("The heights of many parallel faces over the lowest or the previous one"),
        "distance": _tr("Point to point, or point to plane, of two features that are in the list"),
        "angle": _tr("Between the planes or axes of two features that are in the list"),
        "section": _tr("A profile across the surface, with heights, distances and radii measured in it"),
        "deviation": _tr("How far the surface lies off a nominal one from an STL file in mm"),
    }[kind]


def source_of_none(spec: FeatureSpec) -> str:
    """What stands for a region that nobody has drawn."""
    if spec.kind in ("section", "deviation"):
        return _tr("the whole scan")
    if spec.kind in ("thickness", "steps") and len(spec.regions) == 1:
        return _tr("found automatically")
    return _tr("by number") if spec.kind in ("plane", "point", "thickness", "steps") else _tr("found")


def value(row: Characteristic) -> str:
    """'50.012 ± 0.024 mm'."""
    unit, factor = shown_unit(row)
    if not math.isfinite(row.U):
        return value_line(row)
    shown, expanded = with_uncertainty(factor * row.value, factor * row.U)
    return f"{shown} ± {expanded} {unit}" if unit != "°" else f"{shown}° ± {expanded}°"


def tip(row: Characteristic) -> str:
    """All about one result: value with k, the decision and why, what was measured."""
    lines = [f"{row.name}: {value_line(row)}"]
    if row.verdict:
        lines.append(decision_sentence(row))
    if row.rule:
        lines.append(_tr("Rule: {0}.").format(row.rule))
    return "\n".join([*lines, *row.notes])


def short_name(row: Characteristic, feature: str) -> str:
    """What a result is called under its feature."""
    return row.name.removeprefix(feature).strip() or row.kind


def verdict(feature: ShownFeature) -> str:
    """The worst of a feature's verdicts; "" where nothing is asked."""
    found = {row.verdict for row in feature.rows}
    return next((one for one in WORST_FIRST if one in found), "")


def result_rows(feature: ShownFeature) -> list[Row]:
    """Each result of a feature with its uncertainty."""
    return [(short_name(row, feature.name), value(row), tip(row), "") for row in feature.rows]


def class_rows(found: ShownDeviations) -> list[Row]:
    """The share of each class of deviations, outwards first."""
    share = _tr("Share of all places compared")
    rows: list[Row] = [(_tr("Deviation [mm]"), _tr("share"), share, "")]
    for one in reversed(found.classes):
        if math.isinf(one.high_mm):
            span = _tr("over {0}").format(f"{one.low_mm:+g}")
        elif math.isinf(one.low_mm):
            span = _tr("under {0}").format(f"{one.high_mm:+g}".replace("-", "−"))
        else:
            span = _tr("{0} to {1}").format(*(f"{end:+g}".replace("-", "−") for end in (one.low_mm, one.high_mm)))
        name = f"{one.mark}  {span}" if one.mark else span
        rows.append((name, f"{100 * one.share:.1f} %", share, ""))
    return rows


def used(feature: ShownFeature) -> str:
    """How many points it rests on."""
    return _tr("{0} points used").format(grouped(feature.used)) if feature.used else ""


def _tr(text: str) -> str:
    return QCoreApplication.translate("Inspect", text)
