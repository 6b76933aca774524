"""A study being made: its table, pasted, from a file or from other projects; its limits."""

from __future__ import annotations

from PySide6.QtGui import QFontDatabase
from PySide6.QtWidgets import QLabel, QPlainTextEdit, QPushButton, QVBoxLayout, QWidget

from core.wings.studies.kinds.study import KINDS
from workbench.language import tr
from workbench.theme import icon, shades
from workbench.views import ask
from workbench.views.common import dress
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import STRETCH, Folding, enable, heading, in_column, in_row, muted, set_text
from workbench.wings.studies.studies import HEADS, LIMITS, Draft, InspectStudies

FORM_WIDTH, NARROW_WIDTH = 300, 250
"""Pixels of the fields, and of a single one; the table beside them takes the rest."""
MOST_HEAD_PX = 160
"""A longer line of names scrolls, or the fields would have no room beside the table."""
BESIDE_PX = 40
"""Left and right of the table's text, its scroll bar included."""
LONGEST = 5000.0
"""The largest value in mm that can be entered."""


class StudyEditor(QWidget):
    """Editor of a study: table at the left, settings at the right, buttons below."""

    def __init__(self, studies: InspectStudies, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._studies = studies
        self.title, self.help, self.problem = heading(""), muted(), QLabel()
        self.problem.setWordWrap(True)
        self.text = QPlainTextEdit()
        self.text.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.text.setAccessibleName(tr("Table of the study"))
        self.text.setTabChangesFocus(True)
        self.text.setLineWrapMode(QPlainTextEdit.LineWrapMode.NoWrap)  # a line is a row
        self.text.textChanged.connect(self._written)
        self.forms = {"grr": self._grr_form(), "acceptance": self._acceptance_form(), "series": self._series_form()}
        self.open = QPushButton(icon("mdi6.table-arrow-left"), tr("Open a table …"))
        self.add = QPushButton(icon("mdi6.folder-plus-outline"), tr("Add a project …"))
        self.make = QPushButton(icon("mdi6.check", colour="on_accent"), tr("Make the study"))
        self.cancel = QPushButton(tr("Cancel"))
        self.make.setProperty("primary", True)
        self.cancel.setToolTip(tr("Make no study; the table is given up"))
        self.open.clicked.connect(self._open)
        self.add.clicked.connect(self._add)
        self.make.clicked.connect(lambda: self._studies.finish())
        self.cancel.clicked.connect(lambda: self._studies.give_up())
        side = QVBoxLayout()
        for kind, form in self.forms.items():
            form.setFixedWidth(NARROW_WIDTH if kind == "grr" else FORM_WIDTH)
            side.addLayout(in_row(form, STRETCH))  # alone in a column, its help would count on all of the width
        side.addStretch(1)
        both = Folding(in_row(self.text), side, spacing=14, share=4)
        sources = in_row(self.open, self.add, STRETCH, spacing=6)
        ends = in_row(STRETCH, self.cancel, self.make, spacing=6)
        in_column(self.title, self.help, (both, 1), self.problem, Folding(sources, ends, spacing=6), on=self)
        self._dress()

    def refresh(self) -> None:
        """Show the draft's table and settings, and which buttons are enabled."""
        self._dress()
        studies, draft = self._studies, self._studies.draft
        if draft is None:
            return
        self.title.setText(tr(KINDS[draft.kind]))
        self.help.setText(self._help(draft))
        head = self.text.fontMetrics().horizontalAdvance(HEADS[draft.kind].strip())
        self.text.setMinimumWidth(min(head, MOST_HEAD_PX) + BESIDE_PX)
        if self.text.toPlainText() != draft.text:
            self.text.setPlainText(draft.text)
        for kind, form in self.forms.items():
            form.setVisible(kind == draft.kind)
        self.forms[draft.kind].set_values(draft.values)
        set_text(self.problem, studies.problem)
        self._show_buttons(draft)

    def _show_buttons(self, draft: Draft) -> None:
        can = self._studies.buttons
        enable(self.open, can.read, tr("A CSV file with these columns, in any order"))
        enable(self.add, can.read, self._add_tip(draft))
        enable(self.make, can.make, tr("Work the study out and keep it in the project"))

    def _written(self) -> None:
        self._studies.write(self.text.toPlainText())
        if self._studies.draft is not None:
            self._show_buttons(self._studies.draft)

    def _help(self, draft: Draft) -> str:
        if draft.kind == "grr":
            return tr(
                "One line per measurement: part, operator, value in mm, with semicolons, commas or tabs between them, "
                "or pasted from a spreadsheet. Every operator measures every part equally often; 10 parts, 3 operators "
                "and 2 to 3 repeats are usual."
            )
        if draft.kind == "series":
            return tr(
                "One line per part, in the order of measuring: part, value and its standard uncertainty u in mm, with "
                "semicolons, commas or tabs between them; the column u may be left out. Control limits need 20 points "
                "or more."
            )
        return tr(
            "One line a reading: quantity (form, size, spacing or flatness), position, measured and calibrated value "
            "and u of the latter in mm. After the pattern of VDI/VDE 2634-2: 10 positions for a sphere, 7 for a ball "
            "bar, 6 for a plane. It is no certificate."
        )

    def _add_tip(self, draft: Draft) -> str:
        if draft.kind == "grr":
            return tr("Add part, operator and thickness of another project, a line for each of its repeats")
        if draft.kind == "series":
            return tr("Add part, characteristic and u of another project; in the order of measuring")
        return tr("Look for the artefact in another project's scan, and add what is found as one position")

    def _grr_form(self) -> SettingsForm:
        form = SettingsForm()
        form.add_number(
            "tolerance_mm",
            tr("Tolerance ±"),
            NumberRange(0.0001, LONGEST, decimals=4, step=0.01, unit="mm", none_text=tr("none"), first=0.1),
            tr(
                "Of the parts; %GRR is stated relative to its full width T. None: relative to the scatter of the parts."
            ),
        )
        form.edited.connect(self._studies.set_value)
        return form

    def _series_form(self) -> SettingsForm:
        form = SettingsForm()
        form.add_text(
            "name",
            tr("Characteristic"),
            tr("As results call it: thickness, or feature and characteristic, as top flatness."),
        )
        form.add_number(
            "nominal_mm",
            tr("Nominal"),
            NumberRange(0.0001, LONGEST, decimals=4, step=1.0, unit="mm", none_text=tr("none"), first=50.0),
            tr("None: control charts alone, without Cp and Cpk."),
        )
        form.add_number(
            "tolerance_mm",
            tr("Tolerance ±"),
            NumberRange(0.0001, LONGEST, decimals=4, step=0.01, unit="mm", none_text=tr("none"), first=0.1),
            tr("Of the parts, to either side of the nominal value."),
        )
        form.add_number(
            "size",
            tr("Subgroup"),
            NumberRange(1, 25, decimals=0, step=1),
            tr("So many parts in a row are a subgroup, as made within a short time; 1: single values."),
        )
        form.edited.connect(self._studies.set_value)
        return form

    def _acceptance_form(self) -> SettingsForm:
        form = SettingsForm()
        form.add_section(tr("Largest permitted error"))
        titles = {
            "form": (tr("Form"), tr("Probing error of a sphere: range about it.")),
            "size": (tr("Size"), tr("Probing error of a sphere: its diameter.")),
            "spacing": (tr("Spacing"), tr("Distance of a ball bar's spheres.")),
            "flatness": (tr("Flatness"), tr("Range about a plane.")),
        }
        for key in LIMITS:
            form.add_number(
                key,
                titles[key][0],
                NumberRange(0.0001, 100.0, decimals=4, step=0.01, unit="mm", none_text=tr("none"), first=0.05),
                titles[key][1],
            )
        form.add_section(tr("Artefact of the projects added"))
        kinds = [("sphere", tr("sphere")), ("bar", tr("ball bar")), ("plane", tr("plane"))]
        form.add_choice("artefact", tr("Kind"), kinds, tr("What stands in their scans."))
        for key, title, help in (
            ("calibrated_mm", tr("Calibrated"), tr("Diameter of the sphere, or spacing of the bar.")),
            ("u_mm", tr("Calibrated, u"), tr("Standard uncertainty of that.")),
            ("diameter_mm", tr("Spheres of the bar"), tr("Their diameter, by which they are found.")),
        ):
            form.add_number(key, title, NumberRange(0.0, LONGEST, decimals=4, step=1.0, unit="mm"), help)
        form.edited.connect(self._studies.set_value)
        return form

    def _open(self) -> None:
        path = ask.choose_file_to_open(
            self, tr("Table of the study"), self._studies.model.folder, tr("Table (*.csv *.txt *.tsv)")
        )
        if path is not None:
            self._studies.open_table(path)

    def _add(self) -> None:
        folder = ask.choose_folder(self, tr("Project"), self._studies.bench.settings.projects_folder)
        if folder is not None:
            self._studies.add_project(folder)

    def _dress(self) -> None:
        dress(self.problem, f"color: {shades().bad};")
