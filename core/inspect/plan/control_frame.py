"""What a plan asks of features' form and lie, as feature control frames and datum letters.

References
----------
ISO 1101:2017, Geometrical tolerancing, 8.1 and annex C. ISO 5459:2011, Datums and datum systems, 7.2 (letters).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from core.inspect.plan.feature_kind import ToleranceSymbol
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.kinds import kind_of, results_of

LETTERS = "ABCDEFGHJKLMNPRSTUVWYZ"
"""Of datums in their order: I, O, Q and X are not used."""


@dataclass(frozen=True, slots=True)
class ControlFrame:
    """One: its symbol, the zone's width in mm, "⌀" or "S⌀" of a round zone (else ""), and letters of its datums."""

    symbol: ToleranceSymbol
    zone_mm: float
    round: str = ""
    datums: tuple[str, ...] = ()


def datum_letters(plan: InspectionPlan) -> dict[str, str]:
    """Letters by the names of features that are datums: those of the part coordinates first, in their order."""
    names = list(plan.frame.names) if plan.frame is not None else []
    names += [spec.of[1] for spec in plan.features if _has_own_datum(spec)]
    return dict(zip(dict.fromkeys(names), LETTERS, strict=False))


def control_frames(plan: InspectionPlan) -> Mapping[str, ControlFrame]:
    """Of each characteristic that is a form or a lie after ISO 1101 and has a tolerance, by its name."""
    letters, frames = datum_letters(plan), dict[str, ControlFrame]()
    system = tuple(letters[name] for name in plan.frame.names if name in letters) if plan.frame is not None else ()
    for spec in plan.features:
        for name, result in results_of(spec).items():
            limits = spec.limits_of(name)
            if not result.symbol or limits is None or not math.isfinite(limits.upper):
                continue
            own = tuple(letters[one] for one in spec.of[1:] if one in letters) if _has_own_datum(spec) else ()
            in_system = spec.position is not None or (spec.deviation is not None and spec.deviation.align == "frame")
            datums = system if in_system else own
            frames[f"{spec.name} {name}"] = ControlFrame(
                result.symbol, limits.nominal + limits.upper, _round(spec, plan), datums
            )
    return frames


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
