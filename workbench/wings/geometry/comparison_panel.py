"""The panel of a comparison: with what, how it is aligned, and what came of it."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import QCheckBox, QPushButton, QWidget

from core.wings.geometry.comparison.facts import comparison_facts
from core.wings.geometry.comparison.shown import ALIGNED, AUTOMATIC
from workbench.language import text_of, tr
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.words import show_facts
from workbench.theme import icon
from workbench.views import ask
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import enable, in_column, in_row
from workbench.views.lists.value_rows import ValueRows
from workbench.wings.geometry.comparison import InspectComparison


class ComparisonPanel(QWidget):
    """Panel of the comparison: wear, before and after, or the part and its nominal surface."""

    def __init__(
        self, presenter: InspectPresenter, comparison: InspectComparison, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._presenter, self._comparison = presenter, comparison
        self.file = QPushButton(icon("mdi6.file-compare"), tr("With a file …"))
        self.project = QPushButton(icon("mdi6.folder-open-outline"), tr("With a project …"))
        self.form = SettingsForm()
        self.form.add_choice(
            "align",
            tr("Alignment"),
            [
                (AUTOMATIC, tr("automatic")),
                *((name, text_of(shown)) for name, shown in ALIGNED.items()),
            ],
            tr("Automatic: by part coordinates if both scans have them, else as both were measured."),
        )
        self.form.add_number(
            "diameter_mm",
            tr("Over circles of"),
            NumberRange(0.1, 100, decimals=1, step=1.0, unit="mm", none_text=tr("automatic"), first=10.0),
            tr("What is averaged: a larger circle shows smaller deviations, a smaller one finer places."),
        )
        self.significant = QCheckBox(tr("Grey where not significant"))
        self.beside = QCheckBox(tr("Show the other surface"))
        self.rows = ValueRows()
        self.away = QPushButton(icon("mdi6.close"), tr("Remove"))
        in_column(
            in_row((self.file, 1), (self.project, 1)),
            *(self.form, self.rows, self.significant, self.beside, in_row((self.away, 1))),
            on=self,
            spacing=4,
        )
        self.file.clicked.connect(self._choose_file)
        self.project.clicked.connect(self._choose_project)
        self.form.edited.connect(self._comparison.set_value)
        self.significant.toggled.connect(self._comparison.show_significant_only)
        self.beside.toggled.connect(self._comparison.show_beside)
        self.away.clicked.connect(lambda: self._comparison.take_away())

    def refresh(self) -> None:
        """Show the comparison's settings and result, and which buttons are enabled."""
        comparison = self._comparison
        can, shown = comparison.buttons, comparison.shown
        enable(self.file, can.compare, tr("Compare the scan with a PLY, STL, STEP or E57 file in mm"))
        enable(
            self.project,
            can.compare,
            tr("Compare the scan with that of another project, or with another folder of results"),
        )
        enable(self.away, can.take_away, tr("Show it no more, and take it out of the results and the report"))
        self.form.set_values({"align": comparison.align, "diameter_mm": comparison.diameter_mm})
        self.significant.setChecked(comparison.significant_only)
        self.beside.setChecked(comparison.shows_other)
        for box in (self.significant, self.beside):
            enable(box, can.look, "")
        for widget in (self.rows, self.significant, self.beside, self.away):
            widget.setVisible(shown is not None)
        show_facts(self.rows, () if shown is None else comparison_facts(shown))

    def _choose_file(self) -> None:
        kinds = tr("Surfaces (*.ply *.stl *.step *.stp *.e57)")
        self._compare(ask.choose_file_to_open(self, tr("Compare with"), self._start, kinds))

    def _choose_project(self) -> None:
        self._compare(ask.choose_folder(self, tr("Compare with"), self._start))

    @property
    def _start(self) -> Path:
        folder = self._presenter.model.folder
        return Path.home() if folder is None else folder.parent

    def _compare(self, other: Path | None) -> None:
        if other is not None:
            self._comparison.compare(other)
