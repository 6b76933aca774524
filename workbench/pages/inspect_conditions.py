"""What the features of a plan have in common: part coordinates, temperature, master. Every edit is undoable."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject

from core.inspect.inspection_plan import InspectionPlan
from workbench import jobs
from workbench.pages import inspect_condition_values as fields

if TYPE_CHECKING:
    from workbench.pages.inspect_features import InspectFeatures


class InspectConditions(QObject):
    """What stands in the form; what says too little for the plan yet is kept here, with a sentence."""

    def __init__(self, owner: InspectFeatures) -> None:
        super().__init__(owner)
        self._owner = owner
        self._pending: dict[str, Any] = {}
        self._complaints: dict[str, str] = {}
        self._of: object = None

    @property
    def plan(self) -> InspectionPlan:
        """Whose conditions they are."""
        return self._owner.plan

    @property
    def temperature_is_on(self) -> bool:
        """Whether lengths are stated at 20 °C."""
        return bool(self.values()[fields.AT_20])

    @property
    def master_is_on(self) -> bool:
        """Whether a master is compared with, or being entered."""
        return bool(self.values()[fields.WITH_MASTER])

    @property
    def in_short(self) -> str:
        """What is set, in a few words, or ""."""
        plan = self.plan
        said = [
            self.tr("3-2-1") if plan.frame is not None else "",
            self.tr("20 °C") if plan.temperature is not None else "",
            self.tr("master") if plan.master is not None else "",
        ]
        return ", ".join(one for one in said if one)

    def values(self) -> dict[str, Any]:
        """The fields as they stand in the form."""
        self._follow()
        values = fields.values_of(self.plan) | self._pending
        return values | {fields.U_MEASURED: fields.combined(values["budget"])}

    def complaint(self, group: str) -> str:
        """What the fields of a group ("frame", "temperature", "master") still lack, or ""."""
        self._follow()
        return self._complaints.get(group, "")

    def set_value(self, key: str, value: Any) -> None:
        """Change a field; as soon as its group says enough the plan has it."""
        group = _group_of(key)
        if key == fields.AT_20 and value:
            part = self._owner.owner.project.info.part_celsius
            if part is not None and -50 <= part <= 200:
                self._take("temperature", {key: value, "part_celsius": part})
                return
        if key == "primary" and not value:
            self._take(group, {key: value, "secondary": "", "tertiary": ""})
            return
        if key == fields.U_MEASURED:
            key, value = "budget", ((fields.MEASUREMENT, float(value)),)
        self._take(group, {key: value})

    def take_master(self, folder: Path) -> None:
        """Take what was measured of the master from a project, or a folder of results; undoable."""
        project, asked = self._owner.owner.model.folder, self.values()

        def done(master: Any) -> None:
            if project == self._owner.owner.model.folder:
                found = {key: getattr(master, key) for key in ("measured_mm", "budget", "same_calibration")}
                name = self.values()["name"] or master.name
                self._take("master", found | {fields.WITH_MASTER: True, "name": name})

        self._owner.owner.bench.glance(
            jobs.MEASURED_MASTER,
            folder,
            asked["certified_mm"],
            project,
            label=self.tr("Reading the master's results"),
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
            self._complaints[group] = str(error)
            self._owner.changed.emit()
            return
        self._pending = {key: value for key, value in self._pending.items() if _group_of(key) != group}
        self._complaints.pop(group, None)
        if plan != self.plan:
            self._of = self._set_in(plan)  # its own edit: what is half entered of the other groups stays
            self._owner.put_plan(plan, label)
        else:
            self._owner.changed.emit()

    def _made(self) -> Mapping[str, tuple[Callable[[InspectionPlan, Mapping[str, Any]], InspectionPlan], str]]:
        return {
            "frame": (fields.with_frame, self.tr("part coordinates")),
            "temperature": (fields.with_temperature, self.tr("temperature")),
            "master": (fields.with_master, self.tr("master")),
        }

    def _follow(self) -> None:
        """The conditions were changed elsewhere, by an undo or a template: what was half entered is forgotten."""
        now = self._set_in(self.plan)
        if now != self._of:
            self._of = now
            self._pending, self._complaints = {}, {}

    def _set_in(self, plan: InspectionPlan) -> object:
        return self._owner.owner.model.folder, plan.frame, plan.temperature, plan.master


def _group_of(key: str) -> str:
    if key in fields.FRAME:
        return "frame"
    temperature = (fields.AT_20, *fields.TEMPERATURES, *fields.COEFFICIENTS)
    return "temperature" if key in temperature else "master"
