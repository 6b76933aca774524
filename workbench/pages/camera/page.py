"""The camera page: pictures of the target in the middle, source, target, views and result at the side."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtWidgets import QVBoxLayout, QWidget

from workbench.language import text_of
from workbench.pages.calibration.page import CalibrationPage, known
from workbench.pages.calibration.stage import Stage
from workbench.pages.calibration.target_panel import TargetPanel
from workbench.pages.camera import words
from workbench.pages.camera.panels import TARGETS, CameraCard, CameraModelForm
from workbench.pages.camera.picture import PictureTab
from workbench.pages.camera.presenter import CameraPresenter, short
from workbench.pages.camera.tabs import CoverageTab, ExpectedTab, HistoryTab, ResidualTab
from workbench.pages.step_page import heading, muted
from workbench.views.forms.live_panel import LivePanel
from workbench.views.lists.value_rows import ValueRows
from workbench.views.lists.view_list import ListRow
from workbench.views.plots.bars import Bar


class CameraPage(CalibrationPage):
    """Record, calibrate, judge, accept."""

    UNIT = "px"
    presenter: CameraPresenter

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.picture, self.coverage = PictureTab(presenter, lambda: self.source.choose()), CoverageTab(presenter)
        self.residuals, self.expected = ResidualTab(presenter), ExpectedTab(presenter)
        self.history = HistoryTab(presenter)
        self._add_tabs(
            (self.picture, self.tr("Picture"), self.tr("One view with its corners and residuals")),
            (self.coverage, self.tr("Coverage"), self.tr("What the views cover, and what is missing")),
            (self.residuals, self.tr("Residuals"), self.tr("How far all corners are from where they should be")),
            (self.expected, self.tr("Expected error"), self.tr("How far off the camera may see a point, in mm")),
            (self.history, self.tr("History"), self.tr("Calibrations accepted before: compare, restore")),
        )
        self.card = CameraCard(presenter)
        self.add_to_side(self.card)
        panel = LivePanel(presenter.live)
        self._add_source(panel, panel, self.tr("Folder with pictures of the camera's target"))
        self.target = TargetPanel(presenter.target, TARGETS)
        self.target_fold = self.add_panel(self.tr("Target"), self.target)
        self._setup_folds = (self.target_fold,)
        self.views_fold = self.add_list(self.tr("Views"), self.views)
        self.quality, self.parameters, self.notes = ValueRows(), ValueRows(), muted()
        self.result_fold = self.add_panel(self.tr("Result"), self._result())
        self.model = CameraModelForm(presenter)
        self.add_panel(self.tr("Camera model"), self.model, collapsed=True)
        self.bars.threshold_changed.connect(presenter.set_threshold)
        self._connect(presenter.choose_view)

    def refresh(self) -> None:
        p = self.presenter
        stage = p.stage
        self.card.refresh()
        self.target.refresh()
        self.model.refresh()
        self.target.setEnabled(not self._is_live())
        self._show_source(self.tr("{0} pictures"), first=stage in (Stage.NONE, Stage.EMPTY))
        self._fold()
        self._show_views(self.views_fold)
        calibration = p.work.calibration
        self.quality.set_rows(words.quality_rows(calibration, p.work.judgement))
        self.parameters.set_rows(words.parameter_rows(calibration))
        self.notes.setText("\n".join(map(text_of, calibration.notes)) if calibration is not None else "")
        self.notes.setVisible(bool(self.notes.text()))
        self.result_fold.setVisible(calibration is not None and not self._is_live())
        self._refresh_tab()

    def _is_live(self) -> bool:
        return self.presenter.stage is Stage.LIVE

    def _headings(self) -> tuple[str, str]:
        return self.tr("View"), self.tr("RMS [px]")

    def _view_bars(self) -> list[Bar]:
        if self.tabs.currentWidget() not in (self.picture, self.coverage, self.residuals):
            return []
        return [
            Bar(view.view.name, known(view.rms_px), view.used, words.view_sentence(short(view.view.name), view))
            for view in self.presenter.views()
        ]

    def _threshold(self, bars: Sequence[Bar]) -> float | None:
        threshold = self.presenter.threshold
        if threshold is None:  # a little above all, ready to be pulled down
            threshold = 1.15 * max((bar.value or 0.0 for bar in bars if bar.used), default=0.0)
        return threshold

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
                    view.view.name, known(view.rms_px), words.px(view.rms_px), view.used, text_of(view.reason or ""),
                    work.thumbnails.get(view.view.name), short(view.view.name),
                )
                for view in work.calibration.views
            ]  # fmt: skip
        excluded = p.project.options.excluded
        reasons = {view.name: text_of(view.reason or "") for view in work.seen.lost} if work.seen is not None else {}
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
