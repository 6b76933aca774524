"""Part coordinates, temperature and master of a plan as the fields of a form, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QCoreApplication

from core.inspect.conditions import Master, Temperature
from core.inspect.feature_spec import Kind
from core.inspect.inspection_plan import InspectionPlan, PartFrame

FRAME: Mapping[str, tuple[Kind, ...]] = {
    "primary": ("plane",),
    "secondary": ("plane", "cylinder"),
    "tertiary": ("plane", "sphere", "cylinder", "point"),
}
"""What part coordinates rest on, and the kinds of features that can be each."""
WITH_LENGTHS: tuple[Kind, ...] = ("thickness", "steps", "sphere", "cylinder", "distance", "section")
"""Kinds of features whose lengths can be compared with a master."""

AT_20, WITH_MASTER, COMPARED = "at 20 °C", "with master", "compared "
"""Keys of the two switches, and of whether a feature is compared (its name follows)."""
PER_KELVIN = 1e6
"""Expansion coefficients are shown in 10⁻⁶/K."""
COEFFICIENTS = ("alpha", "u_alpha", "scale_alpha", "u_scale_alpha")
TEMPERATURES = ("part_celsius", "u_part_celsius", "scale_celsius", "u_scale_celsius")
MASTER = ("name", "certified_mm", "u_certified_mm", "measured_mm", "budget", "same_calibration")
U_MEASURED = "u_measured_mm"
"""Stands for the whole budget in the form."""
MEASUREMENT = "measurement"
"""The one row of the budget of a master whose uncertainty was typed in."""

STEEL = Temperature(part_celsius=20.0, u_part_celsius=0.5, alpha=11.5e-6, u_alpha=0.6e-6)
"""What stands in the form at first; ±1·10⁻⁶/K are what ISO 3650 allows for steel."""


def values_of(plan: InspectionPlan) -> dict[str, Any]:
    """All fields of a plan's conditions; those of what it does not have are as they stand at first."""
    frame = plan.frame or PartFrame("", "")
    values: dict[str, Any] = {key: getattr(frame, key) for key in FRAME}
    values |= {AT_20: plan.temperature is not None, WITH_MASTER: plan.master is not None}
    temperature = plan.temperature or STEEL
    values |= {key: getattr(temperature, key) for key in TEMPERATURES}
    values |= {key: round(getattr(temperature, key) * PER_KELVIN, 9) for key in COEFFICIENTS}
    values |= _master_values(plan.master)
    for name in comparable(plan):
        values[COMPARED + name] = plan.master is None or name in plan.master.features
    return values


def comparable(plan: InspectionPlan) -> tuple[str, ...]:
    """Names of the features that can be compared with a master."""
    return tuple(one.name for one in plan.features if one.kind in WITH_LENGTHS)


def frame_choices(plan: InspectionPlan, place: str) -> tuple[str, ...]:
    """Names of the features that can be this of the part's coordinates."""
    return tuple(one.name for one in plan.features if one.kind in FRAME[place])


def with_frame(plan: InspectionPlan, values: Mapping[str, Any]) -> InspectionPlan:
    """The plan with part coordinates as the fields say; ValueError with a sentence if they say too little."""
    names = [str(values[key]) for key in FRAME]
    if not names[0]:
        return replace(plan, frame=None)
    if not names[1]:
        raise ValueError(_tr("Choose the second feature too: the x axis points out of it, or along it."))
    if len(set(names)) < len(names):
        raise ValueError(_tr("Choose three different features."))
    return replace(plan, frame=PartFrame(*names))


def with_temperature(plan: InspectionPlan, values: Mapping[str, Any]) -> InspectionPlan:
    """The plan with lengths at 20 °C as the fields say, or as measured."""
    if not values[AT_20]:
        return replace(plan, temperature=None)
    celsius = {key: float(values[key]) for key in TEMPERATURES}
    return replace(plan, temperature=Temperature(**celsius, **{key: values[key] / PER_KELVIN for key in COEFFICIENTS}))


def with_master(plan: InspectionPlan, values: Mapping[str, Any]) -> InspectionPlan:
    """The plan compared with a master as the fields say; ValueError with a sentence if they say too little."""
    if not values[WITH_MASTER]:
        return replace(plan, master=None)
    if not str(values["name"]).strip():
        raise ValueError(_tr("Give the master a name: the report prints it."))
    if values["certified_mm"] is None:
        raise ValueError(_tr("Enter its length by the certificate."))
    if values["measured_mm"] is None:
        raise ValueError(_tr("Enter what was measured of it, or take it from results."))
    features = tuple(name for name in comparable(plan) if values[COMPARED + name])
    if not features:
        raise ValueError(_tr("Choose a feature that is compared with it."))
    return replace(
        plan,
        master=Master(
            name=str(values["name"]).strip(),
            certified_mm=values["certified_mm"],
            u_certified_mm=values["u_certified_mm"],
            measured_mm=values["measured_mm"],
            budget=tuple(values["budget"]),
            features=features,
            same_calibration=bool(values["same_calibration"]),
        ),
    )


def combined(budget: Sequence[tuple[str, float]]) -> float:
    """What the causes of a master's measurement come to, in mm, as it is shown."""
    return round(math.hypot(*(u for _, u in budget)), 6)


def _master_values(master: Master | None) -> dict[str, Any]:
    if master is None:
        first = {"name": "", "u_certified_mm": 0.0, "budget": ((MEASUREMENT, 0.0),), "same_calibration": True}
        return dict.fromkeys(MASTER) | first
    return {key: getattr(master, key) for key in MASTER}


def _tr(text: str) -> str:
    return QCoreApplication.translate("Inspect", text)
