"""What the features of a plan have in common: part coordinates, temperature, master; as fields of a form, and back."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from core.inspect.causes import Cause
from core.inspect.plan.conditions import Master, Temperature
from core.inspect.plan.feature_kind import ElementKind
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.inspect.plan.kinds import kind_of
from workbench.language import joined, text_of, tr
from workbench.pages.inspect.features.plan import InspectFeatures
from workbench.work import jobs

FRAME: Mapping[str, tuple[ElementKind, ...]] = {
    "primary": ("plane",),
    "secondary": ("plane", "axis"),
    "tertiary": ("plane", "axis", "point"),
}
"""What part coordinates rest on, and what each can be."""

AT_20, WITH_MASTER, COMPARED = "at 20 °C", "with master", "compared "
"""Keys of the two switches, and of whether a feature is compared (its name follows)."""
PER_KELVIN = 1e6
"""Expansion coefficients are shown in 10⁻⁶/K."""
COEFFICIENTS = ("alpha", "u_alpha", "scale_alpha", "u_scale_alpha")
TEMPERATURES = ("part_celsius", "u_part_celsius", "scale_celsius", "u_scale_celsius")
MASTER = ("name", "certified_mm", "u_certified_mm", "measured_mm", "budget", "same_calibration", "doubts")
U_MEASURED = "u_measured_mm"
"""Stands for the whole budget in the form."""

STEEL = Temperature(part_celsius=20.0, u_part_celsius=0.5, alpha=11.5e-6, u_alpha=0.6e-6)
"""What stands in the form at first; ±1·10⁻⁶/K are what ISO 3650 allows for steel."""


class InspectConditions:
    """Fields of the form of the plan's conditions; incomplete ones are stored here, with a sentence."""

    def __init__(self, features: InspectFeatures) -> None:
        self._features, self._model = features, features.bench.model
        self._pending: dict[str, Any] = {}
        self._complaints: dict[str, str] = {}
        self._of: object = None

    @property
    def plan(self) -> InspectionPlan:
        """Inspection plan of the project, to which the conditions belong."""
        return self._features.plan

    @property
    def projects_folder(self) -> Path:
        """Folder in which the file dialog looks for the project of a master."""
        return self._features.bench.settings.projects_folder

    @property
    def temperature_is_on(self) -> bool:
        """Whether the plan states lengths at 20 °C."""
        return bool(self.values()[AT_20])

    @property
    def master_is_on(self) -> bool:
        """Whether the plan compares the part with a master, or a master is being entered."""
        return bool(self.values()[WITH_MASTER])

    @property
    def in_short(self) -> str:
        """Summary of the conditions in a few words; "" if there are none."""
        plan = self.plan
        said = [
            tr("3-2-1") if plan.frame is not None else "",
            tr("20 °C") if plan.temperature is not None else "",
            tr("master") if plan.master is not None else "",
        ]
        return joined(one for one in said if one)

    def values(self) -> dict[str, Any]:
        """Return the fields of the form of conditions, with those still incomplete."""
        self._follow()
        values = values_of(self.plan) | self._pending
        return values | {U_MEASURED: combined(values["budget"])}

    def complaint(self, group: str) -> str:
        """Return a sentence on what the group "frame", "temperature" or "master" lacks; "" if nothing."""
        self._follow()
        return self._complaints.get(group, "")

    def set_value(self, key: str, value: Any) -> None:
        """Change the field `key`; once its group is complete, it is written to the plan, undoable."""
        group = _group_of(key)
        if key == AT_20 and value:
            part = self._model.project.info.part_celsius
            if part is not None and -50 <= part <= 200:
                self._take("temperature", {key: value, "part_celsius": part})
                return
        if key == "primary" and not value:
            self._take(group, {key: value, "secondary": "", "tertiary": ""})
            return
        if key in ("measured_mm", U_MEASURED):  # stated by hand: no result's any more
            self._pending["doubts"] = ()
        if key == U_MEASURED:
            key, value = "budget", () if value is None else ((Cause.MASTER_MEASURED, float(value)),)
        self._take(group, {key: value})

    def take_master(self, folder: Path) -> None:
        """Read the measured lengths of a master from a project or a folder of results; undoable."""
        project, asked = self._model.folder, self.values()

        def done(master: Any) -> None:
            if project == self._model.folder:
                found = {key: getattr(master, key) for key in ("measured_mm", "budget", "same_calibration", "doubts")}
                name = self.values()["name"] or master.name
                self._take("master", found | {WITH_MASTER: True, "name": name})

        self._features.bench.run_quick(
            self._features,
            jobs.MEASURED_MASTER,
            folder,
            asked["certified_mm"],
            project,
            label=tr("Reading the master's results"),
            on_done=done,
            offers={},
        )

    # ---- inside

    def _take(self, group: str, changed: Mapping[str, Any]) -> None:
        self._follow()
        self._pending |= changed
        made, label = self._made()[group]
        try:
            plan = made(self.plan, self.values())
        except ValueError as error:
            self._complaints[group] = text_of(error)
            self._features.changed.emit()
            return
        self._pending = {key: value for key, value in self._pending.items() if _group_of(key) != group}
        self._complaints.pop(group, None)
        if plan != self.plan:
            self._of = self._set_in(plan)  # its own edit: what is half entered of the other groups stays
            self._features.put_plan(plan, label)
        else:
            self._features.changed.emit()

    def _made(self) -> Mapping[str, tuple[Callable[[InspectionPlan, Mapping[str, Any]], InspectionPlan], str]]:
        return {
            "frame": (with_frame, tr("part coordinates")),
            "temperature": (with_temperature, tr("temperature")),
            "master": (with_master, tr("master")),
        }

    def _follow(self) -> None:
        """The conditions were changed elsewhere, by an undo or a template: what was half entered is forgotten."""
        now = self._set_in(self.plan)
        if now != self._of:
            self._of = now
            self._pending, self._complaints = {}, {}

    def _set_in(self, plan: InspectionPlan) -> object:
        return self._model.folder, plan.frame, plan.temperature, plan.master


def _group_of(key: str) -> str:
    if key in FRAME:
        return "frame"
    temperature = (AT_20, *TEMPERATURES, *COEFFICIENTS)
    return "temperature" if key in temperature else "master"


def values_of(plan: InspectionPlan) -> dict[str, Any]:
    """Return the conditions of a plan as the fields of the form, defaults where the plan states none."""
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
    """List the names of the features that can be compared with a master."""
    return tuple(one.name for one in plan.features if kind_of(one).expands)


def frame_choices(plan: InspectionPlan, place: str) -> tuple[str, ...]:
    """List the names of the features that can define the part coordinates at `place`, as "primary"."""
    return tuple(one.name for one in plan.features if kind_of(one).element in FRAME[place])


def with_frame(plan: InspectionPlan, values: Mapping[str, Any]) -> InspectionPlan:
    """Return the plan with the part coordinates in the fields; ValueError, a sentence, if they are incomplete."""
    names = [str(values[key]) for key in FRAME]
    if not names[0]:
        return replace(plan, frame=None)
    if not names[1]:
        raise ValueError(tr("Choose the second feature too: the x axis points out of it, or along it."))
    if len(set(names)) < len(names):
        raise ValueError(tr("Choose three different features."))
    return replace(plan, frame=PartFrame(*names))


def with_temperature(plan: InspectionPlan, values: Mapping[str, Any]) -> InspectionPlan:
    """Return the plan with lengths at 20 °C by the fields, or as measured if that is switched off."""
    if not values[AT_20]:
        return replace(plan, temperature=None)
    known: dict[str, Any] = {key: float(values[key]) for key in TEMPERATURES}
    known |= {key: values[key] / PER_KELVIN for key in COEFFICIENTS}
    return replace(plan, temperature=Temperature(**known))


def with_master(plan: InspectionPlan, values: Mapping[str, Any]) -> InspectionPlan:
    """Return the plan with the master in the fields; ValueError, a sentence, if they are incomplete."""
    if not values[WITH_MASTER]:
        return replace(plan, master=None)
    if not str(values["name"]).strip():
        raise ValueError(tr("Give the master a name: the report prints it."))
    if values["certified_mm"] is None:
        raise ValueError(tr("Enter its length by the certificate."))
    if values["u_certified_mm"] is None:
        raise ValueError(tr("Enter its u by the certificate: what is stated there as U, over k."))
    if values["measured_mm"] is None:
        raise ValueError(tr("Enter what was measured of it, or take it from results."))
    if not values["budget"]:
        raise ValueError(tr("Enter the u of what was measured of it, or take it from results."))
    features = tuple(name for name in comparable(plan) if values[COMPARED + name])
    if not features:
        raise ValueError(tr("Choose a feature that is compared with it."))
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
            doubts=tuple(values["doubts"]),
        ),
    )


def combined(budget: Sequence[tuple[str, float]]) -> float | None:
    """Compute the combined standard uncertainty in mm of a master's budget, to be shown; None if it is empty."""
    return None if not budget else round(math.hypot(*(u for _, u in budget)), 6)


def _master_values(master: Master | None) -> dict[str, Any]:
    if master is None:
        first = {"name": "", "budget": (), "same_calibration": True, "doubts": ()}  # nothing unstated is zero
        return dict.fromkeys(MASTER) | first
    return {key: getattr(master, key) for key in MASTER}
