"""The report page: the pages as they will be, what is in them, and everything that is handed over."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QCheckBox, QComboBox, QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from workbench.pages.report_presenter import ReportPresenter, Stage
from workbench.pages.step_page import StepPage, muted
from workbench.theme import icon
from workbench.views import ask
from workbench.views.page_scroll import PageScroll
from workbench.views.stage_card import CardButton, StageCard

PAPERS = ("A4", "Letter")


class ReportPage(StepPage):
    """Preview in the middle; sections, paper and exports at the side."""

    presenter: ReportPresenter

    def __init__(self, presenter: ReportPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.preview = PageScroll()
        self.centre.addWidget(self.preview, 1)
        self.card = StageCard(
            [CardButton("make", self.tr("Make the report"), "mdi6.file-certificate-outline", presenter.do_run)]
        )
        self.make = self.card.buttons["make"]
        self.warning = muted()
        self.add_to_side(self.card)
        self.add_to_side(self.warning)
        self.boxes: dict[str, QCheckBox] = {}
        self.paper = QComboBox()
        self.add_panel(self.tr("In the report"), self._choices())
        self.exports: dict[str, QPushButton] = {}
        self.folder = QPushButton(self.tr("Open the results folder"))
        self.add_panel(self.tr("Hand over"), self._hand_over())
        self._shown: object = None
        self._dress()

    def refresh(self) -> None:
        p = self.presenter
        self._show_stage(p.stage)
        self.warning.setText(p.warning())
        self.warning.setVisible(bool(self.warning.text()))
        for name, title, shown in p.sections():
            box, why = self.boxes[name], p.empty_section(name)
            box.setChecked(shown)
            short = title.partition(",")[0]
            box.setText(self.tr("{0} (nothing yet)").format(short) if why else short)
            box.setToolTip(why or self.tr("{0}. What is left out is named on the last page.").format(title))
        self.paper.setCurrentText(p.project.report.paper)
        for kind, button in self.exports.items():
            missing = p.export_missing(kind)
            button.setEnabled(not missing)
            button.setToolTip(missing or self._export_help(kind))
        why = "" if p.results_folder() is not None else self.tr("There are no results yet.")
        self.folder.setEnabled(not why)
        self.folder.setToolTip(why or str(p.results_folder()))
        self._show_pages()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_shown"):
            self._dress()
            self._changed()

    def _show_stage(self, stage: Stage) -> None:
        p = self.presenter
        title, words = {
            Stage.NONE: (self.tr("Nothing to report yet"), p.blocker()),
            Stage.READY: (
                self.tr("Not made yet"),
                self.tr("These are its pages. Made, it is kept with the results of the project."),
            ),
            Stage.MAKING: (self.tr("Making the report …"), self.tr("It is written into the results of the project.")),
            Stage.MADE: (self.tr("The report is made"), p.state.sentence),
            Stage.OUTDATED: (self.tr("The report is out of date"), p.state.sentence),
        }[stage]
        tip = self.tr("Write report.pdf into the results of the project (Ctrl+R)")
        again = stage in (Stage.MADE, Stage.OUTDATED)
        self.make.setText(self.tr("Make it again") if again else self.tr("Make the report"))
        primary = "make" if stage in (Stage.READY, Stage.OUTDATED) else ""
        self.card.show_stage(title, words, {"make": (p.why_not_make(), tip)}, primary)

    def _show_pages(self) -> None:
        p = self.presenter
        if p.pages is not self._shown:
            self._shown = p.pages
            self.preview.set_pages(p.pages)
        drawing = self.tr("Drawing the pages …") if p.drawing else ""
        self.preview.set_message(drawing or p.problem or p.blocker())
        self.preview.set_note(drawing if p.pages else "")

    def _choices(self) -> QWidget:
        inside = QWidget()
        column = QVBoxLayout(inside)
        column.setContentsMargins(0, 4, 0, 4)
        for name, _, shown in self.presenter.sections():
            box = QCheckBox()
            box.setChecked(shown)
            box.clicked.connect(lambda on, section=name: self.presenter.choose_section(section, on))
            self.boxes[name] = box
            column.addWidget(box)
        row = QHBoxLayout()
        label = QLabel(self.tr("Paper"))
        label.setBuddy(self.paper)
        row.addWidget(label)
        self.paper.addItems(PAPERS)
        self.paper.setAccessibleName(self.tr("Paper"))
        self.paper.setToolTip(self.tr("What the report is printed on"))
        self.paper.textActivated.connect(self.presenter.choose_paper)
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
        for place, (kind, title, _, _) in enumerate(self._kinds()):
            button = QPushButton(title)
            button.clicked.connect(lambda _=False, k=kind: self._export(k))
            self.exports[kind] = button
            grid.addWidget(button, place // 2, place % 2)
        self.folder.clicked.connect(self._open_folder)
        grid.addWidget(self.folder, 3, 0, 1, 2)
        return inside

    def _kinds(self) -> tuple[tuple[str, str, str, str], ...]:
        """Kind, button, kind of file for the window that asks, icon."""
        return (
            ("pdf", self.tr("PDF"), self.tr("PDF (*.pdf)"), "mdi6.file-pdf-box"),
            ("cloud", self.tr("PLY"), self.tr("PLY (*.ply)"), "mdi6.dots-hexagon"),
            ("mesh", self.tr("PLY mesh"), self.tr("PLY (*.ply)"), "mdi6.triangle-outline"),
            ("stl", self.tr("STL"), self.tr("STL (*.stl)"), "mdi6.cube-outline"),
            ("csv", self.tr("CSV"), self.tr("CSV (*.csv)"), "mdi6.table"),
            ("json", self.tr("JSON"), self.tr("JSON (*.json)"), "mdi6.code-json"),
        )

    def _export_help(self, kind: str) -> str:
        if kind == "pdf" and self.presenter.stage is not Stage.MADE:
            return self.tr("Make the report as it is shown here, and write a copy where you want it")
        return {
            "pdf": self.tr("The report, for people"),
            "cloud": self.tr("All points in mm with normal, σ and frame, for other programs"),
            "mesh": self.tr("The surface as triangles, in mm"),
            "stl": self.tr("The surface as triangles, in mm, for CAD programs and printers"),
            "csv": self.tr("All points as a table, in mm, for a spreadsheet"),
            "json": self.tr("The thickness with U, flatness, parallelism and verdict, for other programs"),
        }[kind]

    def _dress(self) -> None:
        for kind, _, _, symbol in self._kinds():
            self.exports[kind].setIcon(icon(symbol))
        self.folder.setIcon(icon("mdi6.folder-open-outline"))

    def _export(self, kind: str) -> None:
        kinds = next(files for one, _, files, _ in self._kinds() if one == kind)
        path = ask.choose_file_to_save(self, self.tr("Write a copy"), self.presenter.export_place(kind), kinds)
        if path is not None:
            self.presenter.export(kind, path)

    def _open_folder(self) -> None:
        folder = self.presenter.results_folder()
        if folder is not None and not QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder))):
            self.presenter.bench.notices.warning(self.tr("Nothing here opens folders: {0}").format(folder))
