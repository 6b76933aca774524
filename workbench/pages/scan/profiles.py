"""Fixed lines alone: a thickness from pictures without the hand-held laser, beside the scan."""

from __future__ import annotations

import math
from pathlib import Path

from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices, QResizeEvent
from PySide6.QtWidgets import QPushButton, QVBoxLayout, QWidget

from core.files.project.results import ProfilesSummary
from core.report.facts.of_gauge import gauge_facts, pictures_fact
from core.report.facts.pictures import left_out
from core.settings.options import StatedTilt
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.words import fact_lines
from workbench.reasons import first, why
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import enable, muted
from workbench.work import jobs
from workbench.work.tasks import Task


class ProfilesPanel(QWidget):
    """Panel that asks for the tilt of the faces where one line does not show it, measures, and shows the result."""

    def __init__(self, bench: Bench, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self._task: Task | None = None
        self._report: Path | None = None
        self._stage, self._sd_deg, self._cannot = "", 0.0, ""
        self.form, self.said = SettingsForm(), muted()
        self.form.add_text(
            "stage",
            tr("Plate on the stage"),
            tr("Its pose, as pose03."),
            tip=tr("The pose whose plate lay on what the part stands on when the laser planes were calibrated"),
        )
        self.form.add_number(
            "tilt_sd",
            tr("Tilt known to"),
            NumberRange(0.0, 9.9, decimals=2, step=0.1, unit="°", none_text=tr("not stated"), first=0.5),
            tip=tr(
                "Standard uncertainty of how the faces are tilted; without a pose the light plane is taken to "
                "stand at right angles on them"
            ),
        )
        self.form.edited.connect(self._edited)
        self.measure = QPushButton(tr("Measure by the fixed lines"))
        self.measure.clicked.connect(self._measure)
        self.open = QPushButton(tr("Open its report"))
        self.open.clicked.connect(self._open)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 4, 0, 4)
        for widget in (self.form, self.measure, self.said, self.open):
            column.addWidget(widget)
        self._model.opened.connect(self._forget)
        self._forget()

    def refresh(self, cannot: str) -> None:
        """Show the thickness by the fixed lines; `cannot` is the reason why nothing can be measured now, or ""."""
        one = self._model.project.rig.lines == 1
        self.form.setVisible(one)
        self.form.set_values({"stage": self._stage, "tilt_sd": self._sd_deg or None})
        self._cannot = cannot
        self._enable()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def tilt(self) -> StatedTilt | None:
        """Return the tilt of the faces that the user has stated; None if none is."""
        if self._model.project.rig.lines > 1 or not (self._stage or self._sd_deg):
            return None
        return StatedTilt(self._stage, math.radians(self._sd_deg) or None)

    def _edited(self, key: str, value: object) -> None:
        if key == "stage":
            self._stage = str(value).strip()
        else:
            self._sd_deg = value if isinstance(value, float) else 0.0

    def _measure(self) -> None:
        if self._model.folder is None or self._task is not None:
            return
        self._say(tr("The pictures are being measured …"))
        task: Task = self._bench.run_long(
            self,
            jobs.MEASURE_PROFILES,
            self._model.folder,
            self._model.project,
            self.tilt(),
            label=tr("Measuring by the fixed lines"),
            on_done=lambda summary: self._done(task, summary),
            on_failed=lambda _: self._ended(task),
            on_cancelled=lambda: self._ended(task),
        )
        self._task = task
        self._enable()

    def _done(self, task: Task, summary: ProfilesSummary) -> None:
        if task is not self._task:
            return  # of the project before
        self._ended(task)
        lines = [
            fact_lines((*gauge_facts(summary.gauge), pictures_fact(summary.pictures))),
            *(text_of(one.line()) for one in left_out(summary.pictures)),
            *(text_of(note) for note in summary.gauge.notes),
        ]
        self._say("\n".join(lines), summary.report)

    def _ended(self, task: Task) -> None:
        if task is not self._task:
            return
        self._task = None
        self._enable()
        self._say("")

    def _enable(self) -> None:
        enable(
            self.measure,
            first(why(self._task, tr("The pictures are being measured.")), self._cannot),
            tr("Each picture shows the fan alone and the part; no hand-held laser is needed"),
        )

    def _forget(self) -> None:
        self._stage, self._sd_deg = "", 0.0
        if self._task is not None:
            self._task.cancel()
            self._task = None
        self._say("")

    def _say(self, text: str, report: Path | None = None) -> None:
        self._report = report
        self.said.setText(text)
        self.said.setVisible(bool(text))
        self.open.setVisible(report is not None)
        self._fit()

    def _fit(self) -> None:
        """Give the words all the lines they need: a folding panel asks once, before it knows how wide it is."""
        self.said.setMinimumHeight(self.said.heightForWidth(self.said.width()) if self.said.text() else 0)

    def _open(self) -> None:
        if self._report is not None and not QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._report))):
            self._bench.notices.warning(tr("Nothing here opens folders: {folder}", folder=self._report))
