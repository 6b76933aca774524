"""The page of the operator mode: how far the part is in big type, and four buttons."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QEvent, QSize, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFrame, QLabel, QProgressBar, QPushButton, QSizePolicy, QWidget

from core.files.project.folder import results_folder
from core.messages import capital
from core.report.tolerance_scale import ToleranceScale
from core.report.wording import headed_name, unbroken, value_parts, verdict_title
from core.states import STEP_STATES
from workbench.language import tr
from workbench.pages.project.operator import OperatorMode, Stage
from workbench.pages.words import wording
from workbench.project_model import ProjectModel
from workbench.refresh import Refresh
from workbench.theme import icon, shades
from workbench.views import ask
from workbench.views.colours import WANTED
from workbench.views.common import IconLabel, dress
from workbench.views.image.view import ImageView
from workbench.views.layouts import STRETCH, Elided, enable, in_column, in_row, mark_primary
from workbench.views.lists.notice_list import Banner
from workbench.views.lists.value_rows import VERDICT_ICONS
from workbench.views.plots.tolerance_bar import ToleranceBar

REPORT = "report.pdf"
"""Among the results."""
HEADLINE_PX, RESULT_PX, TEXT_PX, BUTTON_PX = 34, 26, 19, 21
"""To be read from where the part is handled."""
BUTTON_HIGH_PX = 84
"""To be hit with a glove on."""
SYMBOLS = {
    "next_part": "mdi6.barcode-scan",
    "measure": "mdi6.play-circle-outline",
    "report": "mdi6.file-document-outline",
    "stop": "mdi6.stop-circle-outline",
}
SIGN_PX = 64
"""Of the sign beside the headline."""


class OperatorPage(QWidget):
    """Page of the operator: next part, measure, report, stop."""

    next_part = Signal()
    stop = Signal()
    leave = Signal()

    def __init__(self, mode: OperatorMode, model: ProjectModel, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._mode, self._model = mode, model
        self._placed: object = None
        self.part, self.who = Elided(), QLabel()
        self.leaving = QPushButton(icon("mdi6.exit-to-app"), tr("Leave operator mode"))
        self.leaving.setObjectName("low")
        self.sign, self.headline, self.detail = IconLabel(SIGN_PX), QLabel(), QLabel()
        self.bar, self.left, self.tolerance = QProgressBar(), QLabel(), ToleranceBar(TEXT_PX)
        self.bar.setTextVisible(False)
        self.bar.setFixedHeight(18)
        for label in (self.headline, self.detail, self.left):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
        self.buttons = {
            name: QPushButton(icon(SYMBOLS[name]), text)
            for name, text in (
                ("next_part", tr("Next part")),
                ("measure", tr("Measure")),
                ("report", tr("Report")),
                ("stop", tr("Stop")),
            )
        }
        for button in self.buttons.values():
            button.setMinimumHeight(BUTTON_HIGH_PX)
            button.setIconSize(QSize(34, 34))
            button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            dress(button, f"font-size: {BUTTON_PX}px; font-weight: 600;")
        dress(self.part, f"font-size: {TEXT_PX}px; font-weight: 600;")
        for label, px in ((self.who, TEXT_PX), (self.detail, RESULT_PX), (self.left, TEXT_PX)):
            dress(label, f"font-size: {px}px;")
        said = in_column(STRETCH, self.headline, self.detail, self.tolerance, self.bar, self.left, STRETCH, spacing=8)
        state = QFrame()
        state.setObjectName("card")
        row = in_row(on=state, margins=(24, 16, 24, 16), spacing=20)
        row.addWidget(self.sign, 0, Qt.AlignmentFlag.AlignVCenter)
        row.addLayout(said, 1)
        head = in_row((self.part, 1), self.who, self.leaving, spacing=16)
        foot = in_row(*((button, 1) for button in self.buttons.values()), spacing=12)
        in_column(head, (state, 1), foot, on=self, margins=(20, 14, 20, 16), spacing=12)
        self.banner = Banner(state)
        self.place = ImageView()
        self.place.setAccessibleName(tr("Picture of the scan"))
        row.addWidget(self.place, 1)
        self.buttons["next_part"].clicked.connect(self.next_part)
        self.buttons["measure"].clicked.connect(self._measure)
        self.buttons["report"].clicked.connect(self._show_report)
        self.buttons["stop"].clicked.connect(self.stop)
        self.leaving.clicked.connect(self.leave)
        self.refreshing = Refresh(self.refresh, self)
        for signal in (mode.changed, model.changed, model.results_changed, model.opened):
            signal.connect(self._soon)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self._mode.on:
            self.refreshing.soon()  # the headline has a colour of the theme

    def _soon(self) -> None:
        if self._mode.on:
            self.refreshing.soon()

    def refresh(self) -> None:
        """Show how far the part is, its result, and which of the four buttons are enabled."""
        if not self._model.is_open:
            return
        info, stage = self._model.project.info, self._mode.stage
        name = info.part or info.name
        self.part.setText(f"{name}   {tr('No. {serial}', serial=info.serial)}" if info.serial else name)
        self.who.setText(info.operator)
        can = self._mode.buttons
        tips = {
            "next_part": tr("Scan or type the serial number of the next part; plan, limits and report are the same"),
            "measure": tr("Measure this part: from its pictures to the report"),
            "report": tr("Open the report of this part"),
            "stop": tr("Stop what is running; what was finished stays"),
        }
        onwards = {Stage.DONE: "next_part", Stage.READY: "measure", Stage.PICTURES: "measure", Stage.STOPPED: "measure"}
        for button_name, button in self.buttons.items():
            enable(button, getattr(can, button_name), tips[button_name])
            primary = onwards.get(stage) == button_name
            mark_primary(button, primary)
            button.setIcon(icon(SYMBOLS[button_name], colour="on_accent" if primary else ""))
        symbol, colour, headline, detail = self._said(stage)
        self.sign.show_icon(symbol, colour)
        self.headline.setText(headline)
        self.detail.setText(detail)
        dress(self.headline, f"font-size: {HEADLINE_PX}px; font-weight: 700; color: {getattr(shades(), colour)};")
        self._show_place()
        for widget in (self.bar, self.left):
            widget.setVisible(stage is Stage.MEASURING)
        worst = self._mode.worst if stage is Stage.DONE else None
        scale = None if worst is None else ToleranceScale.of(worst)
        self.tolerance.set_scale(scale, colour)
        self.tolerance.setVisible(scale is not None)

    def show_progress(self, stage: str, share: float | None, left: str) -> None:
        """Show the stage of the running job, its share done (None: not known), and the time left in words."""
        self.detail.setText(stage)
        self.bar.setRange(0, 0 if share is None else 1000)
        self.bar.setValue(0 if share is None else round(1000 * share))
        self.left.setText(left)

    def _show_place(self) -> None:
        """Where the part goes: where it lay, or the one before it."""
        placing = self._mode.placing
        self.place.setVisible(placing is not None)
        if placing is not None and placing is not self._placed:
            self.place.set_picture(placing.picture, keep_view=False, scale=placing.scale)
            self.place.set_lines("part", [[*placing.outline, placing.outline[0]]], colour=WANTED, width=3.0)
        self._placed = placing

    def _said(self, stage: Stage) -> tuple[str, str, str, str]:
        """Sign, its colour, headline and what stands below."""
        if stage is Stage.PICTURES:
            return "mdi6.image-multiple-outline", "text", tr("New part"), tr("Press Measure and choose its pictures.")
        if stage is Stage.READY:
            return "mdi6.play-circle-outline", "text", capital(tr(STEP_STATES["ready"])), tr("Press Measure.")
        if stage is Stage.MEASURING:
            return "mdi6.progress-clock", "accent", tr("Measuring …"), self.detail.text()
        if stage is Stage.STOPPED:
            return "mdi6.alert-outline", "warn", tr("Not finished"), self._mode.facts.stopped
        found = self._mode.found
        if found is None or not (found.rows or found.verdict):
            return "mdi6.check", "text", tr("Measured"), ""
        symbol, colour = VERDICT_ICONS[found.verdict]
        verdict = verdict_title(found.verdict, wording())
        line, worst = "", self._mode.worst
        if worst is not None:
            value, coverage = value_parts(worst, wording())
            line = tr("{name}: {value}", name=headed_name(worst, wording()), value=f"{unbroken(value)} {coverage}")
        return symbol, "text" if colour == "muted" else colour, verdict, line

    def _measure(self) -> None:
        if self._mode.stage is not Stage.PICTURES:
            self._mode.measure()
            return
        folder = self._model.folder
        chosen = ask.choose_folder(self, tr("Pictures of this part"), Path.home() if folder is None else folder.parent)
        if chosen is not None:
            self._mode.take_pictures(chosen)

    def _show_report(self) -> None:
        if (folder := self._model.folder) is not None:
            path = results_folder(folder) / REPORT
            if not QDesktopServices.openUrl(QUrl.fromLocalFile(str(path))):
                self.banner.show_notice("warning", tr("Nothing here opens the report: {path}", path=path), "")
