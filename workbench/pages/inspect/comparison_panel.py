"""The panel of a comparison: with what, how it is aligned, and what came of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QCheckBox, QPushButton, QWidget

from core.inspect.shown.shown_comparison import ALIGNED, AUTOMATIC
from workbench.language import number, text_of, tr
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.words import wording
from workbench.theme import icon
from workbench.views import ask
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import enable, in_column, in_row
from workbench.views.lists.value_rows import ValueRow, ValueRows

if TYPE_CHECKING:
    from core.inspect.shown.shown_comparison import Changed, ShownComparison


class ComparisonPanel(QWidget):
    """Wear, before and after, or the part and what it should be."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter, self._comparison = presenter, presenter.comparison
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
        """Show what the presenter says now."""
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
        self.beside.setChecked(comparison.beside)
        for box in (self.significant, self.beside):
            enable(box, can.look, "")
        for widget in (self.rows, self.significant, self.beside, self.away):
            widget.setVisible(shown is not None)
        self.rows.set_rows([] if shown is None else _rows(shown))

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


def _rows(shown: ShownComparison) -> list[ValueRow]:
    """What a comparison came to."""
    chance = tr("Significant at 95 %: by chance alone up to 5 % of the places of an unchanged part are")
    detectable = tr("Median of the level of detection: 1.96 times the standard uncertainty of a deviation")
    registration = tr("Standard uncertainty of how both lie on each other, by what most of the surface shows")
    diameter = wording().general(shown.diameter_mm)
    circles = tr("{n} of {diameter} mm", n=number(shown.places, ",d"), diameter=diameter)
    return [
        (tr("Compared with"), shown.other, text_of(ALIGNED[shown.alignment]), ""),
        (tr("Less material"), _changed(shown.lower), _more(shown.lower) + chance, "warn" if shown.lower.share else ""),
        (
            tr("More material"),
            _changed(shown.higher),
            _more(shown.higher) + chance,
            "warn" if shown.higher.share else "",
        ),
        (tr("Detectable"), tr("from {lod} mm on", lod=wording().fixed(shown.lod95_mm, 3)), detectable, ""),
        (tr("Registration"), f"{wording().fixed(shown.registration_mm, 4)} mm", registration, ""),
        (tr("Circles"), circles, "", ""),
    ]


def _changed(part: Changed) -> str:
    """'12.3 %, mean −0.101 mm'."""
    if not part.share:
        return tr("nowhere significant")
    mean = wording().fixed(part.mean_mm, 3, signed=True)
    return tr("{share} %, mean {mean} mm", share=number(100 * part.share, ".1f"), mean=mean)


def _more(part: Changed) -> str:
    """What the row has no room for."""
    if not part.share:
        return ""
    extreme = wording().fixed(part.extreme_mm, 3, signed=True)
    return tr("Of the places; at most {extreme} mm.", extreme=extreme) + " "
