"""The series of repeats: table, statistics, run chart."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QSizePolicy, QSplitter, QWidget

from core.files.project.data import Repeat
from core.report.facts.fact import Fact
from core.report.facts.of_repeats import repeat_facts
from workbench.language import tr
from workbench.pages.inspect import words
from workbench.pages.inspect.repeats.repeats import InspectRepeats
from workbench.pages.words import show_facts
from workbench.theme import icon
from workbench.views.layouts import STRETCH, Folding, Tabs, UpAndDown, enable, in_column, in_row, muted, set_text
from workbench.views.lists.data_table import DataTable
from workbench.views.lists.value_rows import ValueRows
from workbench.views.plots.runs import Histogram, RunChart
from workbench.wing import PartOfWing

ROWS_PX = 230
"""Least width of the statistics."""
CHART_PX = 260, 236
"""Least width and height of a chart: what its lines mean can be read in it."""
CALIBRATION = 3
"""Column of the calibration that a scan was measured with."""


class RepeatsTab(QWidget):
    """Tab with all repeats of the project and their statistics."""

    def __init__(
        self, repeats: InspectRepeats, parts: Sequence[PartOfWing] = (), parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._repeats = repeats
        self.parts = parts
        self._shown: object = None
        self.table, self.chart, self.words = DataTable(), RunChart(), muted()
        self.rows = ValueRows(least_width=ROWS_PX)
        self.histogram = Histogram()
        self.table.set_headers(
            [
                (tr("Scan"), ""),
                (tr("Thickness"), "mm"),
                (tr("U"), "mm"),
                (tr("Calibration"), ""),
                (tr("Scanned"), ""),
            ]
        )
        self.table.let_shrink(0)
        self.add = QPushButton(icon("mdi6.playlist-plus"), tr("Add this scan"))
        self.remove = QPushButton(icon("mdi6.playlist-remove"), tr("Remove"))
        self.copy = QPushButton(icon("mdi6.content-copy"), tr("Copy all"))
        self.add.clicked.connect(lambda: repeats.add())
        self.remove.clicked.connect(lambda: repeats.remove([self.table.current_row()]))
        self.copy.clicked.connect(self._copy)
        self.table.current_row_changed.connect(lambda _: self._show_buttons())
        buttons = QHBoxLayout()
        for button in (self.add, self.remove, self.copy):
            buttons.addWidget(button)
        buttons.addStretch(1)
        above = QWidget()
        in_column(self.words, (self.table, 1), buttons, on=above)
        self.charts = Tabs()
        self.charts.add(self.chart, tr("In their order"))
        self.charts.add(self.histogram, tr("Histogram"))
        self.charts.setMinimumSize(*CHART_PX)
        self.charts.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Ignored)  # as high as there is room
        numbers = in_column(self.rows, *(part.widget for part in parts), STRETCH, margins=(0, 6, 0, 0))
        self.below = UpAndDown(Folding(in_row(self.charts, margins=(0, 6, 0, 0)), numbers, spacing=14))
        split = QSplitter(Qt.Orientation.Vertical)
        split.addWidget(above)
        split.addWidget(self.below)
        split.setSizes([200, 400])  # where both are low, the chart has room for its axis
        split.setChildrenCollapsible(False)
        in_column(split, on=self, margins=(6, 6, 6, 4))

    def refresh(self) -> None:
        """Show the state of the presenter."""
        spec = self._repeats.spec
        wanted = (self._repeats.all, spec.nominal_mm, spec.tolerance_mm)
        self._show_buttons()
        set_text(self.words, self._sentence())
        if wanted != self._shown:
            self._shown = wanted
            self._show_series()
        for part in self.parts:
            part.refresh()

    def _show_series(self) -> None:
        repeats, spec = self._repeats, self._repeats.spec
        self.table.set_rows([words.repeat_row(repeat) for repeat in repeats.all], [self._tip(r) for r in repeats.all])
        self.table.table.setColumnHidden(CALIBRATION, repeats.calibrations() < 2)  # the tip of a row tells it, too
        statistics = repeats.statistics()
        if statistics is None:
            self.rows.set_rows([])
            self.histogram.clear(tr("There are no repeats yet."))
            self.chart.clear(tr("Two scans or more of the same part show how well the measurement repeats."))
            return
        show_facts(self.rows, self._facts())
        self.chart.set_runs(
            [repeat.thickness_mm for repeat in repeats.all],
            [repeat.U_mm for repeat in repeats.all],
            labels=[words.scan_name(repeat.scan) for repeat in repeats.all],
            mean=statistics.mean_mm,
            nominal=spec.nominal_mm,
            tolerance=spec.tolerance_mm,
            k=repeats.all[-1].k,
        )
        limits = []
        if spec.nominal_mm is not None and spec.tolerance_mm is not None:
            limits.append((spec.nominal_mm - spec.tolerance_mm, tr("lower limit")))
            limits.append((spec.nominal_mm + spec.tolerance_mm, tr("upper limit")))
        self.histogram.set_values(
            [repeat.thickness_mm for repeat in repeats.all], label=tr("thickness"), unit="mm", limits=limits
        )

    def _facts(self) -> Sequence[Fact]:
        statistics = self._repeats.statistics()
        return () if statistics is None else repeat_facts(statistics, nominal=self._repeats.spec.nominal_mm)

    def _show_buttons(self) -> None:
        repeats = self._repeats
        can = repeats.buttons(chosen=0 <= self.table.current_row() < len(repeats.all))
        enable(self.add, can.add, tr("Add the thickness of this scan to the series"))
        enable(self.remove, can.remove, tr("Take the chosen repeat out of the series"))
        enable(self.copy, can.copy, tr("Copy the whole series with its statistics, tabs between the columns"))

    def _sentence(self) -> str:
        repeats = self._repeats
        if not repeats.all:
            return tr("No repeats yet: measure a scan, add it here, then scan the part again. Each scan counts once.")
        if repeats.calibrations() > 1:
            return tr(
                "Measured with {count} different calibrations: their differences are part of the scatter.",
                count=repeats.calibrations(),
            )
        return ""

    def _tip(self, repeat: Repeat) -> str:
        return tr(
            "Recording {recording}, calibration {calibration}", recording=repeat.scan, calibration=repeat.calibration_id
        )

    def _copy(self) -> None:
        repeats = self._repeats
        QGuiApplication.clipboard().setText(
            words.repeats_tsv(repeats.all, self._facts(), *(part.facts() for part in self.parts))
        )
