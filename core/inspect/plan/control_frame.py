"""What a plan asks of features' form and lie, as feature control frames and datum letters.

References
----------
ISO 1101:2017, Geometrical tolerancing, 8.1 and annex C. ISO 5459:2011, Datums and datum systems, 7.2 (letters).
ISO 7083:2021, Symbols for geometrical tolerancing, proportions and dimensions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from core.inspect.plan.feature_kind import ToleranceSymbol
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.kinds import kind_of, results_of

Line = tuple[tuple[float, float], ...]
"""Places x, y one after the other, joined by straight lines."""


def _arc(x: float, y: float, radius: float, turn: float = 2 * math.pi) -> Line:
    """From the right of its middle onwards, anticlockwise; enough corners for a symbol."""
    angles = [turn * step / 32 for step in range(33)]
    return tuple((x + radius * math.cos(angle), y + radius * math.sin(angle)) for angle in angles)


STROKES: Mapping[ToleranceSymbol, tuple[Line, ...]] = {
    "flatness": (((0.12, 0.28), (0.66, 0.28), (0.88, 0.72), (0.34, 0.72), (0.12, 0.28)),),
    "cylindricity": (_arc(0.5, 0.5, 0.2), ((0.12, 0.22), (0.4, 0.78)), ((0.6, 0.22), (0.88, 0.78))),
    "parallelism": (((0.26, 0.2), (0.52, 0.8)), ((0.48, 0.2), (0.74, 0.8))),
    "perpendicularity": (((0.18, 0.24), (0.82, 0.24)), ((0.5, 0.24), (0.5, 0.8))),
    "position": (_arc(0.5, 0.5, 0.24), ((0.12, 0.5), (0.88, 0.5)), ((0.5, 0.12), (0.5, 0.88))),
    "profile of a surface": (_arc(0.5, 0.34, 0.34, math.pi), ((0.16, 0.34), (0.84, 0.34))),
}
"""Lines of each symbol in a square of side 1, y up, shaped as ISO 7083 has them."""

LETTERS = "ABCDEFGHJKLMNPRSTUVWYZ"
"""Of datums in their order: I, O, Q and X are not used."""


@dataclass(frozen=True, slots=True)
class ControlFrame:
    """Feature control frame: its symbol, the zone's width in mm, "⌀" or "S⌀" of a round zone (else ""), and datums."""

    symbol: ToleranceSymbol
    zone_mm: float
    round: str = ""
    datums: tuple[str, ...] = ()


def datum_letters(plan: InspectionPlan) -> dict[str, str]:
    """Assign a letter to each feature that is a datum, by its name: first those of the part coordinates, in order."""
    names = list(plan.frame.names) if plan.frame is not None else []
    names += [spec.of[1] for spec in plan.features if _has_own_datum(spec)]
    return dict(zip(dict.fromkeys(names), LETTERS, strict=False))


def control_frames(plan: InspectionPlan) -> Mapping[str, ControlFrame]:
    """Make the feature control frame (ISO 1101) of each toleranced form, orientation or location, by its name."""
    letters, frames = datum_letters(plan), dict[str, ControlFrame]()
    for spec in plan.features:
        for name, result in results_of(spec).items():
            limits = spec.limits_of(name)
            if not result.symbol or limits is None or not math.isfinite(limits.upper):
                continue
            datums = tuple(letters[one] for one in datums_of(spec, plan) if one in letters)
            frames[f"{spec.name} {name}"] = ControlFrame(
                result.symbol, limits.nominal + limits.upper, _round(spec, plan), datums
            )
    return frames


def datums_of(spec: FeatureSpec, plan: InspectionPlan) -> tuple[str, ...]:
    """Return the names of the features that are the datums of the feature `spec`, in order."""
    if spec.position is not None or (spec.deviation is not None and spec.deviation.align == "frame"):
        return () if plan.frame is None else plan.frame.names
    return spec.of[1:] if _has_own_datum(spec) else ()


def _has_own_datum(spec: FeatureSpec) -> bool:
    """Whether it is made of a feature and the datum it refers to."""
    return len(spec.of) == 2 and any(result.symbol for result in kind_of(spec).results)


def _round(spec: FeatureSpec, plan: InspectionPlan) -> str:
    """Sign of a round zone: of centres, of axes, of axes to a datum that fixes both their tilts."""
    elements = [kind_of(one).element for name in spec.of for one in plan.features if one.name == name]
    if spec.position is not None:
        return "S⌀" if elements == ["point"] else "⌀"
    fixes_both = {"parallelism": ["axis", "axis"], "perpendicularity": ["axis", "plane"]}
    return "⌀" if elements and elements == fixes_both.get(spec.kind) else ""
