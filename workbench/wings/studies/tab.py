"""Studies of the measurement: the list with what goes into the report, and what the chosen one says."""

from __future__ import annotations

from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QScrollArea,
    QStackedWidget,
    QWidget,
)

from core.files.project.data import KeptStudy
from core.wings.studies.kinds.study import KINDS
from core.wings.studies.study_facts import study_facts, study_tables
from workbench.language import named, text_of, tr
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.words import show_facts, show_table
from workbench.theme import icon
from workbench.views import ask
from workbench.views.layouts import STRETCH, Folding, UpAndDown, enable, in_column, in_row, muted
from workbench.views.lists.data_table import DataTable
from workbench.views.lists.tree_model import Cell, TreeList, TreeRow
from workbench.views.lists.value_rows import ValueRows
from workbench.views.plots.control import ControlPlot
from workbench.wings.studies import words
from workbench.wings.studies.editor import StudyEditor
from workbench.wings.studies.studies import InspectStudies

MOST_ROWS = 5
"""Of the list of studies; what does not fit is scrolled to."""
MOST_IN_SIGHT = 8
"""Rows of a study's table that are seen without scrolling within it."""
ROWS_PX = 250
"""Least width of the numbers, which stand below the table where both are not seen whole side by side."""
MARGIN_PX = 6
"""Left and right of all."""
BESIDE_PX = 24
"""Left and right of a study's kind and the box before it."""


def studies_tab(presenter: InspectPresenter) -> StudiesTab:
    """Make the tab of studies for the page Inspect."""
    studies = InspectStudies(presenter.bench, presenter.repeats)
    studies.changed.connect(presenter.changed)
    return StudiesTab(studies)


class StudiesTab(QWidget):
    """Tab with the list above and the study below; in its place the editor while one is being made."""

    def __init__(self, studies: InspectStudies, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.studies = studies
        self._shown: tuple[KeptStudy, ...] = ()
        self._shown_study: object = None
        self.list, self.rows = TreeList((tr("In the report"), tr("Made of"))), ValueRows(least_width=ROWS_PX)
        self.table = DataTable()
        self.charts = (ControlPlot(), ControlPlot())
        self.title, self.words, self.notes = QLabel(), muted(), muted()
        self.title.setObjectName("heading")
        self.title.setWordWrap(True)
        self.editor = StudyEditor(studies)
        self.buttons: dict[str, QPushButton] = {}
        self.stack = QStackedWidget()
        self.stack.addWidget(self._kept())
        self.stack.addWidget(UpAndDown(self.editor))
        scroll = QScrollArea()  # studies are rare: their tables and forms must not make the smallest window larger
        scroll.setWidget(self.stack)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        self._bar = scroll.verticalScrollBar()
        in_column(scroll, on=self, margins=(MARGIN_PX, 6, MARGIN_PX, 4))

    def refresh(self) -> None:
        """Show the list of studies and the chosen study, or the editor of the draft."""
        studies = self.studies
        self.stack.setCurrentIndex(0 if studies.draft is None else 1)
        if studies.draft is not None:
            self.editor.refresh()
            return
        self._show_list()
        self._show_buttons()
        self._show_study()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit_table()

    # ---- making it

    def _kept(self) -> QWidget:
        inside = QWidget()
        column = in_column(self.words, on=inside)
        studies = self._row((
            ("grr", "mdi6.account-group-outline", tr("Gauge R&&R …"), lambda: self.studies.begin("grr")),
            ("acceptance", "mdi6.clipboard-check-outline", tr("Acceptance check …"),
             lambda: self.studies.begin("acceptance")),
        ))  # fmt: skip
        of_parts = self._row((
            ("series", "mdi6.chart-timeline-variant", tr("Series …"), lambda: self.studies.begin("series")),
            ("type1", "mdi6.chart-bell-curve", tr("Keep type-1 of the repeats"), self.studies.keep_type1),
            ))  # fmt: skip
        column.addWidget(Folding(studies, of_parts, spacing=6, share=0))
        self.list.setAccessibleName(tr("Studies"))
        self.list.setObjectName("roomy")
        self.list.setRootIsDecorated(False)
        self.list.header().setSectionResizeMode(0, QHeaderView.ResizeMode.Fixed)
        self.list.chosen.connect(self.studies.choose)
        self.list.ticked.connect(self.studies.include)
        column.addWidget(self.list)
        column.addLayout(self._row((
            ("remove", "mdi6.delete-outline", tr("Remove"), lambda: self.studies.remove(self.studies.chosen)),
            ("export", "mdi6.export", tr("Export …"), self._export),
        )))  # fmt: skip
        column.addWidget(self.title)
        for chart in self.charts:
            column.addWidget(chart)
        column.addWidget(Folding(in_row(self.table), in_column(self.rows, STRETCH), spacing=14, share=2), 1)
        column.addWidget(self.notes)
        return inside

    def _row(self, wanted: tuple[tuple[str, str, str, object], ...]) -> QHBoxLayout:
        row = in_row(spacing=6)
        for key, symbol, text, does in wanted:
            button = QPushButton(icon(symbol), text)
            button.clicked.connect(lambda _=False, does=does: does())
            self.buttons[key] = button
            row.addWidget(button)
        row.addStretch(1)
        return row

    # ---- showing it

    def _show_list(self) -> None:
        studies = self.studies
        if studies.all != self._shown:
            self._shown = studies.all
            self.list.set_rows([_row_of(one) for one in studies.all])
            self.list.choose(studies.chosen)
            # Qt's own width of a column forgets the room that the style leaves beside a box to tick.
            beside = self.list.sizeHintForColumn(0) + BESIDE_PX
            self.list.setColumnWidth(0, max(beside, self.list.header().sectionSizeHint(0)))
        self._fit_list()
        self.list.setVisible(bool(studies.all))
        self.words.setText(
            tr("Ticked studies go into the report.")
            if studies.all
            else tr(
                "How good is the way of measuring? A gauge R&R study compares parts, operators and repeats; an "
                "acceptance check measures a sphere, a ball bar or a plane in several positions, after the pattern of "
                "VDI/VDE 2634-2; a type-1 study judges the repeats of a reference part. A series shows whether the "
                "making of the parts is steady, and whether they fit their limits."
            )
        )

    def _fit_list(self) -> None:
        """As high as its rows, one and the room of a second at least."""
        rows = min(max(len(self.studies.all), 2), MOST_ROWS)
        around = self.list.header().sizeHint().height() + 2 * self.list.frameWidth()
        self.list.setFixedHeight(around + rows * max(self.list.sizeHintForRow(0), 0))

    def _show_buttons(self) -> None:
        can = self.studies.buttons
        for key, why_not, tip in (
            ("grr", can.begin, tr("Parts × operators × repeats, by analysis of variance")),
            ("acceptance", can.begin, tr("Probing error of a sphere, spacing of a ball bar, flatness of a plane")),
            ("series", can.begin, tr("Control charts, Cp and Cpk of parts measured one after another")),
            ("type1", can.type1, tr("Bias, Cg and Cgk of the repeats as they are now")),
            ("remove", can.remove, tr("Take the chosen study out of the project")),
            ("export", can.export, tr("Write the study (JSON), or the table it was made of (CSV)")),
        ):
            enable(self.buttons[key], why_not, tip)
        for key in ("remove", "export"):
            self.buttons[key].setVisible(bool(self.studies.all))

    def _show_study(self) -> None:
        studies = self.studies
        kept = next((one for one in studies.all if one.id == studies.chosen), None)
        study = None if kept is None else studies.study
        for widget in (self.title, self.rows, self.notes):
            widget.setVisible(study is not None)
        self.table.setVisible(study is not None and bool(study_tables(study)))
        shown = () if study is None else words.charts(study)
        for number, chart in enumerate(self.charts):
            chart.setVisible(number < len(shown))
        if kept is None or study is None or study is self._shown_study:
            return
        self._shown_study = study
        for chart, one in zip(self.charts, shown, strict=False):
            chart.set_values(one.values, one.good, one.tips, one.limits, axes=one.axes, unit=study.unit)
        self.title.setText(named(tr(KINDS[kept.kind]), text_of(kept.title)))
        first, others = study_tables(study)[:1], study_tables(study)[1:]
        show_facts(self.rows, study_facts(study), others)
        self.table.setVisible(bool(first))
        for table in first:
            show_table(self.table, table)
        self.table.show_rows(MOST_IN_SIGHT)
        self._fit_table()
        self.notes.setText("\n".join(map(text_of, study.notes)))

    def _fit_table(self) -> None:
        """It is seen whole; only one that is wider than the tab is cut."""
        room = self.width() - 2 * MARGIN_PX - self._bar.sizeHint().width()
        self.table.setMinimumWidth(max(min(self.table.whole_width(), room), 0))

    def _export(self) -> None:
        kept = next((one for one in self.studies.all if one.id == self.studies.chosen), None)
        folder = self.studies.model.folder
        if kept is None or folder is None:
            return
        kinds = tr("Study (*.json);;Table (*.csv)")
        path = ask.choose_file_to_save(self, tr("Write a copy"), folder.parent / f"{kept.kind}.json", kinds)
        if path is not None:
            self.studies.export(kept.id, path)


def _row_of(study: KeptStudy) -> TreeRow:
    title, tip = text_of(study.title), tr("Ticked studies are printed in the report")
    return TreeRow(study.id, (Cell(tr(KINDS[study.kind]), tip, ticked=study.included), Cell(title, title)))
