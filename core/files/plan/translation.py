"""A plan as the tables of plan.toml, and back: what each key means inside, also of its master block."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files.plan.tables import (
    FeatureTable,
    FrameTable,
    LimitsTable,
    MasterTable,
    PlanTables,
    RegionTable,
    SectionTable,
    TemperatureTable,
)
from core.findings.proof import Doubt
from core.inspect.causes import Cause, cause_named
from core.inspect.conformity import Limits
from core.inspect.plan.conditions import Master, Temperature
from core.inspect.plan.feature_kind import ResultKind
from core.inspect.plan.feature_spec import (
    Auto,
    Cut,
    Deviation,
    FaceAt,
    FeatureSpec,
    Filters,
    InBox,
    InSphere,
    PointsOf,
    Polygon,
    Position,
    Region,
    Section,
)
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.inspect.plan.kinds import results_of
from core.messages import Message


def plan_tables(plan: InspectionPlan) -> dict[str, Any]:
    """Make the tables of plan.toml for an inspection plan, without values that are the default."""
    tables: dict[str, Any] = {"k": float(plan.k)}
    if plan.frame is not None:
        frame = plan.frame
        tables["frame"] = _present({key: getattr(frame, key) or None for key in FrameTable.model_fields})
    if plan.temperature is not None:
        tables["temperature"] = {key: getattr(plan.temperature, name) for key, name in _TEMPERATURE.items()}
    if plan.master is not None:
        tables["master"] = master_table(plan.master)
    if plan.features:
        tables["feature"] = [_feature_table(feature) for feature in plan.features]
    return tables


def plan_of(tables: PlanTables, path: Path) -> InspectionPlan:
    """Make the inspection plan that checked `tables` of the file `path` describe; files it names lie beside it."""
    frame = None if tables.frame is None else PartFrame(**tables.frame.model_dump())
    temperature = None if tables.temperature is None else _temperature(tables.temperature)
    master = None if tables.master is None else master_of(tables.master, path)
    return InspectionPlan(tuple(_feature(table) for table in tables.feature), frame, temperature, master, tables.k)


_TEMPERATURE = {
    "part_celsius": "part_celsius",
    "u_part_celsius": "u_part_celsius",
    "alpha_per_K": "alpha",
    "u_alpha_per_K": "u_alpha",
    "target_celsius": "scale_celsius",
    "u_target_celsius": "u_scale_celsius",
    "target_alpha_per_K": "scale_alpha",
    "u_target_alpha_per_K": "u_scale_alpha",
}
"""Keys of [temperature] and what the numbers are called inside."""


def _temperature(table: TemperatureTable) -> Temperature:
    return Temperature(**{name: getattr(table, key) for key, name in _TEMPERATURE.items()})


def _feature(table: FeatureTable) -> FeatureSpec:
    regions = table.regions if table.regions is not None else [table.region]
    spec = FeatureSpec(
        name=table.name,
        kind=table.kind,
        regions=tuple(_region(region) for region in regions),
        of=tuple(table.of),
        filters=Filters() if table.filters is None else Filters(**table.filters.model_dump()),
        nominal_heights=tuple(table.nominal_heights_mm),
        over=table.over,
        section=None if table.section is None else _section(table.section),
        deviation=None if table.deviation is None else Deviation(**table.deviation.model_dump()),
        position=None if table.position is None else Position(_three(table.position.at_mm)),
    )
    kinds = results_of(spec)
    return replace(
        spec, limits=tuple((name, _limits(limits, kinds.get(name))) for name, limits in table.limits.items())
    )


def _region(table: RegionTable | str | None) -> Region:
    if table is None or isinstance(table, str):
        return Auto()
    if table.number is not None:
        return Auto(table.number)
    if table.polygon_px is not None:
        return Polygon(tuple((u, v) for u, v in table.polygon_px))
    if table.sphere_mm is not None:
        x, y, z, radius = table.sphere_mm
        return InSphere((x, y, z), radius)
    if table.box_mm is not None:
        low, high = ((x, y, z) for x, y, z in table.box_mm)
        return InBox(low, high)
    if table.face_at_px is not None:
        return FaceAt(at_px=_two(table.face_at_px))
    if table.face_at_mm is not None:
        return FaceAt(at_mm=_three(table.face_at_mm))
    return PointsOf(table.points_of or "")


def _limits(table: LimitsTable, result: ResultKind | None) -> Limits:
    """In mm or rad; `result` is what they are of, None if the feature has no such."""
    if table.in_degrees:
        unit, nominal, tolerance = math.radians(1), table.nominal_deg, table.tolerance_deg
        lower, upper = table.lower_deg, table.upper_deg
    else:
        unit, nominal, tolerance = 1.0, table.nominal_mm, table.tolerance_mm
        lower, upper = table.lower_mm, table.upper_mm
    if tolerance is not None:
        lower, upper = None if result is not None and result.one_sided else -tolerance, tolerance
    return Limits(
        (nominal or 0.0) * unit,
        -math.inf if lower is None else lower * unit,
        math.inf if upper is None else upper * unit,
    )


def _section(table: SectionTable) -> Section:
    usual = Section()
    line = None if table.line_px is None else tuple((u, v) for u, v in table.line_px)
    return Section(
        line_px=None if line is None else (line[0], line[1]),
        point_mm=usual.point_mm if table.point_mm is None else _three(table.point_mm),
        normal=usual.normal if table.normal is None else _three(table.normal),
        half_width_mm=table.half_width_mm,
        step_mm=table.step_mm,
        cuts=tuple(Cut(cut.name, cut.kind, _two(cut.first_mm), _two(cut.second_mm)) for cut in table.cuts),
    )


def _two(values: list[float]) -> tuple[float, float]:
    return values[0], values[1]


def _three(values: list[float]) -> tuple[float, float, float]:
    return values[0], values[1], values[2]


def _feature_table(spec: FeatureSpec) -> dict[str, Any]:
    usual = FeatureSpec(spec.name, spec.kind)
    regions = [_region_table(region) for region in spec.regions]
    table: dict[str, Any] = {"name": spec.name, "kind": spec.kind}
    if spec.regions != usual.regions:
        table |= {"region": regions[0]} if len(regions) == 1 else {"regions": regions}
    if spec.of:
        table["of"] = list(spec.of)
    filters = {
        key: getattr(spec.filters, key)
        for key in ("sigma_max_mm", "margin_mm", "outliers", "cell_mm")
        if getattr(spec.filters, key) != getattr(usual.filters, key)
    }
    if filters:
        table["filters"] = filters
    if spec.nominal_heights:
        table["nominal_heights_mm"] = list(spec.nominal_heights)
    if spec.over != usual.over:
        table["over"] = spec.over
    if spec.section is not None:
        table["section"] = _section_table(spec.section)
    if spec.deviation is not None:
        one = spec.deviation
        table["deviation"] = {key: getattr(one, key) for key in ("nominal", "align", "tolerance_mm", "reach_mm")}
    if spec.position is not None:
        table["position"] = {"at_mm": list(spec.position.at_mm)}
    if spec.limits:
        kinds = results_of(spec)
        table["limits"] = {name: _limits_table(limits, kinds.get(name)) for name, limits in spec.limits}
    return table


def _region_table(region: Region) -> Any:
    if isinstance(region, Auto):
        return "auto" if region.number == 1 else {"number": region.number}
    if isinstance(region, Polygon):
        return {"polygon_px": [list(corner) for corner in region.corners_px]}
    if isinstance(region, InSphere):
        return {"sphere_mm": [*region.centre_mm, region.radius_mm]}
    if isinstance(region, InBox):
        return {"box_mm": [list(region.low_mm), list(region.high_mm)]}
    if isinstance(region, FaceAt):
        return {f"face_{key}": list(at) for key in ("at_px", "at_mm") if (at := getattr(region, key)) is not None}
    return {"points_of": region.feature}


def _limits_table(limits: Limits, result: ResultKind | None) -> dict[str, float]:
    angle = result is not None and result.quantity == "angle"
    unit, name = (math.degrees(1), "deg") if angle else (1.0, "mm")
    table = {f"nominal_{name}": limits.nominal * unit}
    if math.isfinite(limits.lower):
        table[f"lower_{name}"] = limits.lower * unit
    if math.isfinite(limits.upper):
        table[f"upper_{name}"] = limits.upper * unit
    return table


def _section_table(section: Section) -> dict[str, Any]:
    usual = Section()
    table: dict[str, Any] = (
        {"point_mm": list(section.point_mm), "normal": list(section.normal)}
        if section.line_px is None
        else {"line_px": [list(pixel) for pixel in section.line_px]}
    )
    for key in ("half_width_mm", "step_mm"):
        if getattr(section, key) != getattr(usual, key):
            table[key] = getattr(section, key)
    table["cuts"] = [
        {"name": cut.name, "kind": cut.kind, "first_mm": list(cut.first)}
        | ({} if cut.kind == "radius" else {"second_mm": list(cut.second)})
        for cut in section.cuts
    ]
    return table


def _present(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def master_of(table: MasterTable, path: Path) -> Master:
    """Make the master, a known length measured like the part, that [master] of the plan at `path` describes.

    Raises
    ------
    InputError
        If its result is missing, or has no such characteristic.
    """
    doubts = tuple(map(Doubt.named, table.doubts))
    measured, budget = table.measured_mm, tuple((cause_named(row.source), row.u_mm) for row in table.budget)
    if table.result is not None:
        from core.files.results.inspection_file import read_inspection  # the whole of inspecting: only now

        rows = {row.name: row for row in read_inspection(path.parent / table.result).characteristics}
        if table.characteristic not in rows:
            known = ", ".join(rows) or "nothing"
            raise InputError(
                Message(
                    "inspection.no_such_characteristic",
                    "there is no {characteristic!r} in {result}, which holds {known}",
                    characteristic=table.characteristic,
                    result=table.result,
                    known=known,
                ),
                where=f"{path}, master.characteristic",
                todo=Message("advice.name_one_of", "name one of these"),
            )
        row = rows[table.characteristic]
        rows_of = tuple((one.source, one.u_mm) for one in row.budget)
        doubts += row.doubts
        measured, budget = row.value, rows_of or ((Cause.MASTER_MEASURED, row.u),)
    assert measured is not None  # one of the two, says the table
    return Master(
        name=table.name,
        certified_mm=table.certified_mm,
        u_certified_mm=table.u_certified_mm,
        measured_mm=measured,
        budget=budget,
        features=tuple(table.features),
        same_calibration=table.same_calibration,
        doubts=doubts,
    )


def master_table(master: Master) -> dict[str, Any]:
    """Make the table [master] of plan.toml with the master's measurement as numbers."""
    return {
        "name": master.name,
        "certified_mm": master.certified_mm,
        "u_certified_mm": master.u_certified_mm,
        "features": list(master.features),
        "measured_mm": master.measured_mm,
        "budget": [{"source": str(source), "u_mm": u} for source, u in master.budget],
        "same_calibration": master.same_calibration,
        **({"doubts": [doubt.fact for doubt in master.doubts]} if master.doubts else {}),
    }
