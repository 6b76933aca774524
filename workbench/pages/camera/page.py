"""The camera page: pictures of the target in the middle, source, target, views and result at the side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtWidgets import QWidget

from workbench.language import tr
from workbench.pages.calibration.page import CalibrationPage
from workbench.pages.calibration.target_panel import TargetPanel
from workbench.pages.camera import words
from workbench.pages.camera.panels import TARGETS, CameraCard, CameraModelForm, CameraResult
from workbench.pages.camera.picture import ViewTab
from workbench.pages.camera.presenter import CameraPresenter
from workbench.pages.camera.tabs import CameraHistoryTab, CoverageTab, ExpectedTab, ResidualTab
from workbench.views.forms.live_panel import LivePanel
from workbench.views.plots.bars import Bar


class CameraPage(CalibrationPage):
    """Page of the camera calibration: record, calibrate, judge, accept."""

    UNIT = "px"
    presenter: CameraPresenter

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self._counted: tuple[int, int] | None = None
        self.picture, self.coverage = ViewTab(presenter, self._next_action), CoverageTab(presenter)
        self.residuals, self.expected = ResidualTab(presenter), ExpectedTab(presenter)
        self.history = CameraHistoryTab(presenter)
        self.card, self.result = CameraCard(presenter), CameraResult(presenter)
        self.live = self.live_panel = LivePanel(presenter.live)
        self.target, self.model = TargetPanel(presenter.target, TARGETS), CameraModelForm(presenter)
        self.setup = [(tr("Target"), self.target)]
        self._build(
            (
                (self.picture, tr("Picture"), tr("One view with its corners and residuals")),
                (self.coverage, tr("Coverage"), tr("What the views cover, and what is missing")),
                (self.residuals, tr("Residuals"), tr("How far all corners are from where they should be")),
                (self.expected, tr("Expected error"), tr("How far off the camera may see a point, in mm")),
                (self.history, tr("History"), tr("Calibrations accepted before: compare, restore")),
            ),
            tr("Folder with pictures of the camera's target"),
            tr("Views"),
            tr("View"),
        )
        self.bars.threshold_changed.connect(presenter.set_threshold)

    def _add_settings(self) -> None:
        self.add_panel(tr("Camera model"), self.model, collapsed=True, kept="model")

    def refresh(self) -> None:
        self.model.refresh()
        counted, self._counted = self._counted, self.presenter.counted
        if self._counted not in (None, counted):
            self.tabs.setCurrentWidget(self.picture)  # the right count is offered there
        super().refresh()

    def _error(self, view: Any) -> float:
        return float(view.rms_px)

    def _sentence(self, view: Any) -> str:
        return words.view_sentence(self.presenter.short(view.name), view)

    def _count(self, count: int) -> str:
        return tr("{count} pictures", count=count)

    def _tabs_with_bars(self) -> Sequence[QWidget]:
        return self.picture, self.coverage, self.residuals

    def _threshold(self, bars: Sequence[Bar]) -> float | None:
        threshold = self.presenter.threshold
        if threshold is None:  # a little above all, ready to be pulled down
            threshold = 1.15 * max((bar.value or 0.0 for bar in bars if bar.used), default=0.0)
        return threshold
