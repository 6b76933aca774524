"""The project page: what is measured, by whom, for whom."""

from __future__ import annotations

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QVBoxLayout, QWidget

from workbench.language import tr
from workbench.pages.project.presenter import ProjectPresenter
from workbench.pages.step_page import StepPage
from workbench.pages.whole import EVERYTHING
from workbench.theme import icon
from workbench.views.common import breakable
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import STRETCH, Folding, UpAndDown, enable, heading, holding, in_column, in_row, muted
from workbench.views.lists.value_rows import ValueRows


class ProjectPage(StepPage):
    """Page with two columns of fields, one below the other in a narrow window, and the progress of all steps."""

    presenter: ProjectPresenter

    def __init__(self, presenter: ProjectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        p = presenter
        self.what, self.who = SettingsForm(), SettingsForm()
        w, h = self.what, self.who
        w.add_text("name", p.label("name"), tr("What you call this project; the window's title."))
        w.add_text("part", p.label("part"), tr("What is measured, as on the drawing."))
        w.add_text("serial", p.label("serial"), tr("Serial or inventory number of the part."))
        for key, highest, words in (
            ("air_celsius", 60.0, tr("Printed with the result; lengths at 20 °C are chosen on Inspect.")),
            ("part_celsius", 100.0, tr("A steel part grows by 11.5 µm per metre and kelvin.")),
        ):
            none = tr("not measured")
            w.add_number(
                key,
                p.label(key),
                NumberRange(-20, highest, decimals=1, step=0.5, unit="°C", none_text=none, first=20.0),
                words,
            )
        h.add_text("operator", p.label("operator"), tr("Who measures."))
        h.add_text("laboratory", p.label("laboratory"), tr("Who answers for the report: its heading."))
        h.add_text("customer", p.label("customer"), tr("Whom the report is for."))
        h.add_multiline("notes", p.label("notes"), tr("Printed in the report as remarks."))
        for form in (self.what, self.who):
            form.edited.connect(presenter.set_field)
        self.centre.addWidget(self._columns())
        self.rows, self.next_words = ValueRows(), muted()
        self.whole = QPushButton(icon("mdi6.play-circle-outline"), tr("Measure everything"))
        self.whole.clicked.connect(presenter.do_whole)
        self.add_panel(tr("Progress"), holding(in_column(self.rows, self.whole, self.next_words)))
        self.place = muted()
        self.folder = QPushButton(icon("mdi6.folder-open-outline"), tr("Open the project folder"))
        self.add_panel(tr("Where it is kept"), self._kept())

    def refresh(self) -> None:
        values = self.presenter.values()
        for form in (self.what, self.who):
            form.set_values({key: value for key, value in values.items() if key in form.values()})
        self.rows.set_rows(self.presenter.progress_rows())
        self.next_words.setText(self.presenter.next_words())
        enable(self.whole, self.presenter.whole.cannot_start, tr(EVERYTHING))
        self.place.setText(breakable(self.presenter.place()))

    def _columns(self) -> QWidget:
        cards = (
            in_row(_card(heading(tr("Part")), self.what)),
            in_row(_card(heading(tr("People and remarks")), self.who)),
        )
        inside = holding(in_column(Folding(*cards, spacing=12), STRETCH))
        scroll = UpAndDown(inside)
        scroll.setAccessibleName(tr("Fields of the project"))
        return scroll

    def _kept(self) -> QWidget:
        inside = QWidget()
        column = QVBoxLayout(inside)
        column.setContentsMargins(0, 4, 0, 4)
        self.place.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.folder.setToolTip(tr("Recordings, calibrations, results and the last five saved versions are in it"))
        self.folder.clicked.connect(self._open_folder)
        column.addWidget(self.place)
        column.addWidget(self.folder)
        return inside

    def _open_folder(self) -> None:
        place = self.presenter.place()
        if place and not QDesktopServices.openUrl(QUrl.fromLocalFile(place)):
            self.presenter.bench.notices.warning(tr("Nothing here opens folders: {folder}", folder=place))


def _card(title: QLabel, form: QWidget) -> QFrame:
    card = QFrame()
    card.setObjectName("card")
    in_column(title, form, STRETCH, on=card, margins=(16, 12, 16, 14))
    return card
