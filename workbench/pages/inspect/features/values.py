"""A feature of a plan as the fields of a form, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from core.inspect.conformity import Limits
from core.inspect.plan.feature_kind import FeatureKind, ResultKind
from core.inspect.plan.feature_spec import (
    Auto,
    Cut,
    Deviation,
    FaceAt,
    FeatureSpec,
    InBox,
    InSphere,
    Place,
    PointsOf,
    Polygon,
    Position,
    Region,
    Section,
)
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.kinds import FILTERS, MOST_FACES, kind_named, kind_of, results_of
from core.messages import MINUS
from workbench.language import tr

AUTO, DRAWN, CLICKED, SPHERE, BOX = "auto", "drawn", "clicked", "sphere", "box"
POINTS_OF = "of "
"""Where a region's points come from: found, drawn in the picture, a face that was clicked, inside a sphere or a box of
part coordinates, "of " and a feature."""

CORNERS = ("low", "high")
SIDES = ("nominal", "lower", "upper")

USUAL_MM = 10.0
"""Half a side of a box of which nothing is known."""

UPRIGHT = 1e-6
"""Least share of x and y in what a section is square to: along z alone, heights in it would have no direction."""


def new_feature(
    kind: str,
    name: str,
    plan: InspectionPlan,
    size: tuple[int, int],
    nominal: str = "",
    section: Section | None = None,
) -> FeatureSpec:
    """Make a feature of a kind with usual values; if it is made of elements, of the last two of the plan."""
    made, found = FeatureSpec(name, kind), kind_named(kind)
    if found.made_of:
        made = replace(made, of=elements(plan, found)[-found.made_of :])
    match found.settings:
        case "section":
            middle = float(size[1] // 2)
            return replace(made, section=section or Section(((0.0, middle), (float(size[0] - 1), middle))))
        case "deviation":
            return replace(made, deviation=Deviation(nominal))
        case "position":
            return replace(made, position=Position())
    return made


def elements(plan: InspectionPlan, kind: FeatureKind) -> tuple[str, ...]:
    """List the names of the plan's features that a feature of this kind can be made of."""
    return tuple(one.name for one in plan.features if kind_of(one).element in kind.made_from)


def why_not(kind: str, plan: InspectionPlan) -> str:
    """Return the reason why a feature of this kind cannot be added to the plan; "" if it can."""
    found = kind_named(kind)
    if len(elements(plan, found)) >= found.made_of:
        return ""
    if found.made_of == 1:
        return tr("It is made of another feature: add a cylinder or a sphere first.")
    if "point" not in found.made_from:
        return tr("It is made of two other features: add planes or cylinders first.")
    return tr("It is made of two other features: add planes, spheres, cylinders or points first.")


def values_of(spec: FeatureSpec) -> dict[str, Any]:
    """Return all settings of a feature as the fields of its form."""
    values: dict[str, Any] = {"name": spec.name}
    values |= {f"of {place}": name for place, name in enumerate(spec.of)}
    if not kind_of(spec).made_of and not kind_of(spec).missing:
        values["parts"] = None if len(spec.regions) == 1 else len(spec.regions)
    for place, region in enumerate(own_regions(spec)):
        values[f"source {place}"] = _source(region)
        if isinstance(region, Auto):
            values[f"number {place}"] = region.number
        if isinstance(region, InSphere):
            values |= {f"centre {place}": _shown(region.centre_mm), f"radius {place}": region.radius_mm}
        if isinstance(region, InBox):
            values |= {f"low {place}": _shown(region.low_mm), f"high {place}": _shown(region.high_mm)}
    for result in results_of(spec):
        values |= limits_values(spec, result)
    for key, holder in _holders(spec).items():
        values[key] = _shown(getattr(getattr(spec, holder) if holder else spec, key))
    if spec.section is not None:
        values |= _section_values(spec.section)
    return values


def with_value(spec: FeatureSpec, key: str, value: Any) -> FeatureSpec:
    """Return the feature with one field changed; ValueError, a sentence, if the value is impossible."""
    group, _, rest = key.partition(" ")
    if key == "name":
        return replace(spec, name=str(value).strip())
    if group == "of":
        names = list(spec.of)
        names[int(rest)] = str(value)
        return replace(spec, of=tuple(names))
    if key == "parts":
        count = 1 if value is None else int(value)
        return replace(spec, regions=tuple(_region(spec.regions, place) for place in range(count)))
    if group == "source":
        place = int(rest)
        return spec if value == _source(spec.regions[place]) else with_region(spec, place, _sourced(value))
    if group == "number":
        return with_region(spec, int(rest), Auto(int(value)))
    if group in ("centre", "radius"):
        return _with_sphere(spec, int(rest), group, value)
    if group in CORNERS:
        return with_box(spec, int(rest), values_of(spec) | {key: value})
    if key in _holders(spec):
        return _with_own(spec, _holders(spec)[key], key, value)
    if spec.section is not None:
        return _with_section(spec, spec.section, key, value)
    raise KeyError(key)


def own_regions(spec: FeatureSpec) -> tuple[Region, ...]:
    """Return the regions that hold a feature's points; () for a feature made of others."""
    return () if kind_of(spec).made_of or kind_of(spec).missing else spec.regions


def with_region(spec: FeatureSpec, place: int, region: Region) -> FeatureSpec:
    """Return the feature with its region number `place` replaced."""
    return replace(spec, regions=(*spec.regions[:place], region, *spec.regions[place + 1 :]))


# ---- limits


def limits_values(spec: FeatureSpec, result: str) -> dict[str, float | None]:
    """Return the nominal value and the permitted deviations of a result, in mm or degrees; None where none is set."""
    limits = dict(spec.limits).get(result)
    keys = [f"limits {side} {result}" for side in SIDES]
    if limits is None:
        return dict.fromkeys(keys)
    shown = (limits.nominal, limits.lower, limits.upper)
    return {key: _finite(_factor(results_of(spec)[result]) * value) for key, value in zip(keys, shown, strict=True)}


def with_limits(spec: FeatureSpec, result: str, values: Mapping[str, float | None]) -> FeatureSpec:
    """Return the feature with the limits of a result changed; ValueError, a sentence, if one is missing."""
    nominal, lower, upper = (values.get(f"limits {side} {result}") for side in SIDES)
    kept = tuple(one for one in spec.limits if one[0] != result)
    kind = results_of(spec)[result]
    if kind.one_sided:
        nominal, lower = None if upper is None else 0.0, None
    elif kind.numbered and (lower, upper) != (None, None):
        nominal = nominal or 0.0
    if nominal is None and lower is None and upper is None:
        return replace(spec, limits=kept)
    if nominal is None:
        raise ValueError(tr("Enter the nominal value too: the deviations count from it."))
    if lower is None and upper is None:
        raise ValueError(tr("Enter a lower or an upper deviation too: without one nothing can be decided."))
    if lower is not None and upper is not None and lower > upper:
        raise ValueError(tr("The lower deviation is above the upper one."))
    per = 1 / _factor(kind)
    low, high = -math.inf if lower is None else per * lower, math.inf if upper is None else per * upper
    return replace(spec, limits=(*kept, (result, Limits(per * nominal, low, high))))


def _factor(result: ResultKind) -> float:
    """From what a plan holds to what is shown: angles in degrees."""
    return math.degrees(1.0) if result.quantity == "angle" else 1.0


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


# ---- regions


def _source(region: Region) -> str:
    match region:
        case Auto():
            return AUTO
        case Polygon():
            return DRAWN
        case FaceAt():
            return CLICKED
        case PointsOf():
            return POINTS_OF + region.feature
        case InSphere():
            return SPHERE
        case InBox():
            return BOX


def _sourced(source: str) -> Region:
    if source in (SPHERE, BOX):
        return around(source, (-USUAL_MM, -USUAL_MM, -USUAL_MM), (USUAL_MM, USUAL_MM, USUAL_MM))
    return PointsOf(source.removeprefix(POINTS_OF)) if source.startswith(POINTS_OF) else Auto()


def around(source: str, low: Place, high: Place) -> Region:
    """Make the sphere or box region, in part coordinates, that encloses the box from `low` to `high`, in mm."""
    if source == BOX:
        return InBox(low, high)
    (x, y, z), radius = ((a + b) / 2 for a, b in zip(low, high, strict=True)), math.dist(low, high) / 2
    return InSphere((round(x, 3), round(y, 3), round(z, 3)), math.ceil(1e3 * radius) / 1e3)


def _with_sphere(spec: FeatureSpec, place: int, field: str, value: Any) -> FeatureSpec:
    region = spec.regions[place]
    assert isinstance(region, InSphere)
    if field == "radius":
        return with_region(spec, place, replace(region, radius_mm=float(value)))
    return with_region(spec, place, replace(region, centre_mm=_place(str(value))))


def with_box(spec: FeatureSpec, place: int, values: Mapping[str, Any]) -> FeatureSpec:
    """Return the feature with box region number `place` between the corners in the fields; ValueError, a sentence."""
    low, high = (_place(str(values[f"{corner} {place}"])) for corner in CORNERS)
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise ValueError(tr("Each of the smallest x, y and z is to be below the largest one."))
    return with_region(spec, place, InBox(low, high))


def _region(regions: tuple[Region, ...], place: int) -> Region:
    """The region at a place; new ones are found as the faces not yet taken, from the largest down."""
    return regions[place] if place < len(regions) else Auto(min(place + 1, MOST_FACES))


def _numbers(text: str) -> tuple[float, ...]:
    try:
        numbers = tuple(float(part.replace(",", ".").replace(MINUS, "-")) for part in text.split(";") if part.strip())
    except ValueError as error:
        raise ValueError(tr("Write numbers in mm with semicolons between them, as 10; 20; 30.")) from error
    if not all(math.isfinite(number) for number in numbers):
        raise ValueError(tr("Write numbers in mm with semicolons between them, as 10; 20; 30."))
    return numbers


def _place(text: str) -> Place:
    """A place in part coordinates."""
    return _three(text, tr("Write x, y and z in mm with semicolons between them, as 10; 20; 0."))


def _direction(text: str) -> Place:
    """What a section is square to."""
    wrong = tr("Write x, y and z with semicolons between them, as 0; 1; 0: a direction, and not along z.")
    x, y, z = _three(text, wrong)
    if math.hypot(x, y) <= UPRIGHT * abs(z):
        raise ValueError(wrong)
    return x, y, z


def _three(text: str, wrong: str) -> Place:
    try:
        x, y, z = _numbers(text)
    except ValueError as error:
        raise ValueError(wrong) from error
    return x, y, z


# ---- settings of a kind


def _holders(spec: FeatureSpec) -> dict[str, str]:
    """The settings it has, by key, and the field of the feature that holds each; "" for the feature itself."""
    kind = kind_of(spec)
    own = {one.key: str(kind.settings) for one in kind.fields}
    return own if kind.made_of or kind.missing else own | {one.key: "filters" for one in FILTERS}


def _with_own(spec: FeatureSpec, holder: str, key: str, value: Any) -> FeatureSpec:
    """The feature with one of these changed."""
    held = getattr(spec, holder) if holder else spec
    if isinstance(getattr(held, key), tuple):
        value = _place(str(value)) if holder == "position" else _numbers(str(value))
    changed: Any = replace(held, **{key: value})
    return replace(spec, **{holder: changed}) if holder else changed


def _shown(value: Any) -> Any:
    """A setting as its field shows it: several numbers are one text."""
    return "; ".join(f"{one:.10g}" for one in value) if isinstance(value, tuple) else value


# ---- sections


def _section_values(section: Section) -> dict[str, Any]:
    values: dict[str, Any] = {}
    if section.line_px is None:
        values |= {"place": _shown(section.point_mm), "direction": _shown(section.normal)}
    for place, corner in enumerate(section.line_px or ()):
        values |= {f"line {place} 0": corner[0], f"line {place} 1": corner[1]}
    for place, cut in enumerate(section.cuts):
        values |= {f"cut {place} name": cut.name, f"cut {place} kind": cut.kind}
        for stretch in ("first", "second"):
            low, high = getattr(cut, stretch)
            values |= {f"cut {place} {stretch} 0": low, f"cut {place} {stretch} 1": high}
    return values


def _with_section(spec: FeatureSpec, section: Section, key: str, value: Any) -> FeatureSpec:
    if key == "place":
        return replace(spec, section=replace(section, point_mm=_place(str(value))))
    if key == "direction":
        return replace(spec, section=replace(section, normal=_direction(str(value))))
    group, _, rest = key.partition(" ")
    place, _, field = rest.partition(" ")
    if group == "line" and section.line_px is not None:
        line = [list(corner) for corner in section.line_px]
        line[int(place)][int(field)] = float(value)
        return replace(spec, section=replace(section, line_px=((line[0][0], line[0][1]), (line[1][0], line[1][1]))))
    if group == "cut":
        return _with_cut(spec, section, int(place), field, value)
    raise KeyError(key)


def _with_cut(spec: FeatureSpec, section: Section, place: int, field: str, value: Any) -> FeatureSpec:
    cut, limits = section.cuts[place], spec.limits
    if field == "name":
        name = str(value).strip()
        if not name or any(other.name == name for other in section.cuts if other is not cut):
            raise ValueError(tr("Give each measurement in the section a name of its own."))
        limits = tuple((name if result == cut.name else result, one) for result, one in limits)
        changed = replace(cut, name=name)
    elif field == "kind":
        changed = replace(cut, kind=value)
    else:
        stretch, _, end = field.partition(" ")
        ends = list(getattr(cut, stretch))
        ends[int(end)] = float(value)
        moved: dict[str, Any] = {stretch: (ends[0], ends[1])}
        changed = replace(cut, **moved)
    return replace(spec, limits=limits, section=replace(section, cuts=_put(section.cuts, place, changed)))


def with_new_cut(
    spec: FeatureSpec, stretches: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 10.0), (20.0, 30.0))
) -> FeatureSpec:
    """Return the section with one measurement added: the height over the second of two `stretches`, in mm."""
    if spec.section is None:
        return spec
    names, number = {cut.name for cut in spec.section.cuts}, 1
    while f"height {number}" in names:
        number += 1
    cut = Cut(f"height {number}", "height", *stretches)
    return replace(spec, section=replace(spec.section, cuts=(*spec.section.cuts, cut)))


def without_cut(spec: FeatureSpec, place: int) -> FeatureSpec:
    """Return the section without its measurement number `place` and that one's limits."""
    if spec.section is None:
        return spec
    cuts, gone = spec.section.cuts, spec.section.cuts[place].name
    limits = tuple(one for one in spec.limits if one[0] != gone)
    return replace(spec, limits=limits, section=replace(spec.section, cuts=(*cuts[:place], *cuts[place + 1 :])))


def _put(cuts: tuple[Cut, ...], place: int, cut: Cut) -> tuple[Cut, ...]:
    return (*cuts[:place], cut, *cuts[place + 1 :])
