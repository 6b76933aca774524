"""The report page: the pages as they will be, what is in them, and everything that is handed over."""

from __future__ import annotations

from PySide6.QtCore import QUrl
from PySide6.QtGui import QAction, QDesktopServices
from PySide6.QtWidgets import QCheckBox, QGridLayout, QLabel, QMenu, QPushButton, QVBoxLayout, QWidget

from core.files.results.export_list import exports
from core.messages import capital
from core.report.template import PAPERS
from core.states import STEP_STATES
from core.translations import languages, own_name
from workbench.language import tr
from workbench.pages.report.presenter import ReportPresenter
from workbench.pages.report.stage import Stage
from workbench.pages.report.words import SHORT_TITLES, USUAL_EXPORTS, export_words
from workbench.pages.step_page import StepPage
from workbench.theme import icon
from workbench.views import ask
from workbench.views.common import Choice
from workbench.views.layouts import enable, muted, set_text
from workbench.views.pages.page_scroll import PageScroll
from workbench.views.stage_card import CardButton, StageCard


class ReportPage(StepPage):
    """Page with the preview in the middle; sections, paper and exports at the side."""

    presenter: ReportPresenter

    def __init__(self, presenter: ReportPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.preview = PageScroll()
        self.centre.addWidget(self.preview, 1)
        self.card = StageCard(
            [CardButton("make", tr("Make the report"), "mdi6.file-certificate-outline", presenter.do_run)]
        )
        self.make = self.card.buttons["make"]
        self.warning = muted()
        self.add_to_side(self.card)
        self.add_to_side(self.warning)
        self.boxes: dict[str, QCheckBox] = {}
        self.paper, self.language = Choice(), Choice()
        self.template, self.no_template, self.template_name = QPushButton(), QPushButton(), QLabel()
        self.add_panel(tr("In the report"), self._choices(), kept="choices")
        self.exports: dict[str, QPushButton | QAction] = {}
        self.more = QPushButton(tr("More formats"))
        self.folder = QPushButton(tr("Results folder"))
        self.add_panel(tr("Hand over"), self._hand_over(), kept="hand over")
        self._shown: object = None

    def refresh(self) -> None:
        p = self.presenter
        self._show_stage(p.stage)
        set_text(self.warning, p.warning())
        for name, title, shown in p.sections():
            box, why = self.boxes[name], p.empty_section(name)
            box.setChecked(shown)
            short = tr(SHORT_TITLES[name]) if name in SHORT_TITLES else title
            box.setText(tr("{title} (nothing yet)", title=short) if why else short)
            box.setToolTip(why or tr("{title}. What is left out is named on the last page.", title=title))
        self._show_looks()
        for kind, button in self.exports.items():
            missing = p.export_missing(kind)
            enable(button, missing, self._export_help(kind))
        nothing = all(p.export_missing(kind) for kind in self.exports)
        why_not = p.export_missing("pdf") if nothing else ""
        enable(self.more, why_not, tr("Other programs' formats: E57, 3MF, DFQ, QIF, DCC and more"))
        why = "" if p.results_folder() is not None else tr("There are no results yet.")
        enable(self.folder, why, str(p.results_folder()))
        self._show_pages()

    def _show_stage(self, stage: Stage) -> None:
        p = self.presenter
        title, words = {
            Stage.NONE: (tr("Nothing to report yet"), p.blocker()),
            Stage.READY: (
                tr("Not made yet"),
                tr("These are its pages. Made, it is kept with the results of the project."),
            ),
            Stage.MAKING: (tr("Making the report …"), tr("It is written into the results of the project.")),
            Stage.MADE: (tr("The report is made"), p.state.sentence),
            Stage.OUTDATED: (capital(tr(STEP_STATES["outdated"])), p.state.sentence),
        }[stage]
        tip = tr("Write report.pdf into the results of the project (Ctrl+R)")
        again = stage in (Stage.MADE, Stage.OUTDATED)
        self.make.setText(tr("Make it again") if again else tr("Make the report"))
        primary = "make" if stage in (Stage.READY, Stage.OUTDATED) else ""
        self.card.show_stage(title, words, {"make": (p.why_not_make(), tip)}, primary)

    def _show_pages(self) -> None:
        p = self.presenter
        if p.pages is not self._shown:
            self._shown = p.pages
            self.preview.set_pages(p.pages)
        drawing = tr("Drawing the pages …") if p.drawing else ""
        if p.stage is Stage.NONE:
            self.preview.set_message(p.blocker(), tr("Go to Scan"), lambda: p.go_to.emit("scan"))
        else:
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
        column.addLayout(self._looks())
        column.addWidget(
            muted(tr("The result, what it does not cover, and the hash over all inputs are always printed."))
        )
        return inside

    def _looks(self) -> QGridLayout:
        """Paper, language and the company's template."""
        grid = QGridLayout()
        grid.setColumnStretch(1, 1)
        self.paper.addItems(PAPERS)
        self.language.addItem(tr("as the window"), "")
        for language in languages():
            self.language.addItem(own_name(language), language)
        for row, (box, title, tip) in enumerate(
            (
                (self.paper, tr("Paper"), tr("What the report is printed on")),
                (self.language, tr("Language"), tr("The language of the report's fixed words")),
            )
        ):
            label = QLabel(title)
            label.setBuddy(box)
            box.setAccessibleName(title)
            box.setToolTip(tip)
            grid.addWidget(label, row, 0)
            grid.addWidget(box, row, 1, 1, 2)
        self.paper.textActivated.connect(self.presenter.choose_paper)
        self.language.activated.connect(lambda _: self.presenter.choose_language(self.language.currentData()))
        self.template_name.setWordWrap(True)
        self.template.setText(tr("Choose template …"))
        self.no_template.setText(tr("None"))
        self.template.clicked.connect(self._choose_template)
        self.no_template.clicked.connect(lambda: self.presenter.choose_template(None))
        grid.addWidget(QLabel(tr("Template")), 2, 0)
        grid.addWidget(self.template_name, 2, 1, 1, 2)
        grid.addWidget(self.template, 3, 1)
        grid.addWidget(self.no_template, 3, 2)
        return grid

    def _show_looks(self) -> None:
        report = self.presenter.project.report
        self.paper.setCurrentText(report.paper)
        self.language.setCurrentIndex(self.language.findData(report.language))
        self.template_name.setText(report.template.rpartition("/")[2] or tr("none"))
        self.template_name.setToolTip(report.template)
        why_not = self.presenter.bench.cannot_write
        tip = tr("Logo, address, colours and text of your laboratory, from a template.toml")
        enable(self.template, why_not, tip)
        none = "" if report.template else tr("No template is chosen.")
        enable(self.no_template, none or why_not, tr("Print without a template"))

    def _choose_template(self) -> None:
        path = ask.choose_file_to_open(
            self, tr("Template of the report"), self.presenter.model.folder, tr("Template (*.toml)")
        )
        if path is not None:
            self.presenter.choose_template(path)

    def _hand_over(self) -> QWidget:
        inside = QWidget()
        grid = QGridLayout(inside)
        grid.setContentsMargins(0, 4, 0, 4)
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        place = 0
        for kind in exports():
            title, _, symbol = export_words(kind)
            if kind in USUAL_EXPORTS:
                button = QPushButton(icon(symbol), title)
                button.clicked.connect(lambda _=False, k=kind: self._export(k))
                grid.addWidget(button, place // 2, place % 2)
                self.exports[kind] = button
                place += 1
            else:
                action = menu.addAction(icon(symbol), title)
                action.triggered.connect(lambda _=False, k=kind: self._export(k))
                self.exports[kind] = action
        self._add_frame_choice(menu)
        menu.aboutToShow.connect(lambda: self._show_frame_choice(menu))
        self.more.setMenu(menu)
        self.folder.setIcon(icon("mdi6.folder-open-outline"))
        self.folder.clicked.connect(self._open_folder)
        grid.addWidget(self.more, 3, 0)
        grid.addWidget(self.folder, 3, 1)
        return inside

    def export_menu(self) -> QMenu:
        """Make the menu of all exports; its entries are disabled as the page's buttons are."""
        menu = QMenu(tr("&Export"), self)
        menu.setToolTipsVisible(True)
        for kind in exports():
            title, _, symbol = export_words(kind)
            action = menu.addAction(icon(symbol), title)
            action.setData(kind)
            action.triggered.connect(lambda _=False, k=kind: self._export(k))
        self._add_frame_choice(menu)
        menu.aboutToShow.connect(lambda: self._grey_exports(menu))
        return menu

    def _grey_exports(self, menu: QMenu) -> None:
        self._show_frame_choice(menu)
        for action in menu.actions():
            kind = action.data()
            if kind is not None:
                enable(action, self.presenter.export_missing(kind), self._export_help(kind))

    def _add_frame_choice(self, menu: QMenu) -> None:
        """The choice of the frame, at the end of a menu of exports; it is remembered for all of them."""
        menu.addSeparator()
        action = menu.addAction(tr("Places as the camera sees them"))
        action.setCheckable(True)
        action.setToolTip(
            tr(
                "Clouds, surfaces and geometry are written as the part lies: in its part coordinates, else with z up "
                "from its lower face. Checked: as the camera sees them, z forward, y down. Each file names its frame."
            )
        )
        action.toggled.connect(lambda wanted: setattr(self.presenter, "in_camera_frame", wanted))

    def _show_frame_choice(self, menu: QMenu) -> None:
        menu.actions()[-1].setChecked(self.presenter.in_camera_frame)

    def _export_help(self, kind: str) -> str:
        if kind == "pdf" and self.presenter.stage is not Stage.MADE:
            return tr("Make the report as it is shown here, and write a copy where you want it")
        return export_words(kind)[1]

    def _export(self, kind: str) -> None:
        ending = exports()[kind].ending
        kinds = f"{ending.removeprefix('.').upper()} (*{ending})"
        path = ask.choose_file_to_save(self, tr("Write a copy"), self.presenter.export_place(kind), kinds)
        if path is not None:
            self.presenter.export(kind, path)

    def _open_folder(self) -> None:
        folder = self.presenter.results_folder()
        if folder is not None and not QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder))):
            self.presenter.bench.notices.warning(tr("Nothing here opens folders: {folder}", folder=folder))
