"""Part coordinates, temperature and master of the features, in one form with a line of help each."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QTimer
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from core.inspect.plan.inspection_plan import InspectionPlan
from workbench.language import tr
from workbench.pages.inspect.features import conditions as fields
from workbench.pages.inspect.features.conditions import InspectConditions
from workbench.refresh import Refresh
from workbench.theme import icon, shades
from workbench.views import ask
from workbench.views.common import dress
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import in_column, muted, set_text

LONGEST = 5000.0
"""The longest master in mm that can be entered."""


class ConditionsPanel(QWidget):
    """Panel of the conditions; the form is made anew where choices change or a group is switched on or off."""

    def __init__(self, conditions: InspectConditions, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._refreshing = Refresh(self.refresh, self)
        self._conditions = conditions
        self._made: object = None
        self._inside = QWidget()
        self.forms: dict[str, SettingsForm] = {}
        self.complaints: dict[str, QLabel] = {}
        self.take: QPushButton | None = None
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.addWidget(muted(
            tr("They apply to the features, to the thickness only where it is one of them.")
        ))  # fmt: skip
        self._column.addWidget(self._inside)

    def refresh(self) -> None:
        """Show the fields of the conditions, with help or what is missing under each group."""
        conditions, plan = self._conditions, self._conditions.plan
        if not self.isVisible():
            return
        choices = [fields.frame_choices(plan, place) for place in fields.FRAME]
        framed = bool(conditions.values()["primary"])
        made = (choices, fields.comparable(plan), framed, conditions.temperature_is_on, conditions.master_is_on)
        if made != self._made:
            self._made = made
            QTimer.singleShot(0, self, self._make_anew)  # in a turn of its own: the edit took its time
        self._show()

    def _make_anew(self) -> None:
        self._make(self._conditions.plan)
        self._show()

    def _show(self) -> None:
        conditions = self._conditions
        self._dress()
        values = conditions.values()
        for form in self.forms.values():
            form.set_values(values)
        for group, label in self.complaints.items():
            set_text(label, conditions.complaint(group))

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._refreshing.soon()  # not now: Qt is in the middle of showing what would change

    # ---- making it

    def _make(self, plan: InspectionPlan) -> None:
        self._column.removeWidget(self._inside)
        self._inside.hide()
        self._inside.deleteLater()  # its editors may be telling of the very edit that ends them
        self._inside, self.forms, self.complaints, self.take = QWidget(self), {}, {}, None
        column = in_column(on=self._inside, margins=(0, 4, 0, 0), spacing=4)
        for group, add in (("frame", self._add_frame), ("temperature", self._add_temperature)):
            self._add_group(column, group, add, plan)
        self._add_group(column, "master", self._add_master, plan)
        if self._conditions.master_is_on:
            self.take = QPushButton(icon("mdi6.folder-open-outline"), tr("Take from its results"))
            self.take.setToolTip(tr("The project, or folder of results, in which the master was measured"))
            self.take.clicked.connect(self._take)
            column.addWidget(self.take)
        self._column.addWidget(self._inside)
        self._dress()

    def _add_group(
        self, column: QVBoxLayout, group: str, add: Callable[[SettingsForm, InspectionPlan], None], plan: InspectionPlan
    ) -> None:
        form, complaint = SettingsForm(), QLabel()
        complaint.setWordWrap(True)
        add(form, plan)
        form.edited.connect(self._conditions.set_value)
        self.forms[group], self.complaints[group] = form, complaint
        column.addWidget(form)
        column.addWidget(complaint)

    def _add_frame(self, form: SettingsForm, plan: InspectionPlan) -> None:
        form.add_section(tr("Part coordinates (3-2-1)"))
        none = {"primary": tr("the camera's"), "secondary": tr("choose"), "tertiary": tr("middle of the second")}
        said = {
            "primary": (tr("z points out of"), tr("A plane: z is 0 on it. The camera's: its own coordinates.")),
            "secondary": (tr("x points out of"), tr("A second plane, or an axis to point along.")),
            "tertiary": (tr("Origin at"), tr("A third feature that fixes y.")),
        }
        shown = tuple(said) if self._conditions.values()["primary"] else ("primary",)
        for place in shown:
            choices = [("", none[place]), *((name, name) for name in fields.frame_choices(plan, place))]
            form.add_choice(place, said[place][0], choices, said[place][1])

    def _add_temperature(self, form: SettingsForm, plan: InspectionPlan) -> None:
        form.add_section(tr("Temperature"))
        form.add_check(fields.AT_20, tr("State lengths at 20 °C"), tr("Off: as the part was when scanned."))
        if not self._conditions.temperature_is_on:
            return
        self._celsius(form, "part", tr("Part"), tr("Its temperature while it was scanned."))
        self._celsius(form, "u_part", tr("Part, u"), tr("Standard uncertainty; 0.3 for ±0.5 °C."))
        self._per_kelvin(form, "alpha", tr("Expansion"), tr("Steel 11.5, aluminium 23, brass 19, glass 8."))
        self._per_kelvin(form, "u_alpha", tr("Expansion, u"), tr("Standard uncertainty; 0.6 for ±1."))
        self._celsius(form, "scale", tr("Target"), tr("The target's when the camera was calibrated."))
        self._celsius(form, "u_scale", tr("Target, u"), tr("Standard uncertainty of that."))
        help = tr("Of the target's plate; 0: its size holds as it is.")
        self._per_kelvin(form, "scale_alpha", tr("Target's expansion"), help)
        self._per_kelvin(form, "u_scale_alpha", tr("Target's, u"), tr("Standard uncertainty of that."))

    def _celsius(self, form: SettingsForm, key: str, label: str, help: str) -> None:
        u = key.startswith("u_")
        form.add_number(
            f"{key}_celsius",
            label,
            NumberRange(0.0 if u else -50.0, 20.0 if u else 200.0, decimals=2, step=0.1, unit="°C"),
            help,
        )

    def _per_kelvin(self, form: SettingsForm, key: str, label: str, help: str) -> None:
        least = 0.0 if key.startswith("u_") else -100.0
        form.add_number(key, label, NumberRange(least, 1000.0, decimals=2, step=0.5, unit="× 10⁻⁶/K"), help)

    def _add_master(self, form: SettingsForm, plan: InspectionPlan) -> None:
        form.add_section(tr("Master"))
        form.add_check(
            fields.WITH_MASTER, tr("Compare with a master"),
            tr("What the rig gets wrong on a known block is taken off the part."),
        )  # fmt: skip
        if not self._conditions.master_is_on:
            return
        form.add_text("name", tr("Name"), tr("With its number, as the certificate has it."))
        for key, label, help in (
            ("certified_mm", tr("Certified length"), tr("By the certificate, at 20 °C.")),
            ("u_certified_mm", tr("Certified, u"), tr("Standard uncertainty: the certificate's U over k.")),
            ("measured_mm", tr("Measured length"), tr("As this rig measured it; at 20 °C if the part's is.")),
            (fields.U_MEASURED, tr("Measured, u"), tr("Typed in, it is one row of the budget.")),
        ):
            u = key.startswith("u_")
            form.add_number(
                key,
                label,
                NumberRange(
                    0.0 if u else 0.001,
                    LONGEST,
                    decimals=5,
                    step=0.001 if u else 1.0,
                    unit="mm",
                    none_text=tr("not stated") if u else tr("none"),
                    first=0.001 if u else 50.0,
                ),
                help,
            )
        form.add_check(
            "same_calibration", tr("Measured with this calibration"),
            tr("Then what camera and laser get wrong cancels."),
        )  # fmt: skip
        for name in fields.comparable(plan):
            form.add_check(fields.COMPARED + name, tr("Compare {name}", name=name))
        if not fields.comparable(plan):
            form.add_section(tr("There is no feature with a length yet: add one first."))

    def _take(self) -> None:
        folder = ask.choose_folder(self, tr("Project or results of the master"), self._conditions.projects_folder)
        if folder is not None:
            self._conditions.take_master(folder)

    def _dress(self) -> None:
        for label in self.complaints.values():
            dress(label, f"font-size: 11px; color: {shades().bad};")
