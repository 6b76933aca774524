"""Features of a plan and what they gave, in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from core.inspect.conformity import Verdict
from core.inspect.plan.control_frame import control_frames, datum_letters
from core.inspect.plan.feature_kind import FeatureKind
from core.inspect.plan.kinds import kind_of, results_of
from core.report.facts.of_features import characteristic_facts
from core.report.wording import decision_sentence, grouped, name_within, shown_name, value_line
from workbench.language import named, number, text_of, tr
from workbench.pages.words import wording
from workbench.views.control_frames import Frame
from workbench.views.lists.value_rows import ValueRow

if TYPE_CHECKING:
    from core.inspect.characteristic import Characteristic
    from core.inspect.plan.feature_spec import FeatureSpec
    from core.inspect.plan.inspection_plan import InspectionPlan
    from core.inspect.shown.shown_features import ShownDeviations, ShownFeature


def title(kind: FeatureKind) -> str:
    """Return the name of a kind of feature as a menu shows it."""
    return f"{tr(kind.title)} …" if kind.nominal_file else tr(kind.title)


def usual_name(kind: str) -> str:
    """Return the name for new features of a kind in the window's language, without a number."""
    names = {
        "plane": tr("plane"),
        "sphere": tr("sphere"),
        "cylinder": tr("cylinder"),
        "point": tr("point"),
        "thickness": tr("thickness"),
        "steps": tr("steps"),
        "distance": tr("distance"),
        "angle": tr("angle"),
        "parallelism": tr("parallelism"),
        "perpendicularity": tr("perpendicularity"),
        "position": tr("position"),
        "section": tr("section"),
        "deviation": tr("deviation"),
    }
    return names.get(kind, kind)  # a plug-in's own word


def source_of_none(spec: FeatureSpec) -> str:
    """Return the text that stands for a region if none was drawn: which points are used then."""
    kind = kind_of(spec)
    if kind.automatic == "all points":
        return tr("the whole scan")
    if kind.most_regions > 1 and len(spec.regions) == 1:
        return tr("found automatically")
    return tr("by number") if kind.automatic == "numbered" else tr("found")


def value(row: Characteristic) -> str:
    """Write a characteristic's value with its U: '50.012 ± 0.024 mm'."""
    return characteristic_facts(row)[0].text(wording()) if math.isfinite(row.U) else value_line(row, wording())


def tip(row: Characteristic) -> str:
    """Write the tooltip of a result: value with k, verdict and its reason, what was measured."""
    lines = [named(shown_name(row, wording()), value_line(row, wording()))]
    if row.verdict:
        lines.append(decision_sentence(row, wording()))
    if row.rule:
        lines.append(tr("Rule: {rule}.", rule=text_of(row.rule)))
    return "\n".join([*lines, *map(text_of, row.notes)])


def short_name(row: Characteristic, feature: str) -> str:
    """Write the name of a result without the name of its `feature`: "flatness"."""
    return name_within(row, feature, wording())


def verdict(feature: ShownFeature) -> Verdict:
    """Return the worst verdict among a feature's results."""
    return Verdict.worst(row.verdict for row in feature.rows)


def result_rows(feature: ShownFeature) -> list[ValueRow]:
    """Make a row of name, value with U, and tooltip for each result of a feature."""
    return [(short_name(row, feature.name), value(row), tip(row), "") for row in feature.rows]


def class_rows(found: ShownDeviations) -> list[ValueRow]:
    """Make a row for each class of deviations with its share of the surface, the outward classes first."""
    share = tr("Share of all places compared")
    rows: list[ValueRow] = [(tr("Deviation [mm]"), tr("share"), share, "")]
    for one in reversed(found.classes):
        if math.isinf(one.high_mm):
            span = tr("over {low:+g}", low=one.low_mm)
        elif math.isinf(one.low_mm):
            span = tr("under {high:+g}", high=one.high_mm)
        else:
            span = tr("{low:+g} to {high:+g}", low=one.low_mm, high=one.high_mm)
        name = f"{one.mark}  {span}" if one.mark else span
        rows.append((name, f"{number(100 * one.share, '.1f')} %", share, ""))
    return rows


def used(feature: ShownFeature) -> str:
    """Write how many points a feature rests on."""
    return tr("{count} points used", count=grouped(feature.used)) if feature.used else ""


def required_frames(plan: InspectionPlan) -> dict[str, Frame]:
    """Make the feature control frames to draw, by the name of the characteristic that each limits."""
    return {
        name: Frame(one.symbol, (f"{one.round}{wording().general(one.zone_mm)}", *one.datums))
        for name, one in control_frames(plan).items()
    }


def datum_frames(plan: InspectionPlan) -> dict[str, Frame]:
    """Make the framed datum letters to draw, by the name of the feature that is the datum."""
    return {name: Frame(None, (letter,)) for name, letter in datum_letters(plan).items()}


def frames_of(spec: FeatureSpec, plan: InspectionPlan) -> list[Frame]:
    """Make the frames to draw for a feature: its datum letter, if it has one, and its feature control frames."""
    asked, datum = required_frames(plan), datum_frames(plan).get(spec.name)
    own = [asked[name] for result in results_of(spec) if (name := f"{spec.name} {result}") in asked]
    return own if datum is None else [datum, *own]
