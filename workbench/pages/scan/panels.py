"""Panels of the scan page: how far it is, how it is measured, what came of it, and how a running scan does."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from core.messages import capital
from core.pipeline.live.events import ScanDetail
from core.report.facts.pictures import left_out
from core.scan.preview.hints import HintLimits
from core.scan.preview.shown import ShownScan
from core.states import STEP_STATES
from workbench.language import sentences, text_of, tr
from workbench.pages.channels import add_channel
from workbench.pages.scan import words
from workbench.pages.scan.presenter import ScanPresenter
from workbench.pages.scan.stability import STABILITY, drift_key, usual_per_kelvin
from workbench.pages.scan.stage import Stage
from workbench.pages.setting_fields import add_rig_settings, add_settings, set_stripe_editable
from workbench.pages.whole import EVERYTHING
from workbench.pages.words import count, show_facts, sigma
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import STRETCH, alarm, heading, in_column, in_row, muted, set_notes, set_text
from workbench.views.lists.value_rows import ValueRows
from workbench.views.plots.meters import HintBar, Meter
from workbench.views.stage_card import CardButton, StageCard

FAST = HintLimits().speed_share
"""Share of the picture's width that the stripe may move from frame to frame."""


class ScanCard(StageCard):
    """Card with the stage; the next action is the primary button."""

    def __init__(self, presenter: ScanPresenter, parent: QWidget | None = None) -> None:
        self._presenter = p = presenter
        super().__init__(
            [
                CardButton("run", tr("Measure"), "mdi6.play", p.do_run),
                CardButton("whole", tr("Measure everything"), "mdi6.play-circle-outline", p.measure_everything),
                CardButton("cancel", tr("Cancel"), "mdi6.stop", p.cancel),
            ],
            parent,
        )
        self.buttons["whole"].hide()  # never beside Cancel: there is no room for three

    def refresh(self) -> None:
        """Show how far the scan is, and the buttons of what can be done next."""
        p, stage = self._presenter, self._presenter.stage
        measuring = stage is Stage.MEASURING
        self.buttons["whole"].setVisible(p.whole is not None and not measuring)
        self.buttons["cancel"].setVisible(measuring or p.whole is None)
        self.buttons["run"].setText(tr("Measure again") if stage in (Stage.MEASURED, Stage.OUTDATED) else tr("Measure"))
        self.show_stage(
            *self._words(stage),
            {
                "run": (p.cannot_measure, tr("Measure the surface and the thickness from the recording (Ctrl+R)")),
                "whole": (p.cannot_measure if p.whole is None else p.whole.cannot_start, tr(EVERYTHING)),
                "cancel": (
                    "" if measuring else tr("Nothing is being measured."),
                    tr("Stop measuring; the recording and the result before are kept"),
                ),
            },
            "run" if stage in (Stage.RECORDED, Stage.FAILED, Stage.OUTDATED) else "",
            steady=stage in (Stage.RECORDED, Stage.MEASURING, Stage.MEASURED, Stage.OUTDATED),
        )

    def _words(self, stage: Stage) -> tuple[str, str]:
        p = self._presenter
        match stage:
            case Stage.NONE:
                return tr("No recording yet"), self._how_to_begin()
            case Stage.LISTING:
                return tr("Listing the frames …"), ""
            case Stage.EMPTY:
                return tr("No frames there"), p.work.no_frames or tr("The folder holds no frames; choose another one.")
            case Stage.LIVE:  # the band above the picture says what goes on
                return "", ""
            case Stage.RECORDED:
                title = tr("{count} frames, not measured yet", count=len(p.work.names))
                return title, p.cannot_measure or tr("Press Measure; no setting is needed.")
            case Stage.MEASURING if p.run.by_itself:
                return tr("Measuring the recording …"), tr(
                    "It began by itself and needs no setting. Cancel keeps the recording."
                )
            case Stage.MEASURING:
                return tr("Measuring …"), tr("Cancel keeps the recording and the result before.")
            case Stage.FAILED:
                return tr("Not measured"), p.run.problem
            case Stage.MEASURED:
                return tr("Measured"), sentences(self._how_good(), p.state.sentence)
            case Stage.OUTDATED:
                again = tr("Measure again.") if p.changed_since() else ""
                return capital(tr(STEP_STATES["outdated"])), sentences(p.state.sentence, again)

    def _how_good(self) -> str:
        look = self._presenter.work.look
        if look is None:
            return ""
        return tr("{count} points, median σ {sigma}.", count=count(len(look)), sigma=sigma(look.median_sigma_mm))

    def _how_to_begin(self) -> str:
        p = self._presenter
        begin = tr("Sweep the part with a live source, or choose the folder of a recording.")
        if not p.has_fan:
            begin = tr(words.SWEEP_BEFORE_BOARDS if p.boards else words.NO_LIVE_SCAN)
        if p.calibrated:
            return begin
        return tr("{begin} It can be measured once its calibrations are accepted.", begin=begin)


class PlateQuestion(QFrame):
    """Question, asked once in a project, whether the plate is left beside the part, where it checks every scan."""

    def __init__(self, presenter: ScanPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("card")
        question = muted(tr("Leave the plate beside the part? It checks every scan."))
        question.setToolTip(
            tr("The plate of the laser planes lies still beside the part, where the hand-held line crosses it. Before "
               "each live scan its picture is taken. It moves no value; it tells when camera or laser have changed.")
        )  # fmt: skip
        self.yes, self.no = QPushButton(tr("Yes")), QPushButton(tr("No"))
        self.yes.clicked.connect(lambda: presenter.leave_plate_beside(True))
        self.no.clicked.connect(lambda: presenter.leave_plate_beside(False))
        in_column(question, in_row(self.yes, self.no, STRETCH), on=self, margins=(10, 8, 10, 8), spacing=6)
        self.hide()


class SettingsPanel(QWidget):
    """Panel with the settings of the scan."""

    def __init__(self, presenter: ScanPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.form = form = SettingsForm()
        add_settings(form, "scan")
        add_channel(form)
        form.add_section(tr("Shutter of the camera"))
        add_rig_settings(form, "camera")
        form.add_section(tr("Since its calibration the rig may have changed by"))
        for one in STABILITY:
            allowed = NumberRange(
                0.0,
                10_000.0,
                decimals=one.decimals,
                step=one.usual / 10,
                unit=one.unit,
                none_text=tr("assumed"),
                first=one.usual,
            )
            tip = tr("Standard uncertainty; empty: {usual:g} {unit}.", usual=one.usual, unit=one.unit)
            form.add_number(one.key, tr(one.name), allowed, tip)
        self._add_drift(form)
        form.add_section(tr("How long calibration and check hold"))
        add_rig_settings(form, "validity")
        form.edited.connect(presenter.set_setting, Qt.ConnectionType.QueuedConnection)
        in_column(form, on=self)

    def _add_drift(self, form: SettingsForm) -> None:
        """What warmth and time add, and how warm it was."""
        titles = {"per_kelvin": tr("For each kelvin since, in addition"),
                  "per_hour": tr("For each hour since, in addition")}  # fmt: skip
        for rate, title in titles.items():
            form.add_section(title)
            for one in STABILITY:
                first = usual_per_kelvin(one) if rate == "per_kelvin" else one.usual / 100
                allowed = NumberRange(
                    0.0, 1000.0, decimals=one.decimals + 1, step=first, unit=one.unit, none_text=tr("not stated"),
                    first=first,
                )  # fmt: skip
                tip = (
                    tr("Standard uncertainty; empty: none. Usual are {usual:g} {unit}.", usual=first, unit=one.unit)
                    if rate == "per_kelvin"
                    else tr("Standard uncertainty; empty: none.")
                )
                form.add_number(drift_key(rate, one.key), tr(one.name), allowed, tip)
        form.add_section(tr("Temperature"))
        form.add_number(
            "calibrated_celsius",
            tr("Calibrated at"),
            NumberRange(-50.0, 200.0, decimals=1, step=0.5, unit="°C", none_text=tr("not stated"), first=20.0),
            tr("Of the air. That of the scan stands on the Project page; where one is empty, 5 K between them are "
               "assumed."),
        )  # fmt: skip

    def refresh(self) -> None:
        """Show the present settings of the scan."""
        values = self._presenter.settings()
        self.form.set_values(values)
        set_stripe_editable(self.form, values["automatic"])


class ResultPanel(QWidget):
    """Panel with the quality of the measured scan, why frames gave no points, and notes."""

    def __init__(self, presenter: ScanPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.rows, self.reasons, self.notes = ValueRows(), muted(), muted()
        self.alarm = alarm()
        self._shown: ShownScan | None = None
        self._why = heading(tr("Frames without points"))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        for widget in (self.alarm, self.rows, self._why, self.reasons, self.notes):
            column.addWidget(widget)

    def refresh(self) -> None:
        """Show the quality of the measured scan, why frames gave no points, and notes."""
        look = self._presenter.work.look
        if look is not self._shown:
            self._shown = look
            show_facts(self.rows, words.facts(look))
            lines = [text_of(one.line()) for one in left_out(look.frames)] if look is not None else []
            set_text(self.reasons, "\n".join(lines))
            self._why.setVisible(bool(lines))
        said = (*look.notes, *look.problems) if look is not None else ()
        no_gauge = self._presenter.run.no_gauge
        set_notes((*said, *([no_gauge] if no_gauge is not None else [])), self.alarm, self.notes)


class RunningPanel(QWidget):
    """Panel with the motion of the hand while a scan runs: gauges, coverage, hints."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.condition = Meter(
            tr("Tilt"),
            [(500.0, "good"), (20_000.0, "warn"), (1e6, "bad")],
            minimum=10.0,
            logarithmic=True,
            names={"good": tr("good"), "warn": tr("flat"), "bad": tr("too flat")},
        )
        self.condition.setToolTip(
            tr("How near to one straight line this frame's crossings with the fan are (the condition of its light "
                    "plane); too flat as well with fewer than three. Other frames may still help. "
                    "Tilt the laser, or cross the fan at another height.")
        )  # fmt: skip
        self.speed = Meter(tr("Speed"), [(0.6 * FAST, "good"), (FAST, "warn"), (2 * FAST, "bad")])
        self.speed.setToolTip(tr("How far the stripe moves from one frame to the next"))
        self.covered, self.hints = QLabel(), HintBar(tr("What could be better is said here."))
        self.covered.setToolTip(tr("Share of the picture between all laser light in which there are points"))
        self.covered.setWordWrap(True)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 4, 0, 0)
        grid.setHorizontalSpacing(18)
        grid.addWidget(self.condition, 0, 0)
        grid.addWidget(self.speed, 0, 1)
        grid.addWidget(self.covered, 0, 2, Qt.AlignmentFlag.AlignBottom)
        grid.addWidget(self.hints, 1, 0, 1, 3)
        for column in range(3):
            grid.setColumnStretch(column, 1)
        grid.setRowStretch(2, 1)

    def show_detail(self, detail: ScanDetail | None, width_px: float) -> None:
        """Show the hand's motion and the coverage at one frame; `width_px` is its width. None shows nothing."""
        preview = detail.preview if detail is not None and detail.stage == "scanning" else None
        located = preview is None or not math.isnan(preview.condition)
        self.covered.setText(words.covered_sentence(detail.share) if detail is not None and located else "")
        self.hints.set_hints([text_of(hint) for hint in preview.hints] if preview is not None else ())
        if preview is None or not preview.centrelines:
            self.condition.set_value(None)
            self.speed.set_value(None)
            return
        self.condition.set_value(None if math.isnan(preview.condition) else preview.condition)
        speed: Any = None if math.isnan(preview.speed_px) or not width_px else preview.speed_px / width_px
        self.speed.set_value(speed, words.speed_text(preview.speed_px))
