"""The report page: the pages as they will be, what is in them, and everything that is handed over."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QCheckBox, QComboBox, QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from workbench.pages.report_presenter import ReportPresenter
from workbench.pages.step_page import StepPage, muted
from workbench.theme import icon
from workbench.views import ask
from workbench.views.page_scroll import PageScroll

EXPORTS = (
    ("pdf", "PDF", "PDF (*.pdf)", "mdi6.file-pdf-box"),
    ("cloud", "PLY", "PLY (*.ply)", "mdi6.dots-hexagon"),
    ("mesh", "PLY mesh", "PLY (*.ply)", "mdi6.triangle-outline"),
    ("stl", "STL", "STL (*.stl)", "mdi6.cube-outline"),
    ("csv", "CSV", "CSV (*.csv)", "mdi6.table"),
    ("json", "JSON", "JSON (*.json)", "mdi6.code-json"),
)


class ReportPage(StepPage):
    """Preview in the middle; sections, paper and exports at the side."""

    presenter: ReportPresenter

    def __init__(self, presenter: ReportPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.scroll = PageScroll()
        self.centre.addWidget(self.scroll, 1)
        self.make = QPushButton(self.tr("Make the report"))
        self.make.setProperty("primary", True)
        self.make.clicked.connect(presenter.do_run)
        self.state = muted()
        self.add_to_side(self.make)
        self.add_to_side(self.state)
        self.boxes: dict[str, QCheckBox] = {}
        self.add_panel(self.tr("In the report"), self._choices())
        self.exports: dict[str, QPushButton] = {}
        self.add_panel(self.tr("Hand over"), self._hand_over())

    def refresh(self) -> None:
        p = self.presenter
        self.make.setEnabled(p.ready())
        self.make.setToolTip(p.blocker() or self.tr("Write report.pdf into the project's results (Ctrl+R)"))
        for name, _, shown in p.sections():
            self.boxes[name].blockSignals(True)
            self.boxes[name].setChecked(shown)
            self.boxes[name].blockSignals(False)
        self.paper.blockSignals(True)
        self.paper.setCurrentText(p.project.report.paper)
        self.paper.blockSignals(False)
        self.state.setText(p.warning() or p.state.sentence)
        for kind, button in self.exports.items():
            missing = p.export_missing(kind)
            button.setEnabled(not missing)
            button.setToolTip(missing or self.tr("Write a copy where you want it"))
        self.folder.setEnabled(p.model.is_open)
        self._show_pages()

    def _show_pages(self) -> None:
        p = self.presenter
        if p.previewing and not p.pages:
            self.scroll.set_message(self.tr("Drawing the pages …"))
        else:
            self.scroll.set_message(p.problem or p.blocker())
        if self.scroll.count() != len(p.pages) or self._shown is not p.pages:
            self._shown = p.pages
            self.scroll.set_pages(p.pages)

    _shown: object = None

    def _choices(self) -> QWidget:
        inside = QWidget()
        column = QVBoxLayout(inside)
        column.setContentsMargins(0, 4, 0, 4)
        for name, title, shown in self.presenter.sections():
            box = QCheckBox(title)
            box.setChecked(shown)
            box.setToolTip(self.tr("What is left out is named on the last page."))
            box.toggled.connect(lambda on, section=name: self.presenter.choose_section(section, on))
            self.boxes[name] = box
            column.addWidget(box)
        row = QHBoxLayout()
        row.addWidget(QLabel(self.tr("Paper")))
        self.paper = QComboBox()
        self.paper.addItems(["A4", "Letter"])
        self.paper.setAccessibleName(self.tr("Paper"))
        self.paper.currentTextChanged.connect(self.presenter.choose_paper)
        row.addWidget(self.paper, 1)
        column.addLayout(row)
        column.addWidget(
            muted(self.tr("The result, what it does not cover, and the hash over all inputs are always printed."))
        )
        return inside

    def _hand_over(self) -> QWidget:
        inside = QWidget()
        grid = QGridLayout(inside)
        grid.setContentsMargins(0, 4, 0, 4)
        for place, (kind, title, kinds, symbol) in enumerate(EXPORTS):
            button = QPushButton(icon(symbol), title)
            button.clicked.connect(lambda _=False, k=kind, t=kinds: self._export(k, t))
            self.exports[kind] = button
            grid.addWidget(button, place // 2, place % 2)
        self.folder = QPushButton(icon("mdi6.folder-open-outline"), self.tr("Open the results folder"))
        self.folder.clicked.connect(self._open_folder)
        grid.addWidget(self.folder, 3, 0, 1, 2)
        return inside

    def _export(self, kind: str, kinds: str) -> None:
        folder = self.presenter.model.folder
        if folder is None:
            return
        path = ask.choose_file_to_save(self, self.tr("Write a copy"), folder / self.presenter.export_name(kind), kinds)
        if path is not None:
            self.presenter.export(kind, path)

    def _open_folder(self) -> None:
        folder = self.presenter.model.folder
        if folder is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(Path(folder) / "results")))
