"""The camera page: pictures of the target in the middle, source, target, views and result at the side."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QTabWidget, QVBoxLayout, QWidget

from workbench.pages import camera_words as words
from workbench.pages.camera_panels import TARGETS, CameraCard, CameraModelForm
from workbench.pages.camera_picture import PictureTab
from workbench.pages.camera_presenter import CameraPresenter, short
from workbench.pages.camera_stage import Stage
from workbench.pages.camera_tabs import CoverageTab, ExpectedTab, HistoryTab, ResidualTab
from workbench.pages.step_page import StepPage, heading, muted
from workbench.pages.target_panel import TargetPanel
from workbench.views.live_panel import LivePanel
from workbench.views.live_strip import LiveStrip
from workbench.views.plots import Bar, BarsWithThreshold
from workbench.views.source_chooser import SourceChooser
from workbench.views.tables import ListRow, ViewList
from workbench.views.value_rows import ValueRows


class CameraPage(StepPage):
    """Record, calibrate, judge, accept."""

    presenter: CameraPresenter

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.strip, self.tabs, self.bars = LiveStrip(presenter.live), QTabWidget(), BarsWithThreshold()
        self.picture, self.coverage = PictureTab(presenter, lambda: self.source.choose()), CoverageTab(presenter)
        self.residuals, self.expected = ResidualTab(presenter), ExpectedTab(presenter)
        self.history = HistoryTab(presenter)
        for tab, title, tip in (
            (self.picture, self.tr("Picture"), self.tr("One view with its corners and residuals")),
            (self.coverage, self.tr("Coverage"), self.tr("What the views cover, and what is missing")),
            (self.residuals, self.tr("Residuals"), self.tr("How far all corners are from where they should be")),
            (self.expected, self.tr("Expected error"), self.tr("How far off the camera may see a point, in mm")),
            (self.history, self.tr("History"), self.tr("Calibrations accepted before: compare, restore")),
        ):
            self.tabs.setTabToolTip(self.tabs.addTab(tab, title), tip)
        self.tabs.currentChanged.connect(lambda _: self._refresh_tab())
        self.bars.setFixedHeight(150)
        self.centre.addWidget(self.strip)
        self.centre.addWidget(self.tabs, 1)
        self.centre.addWidget(self.bars)

        self.card = CameraCard(presenter)
        self.add_to_side(self.card)
        self.live_panel = LivePanel(presenter.live)
        self.source = SourceChooser(self.live_panel, what=self.tr("Folder with pictures of the camera's target"))
        self.pictures_fold = self.add_panel(self.tr("Pictures"), self.source)
        self.target = TargetPanel(presenter.target, TARGETS)
        self.target_fold = self.add_panel(self.tr("Target"), self.target)
        self.views = ViewList()
        self.views.setMinimumHeight(240)
        self.views_fold = self.add_panel(self.tr("Views"), self.views)
        self.quality, self.parameters, self.notes = ValueRows(), ValueRows(), muted()
        self.result_fold = self.add_panel(self.tr("Result"), self._result())
        self.model = CameraModelForm(presenter)
        self.add_panel(self.tr("Camera model"), self.model, collapsed=True)
        self._rows: Any = None
        self._bars: Any = None
        self._folded = ""
        self._connect()

    def refresh(self) -> None:
        p = self.presenter
        stage = p.stage
        self.card.refresh()
        self.target.refresh()
        self.model.refresh()
        self.target.setEnabled(stage is not Stage.LIVE)
        count = len(p.work.pictures) if p.work.pictures is not None else None
        detail = self.tr("{0} pictures").format(count) if count is not None and p.folder is not None else ""
        self.source.set_folder(p.folder, detail)
        self.live_panel.set_primary(stage in (Stage.NONE, Stage.EMPTY))
        self._fold(stage)
        self._show_views()
        calibration = p.work.calibration
        self.quality.set_rows(words.quality_rows(calibration, p.work.judgement))
        self.parameters.set_rows(words.parameter_rows(calibration))
        self.notes.setText("\n".join(calibration.notes) if calibration is not None else "")
        self.notes.setVisible(bool(self.notes.text()))
        self.result_fold.setVisible(calibration is not None and stage is not Stage.LIVE)
        self._refresh_tab()

    def _connect(self) -> None:
        p = self.presenter
        self.source.folder_chosen.connect(p.use_folder)
        self.source.accept_drops_on(self)
        self.views.toggled_together.connect(lambda names, used: p.set_used(list(names), used))
        self.views.current_changed.connect(p.choose_view)
        self.bars.bar_clicked.connect(p.choose_view)
        self.bars.threshold_changed.connect(p.set_threshold)
        p.model.opened.connect(self._opened)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "_folded"):
            self._changed()

    def _opened(self) -> None:
        self._folded = ""
        self.tabs.setCurrentIndex(0)
        self.source.set_mode("folder" if self.presenter.project.sources.camera else "live")

    def _fold(self, stage: Stage) -> None:
        """Once there is a result, it takes the room of what it was made from; the user may unfold that again."""
        live, work = stage is Stage.LIVE, self.presenter.work
        wanted = "live" if live else "result" if work.searching or work.seen is not None else "pictures"
        if wanted == self._folded:
            return
        self._folded = wanted
        if live:
            self.source.set_mode("live")
            self.tabs.setCurrentWidget(self.picture)
        for fold, opened in ((self.pictures_fold, wanted != "result"), (self.target_fold, wanted == "pictures")):
            if opened:
                fold.expand(animate=False)
            else:
                fold.collapse(animate=False)

    def _refresh_tab(self) -> None:
        tab: Any = self.tabs.currentWidget()
        tab.refresh()
        self._show_bars()

    def _show_views(self) -> None:
        rows = self._view_rows()
        self.views_fold.setVisible(bool(rows))
        shown = [(row.name, row.text, row.used, row.reason, id(row.thumbnail)) for row in rows]
        if shown != self._rows:
            self._rows = shown
            measured = self.presenter.work.calibration is not None and not self.presenter.live.running
            self.views.set_headers(self.tr("View"), self.tr("RMS (px)") if measured else "")
            self.views.set_rows(rows)
        if self.presenter.current and self.views.current() != self.presenter.current:
            self.views.set_current(self.presenter.current)

    def _show_bars(self) -> None:
        """The error of each view, below what it is about."""
        about = self.tabs.currentWidget() in (self.picture, self.coverage, self.residuals)
        views = self.presenter.views() if about and not self.presenter.live.running else ()
        bars = [
            Bar(view.view.name, known(view.rms_px), view.used, words.view_sentence(short(view.view.name), view))
            for view in views
        ]
        self.bars.setVisible(bool(bars))
        threshold = self.presenter.threshold
        if threshold is None:  # a little above all, ready to be pulled down
            threshold = 1.15 * max((bar.value or 0.0 for bar in bars if bar.used), default=0.0)
        if bars and (bars, threshold) != self._bars:
            self._bars = bars, threshold
            self.bars.set_bars(bars, label=self.tr("RMS"), unit="px", threshold=threshold)
        self.bars.set_current(self.presenter.current)

    def _view_rows(self) -> list[ListRow]:
        p, work = self.presenter, self.presenter.work
        if p.live.running:
            return [
                ListRow(name, None, self.tr("taken"), thumbnail=picture, title=short(name))
                for name, picture in p.live_views
            ]
        if work.calibration is not None:
            return [
                ListRow(
                    view.view.name, known(view.rms_px), words.px(view.rms_px), view.used, view.reason,
                    work.thumbnails.get(view.view.name), short(view.view.name),
                )
                for view in work.calibration.views
            ]  # fmt: skip
        excluded = p.project.options.excluded
        reasons = {view.name: view.reason for view in work.seen.lost} if work.seen is not None else {}
        return [
            ListRow(
                name, None, "", name not in excluded and name not in reasons, reasons.get(name, ""),
                work.thumbnails.get(name), short(name),
            )
            for name in (f"camera/{path.name}" for path in work.pictures or ())
        ]  # fmt: skip

    def _result(self) -> QWidget:
        result = QWidget()
        column = QVBoxLayout(result)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.quality)
        column.addWidget(heading(self.tr("Parameters ± sd")))
        column.addWidget(self.parameters)
        column.addWidget(self.notes)
        return result


def known(value: float) -> float | None:
    """None for NaN."""
    return None if math.isnan(value) else value
