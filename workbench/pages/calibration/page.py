"""What the pages of both calibrations share: pictures in the middle with the error of each below, the rest at the side.

A page adds its panels, says which rows and bars there are, and draws its own tabs.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from workbench.language import text_of, tr
from workbench.pages.calibration.card import CalibrationCard
from workbench.pages.calibration.history_tab import HistoryTab
from workbench.pages.calibration.picture import PictureTab
from workbench.pages.calibration.stage import Stage
from workbench.pages.calibration.work import CalibrationWork
from workbench.pages.step_page import StepPage
from workbench.pages.words import length
from workbench.views.forms.live_panel import LivePanel, LiveStrip
from workbench.views.forms.source_chooser import NextAction, SourceChooser
from workbench.views.layouts import Tabs
from workbench.views.lists.view_list import ListRow, ViewList
from workbench.views.plots.bars import Bar, BarsWithThreshold
from workbench.views.plots.base import LEAST_HEIGHT

BARS_HEIGHT, BARS_SHARE = 150, 0.28
"""Pixels of the bars, and their share of a page that is low; the picture takes the rest."""


class CalibrationPage(StepPage):
    """Page of a calibration: record, calibrate, judge, accept.

    A subclass makes the parts named below before it calls `_build`.
    """

    UNIT: ClassVar[str]
    """Of the errors of views."""

    picture: PictureTab
    history: HistoryTab
    card: CalibrationCard
    live: QWidget
    """Where live pictures come from; `live_panel` is it or is in it."""
    live_panel: LivePanel
    setup: Sequence[tuple[str, Any]]
    """Titles and forms of what is asked for first, the target before all."""
    result: Any
    """Its `refresh` says whether there is anything to show."""

    def __init__(self, presenter: Any, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.strip, self.tabs, self.bars = LiveStrip(presenter.live), Tabs(), BarsWithThreshold()
        self.centre.addWidget(self.strip)
        self.centre.addWidget(self.tabs, 1)
        self.centre.addWidget(self.bars)
        self.views = ViewList()
        self._rows: Any = None
        self._bars: Any = None
        self._folded = ""

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.bars.setFixedHeight(min(BARS_HEIGHT, max(LEAST_HEIGHT, round(BARS_SHARE * self.height()))))

    # ---- what differs

    @abstractmethod
    def _error(self, view: Any) -> float:
        """How badly a view fits, in `UNIT`; NaN where that is not known."""

    @abstractmethod
    def _sentence(self, view: Any) -> str:
        """What is to be said of one view."""

    @abstractmethod
    def _count(self, count: int) -> str:
        """So many pictures in the folder, in words."""

    @abstractmethod
    def _tabs_with_bars(self) -> Sequence[QWidget]:
        """The tabs that are about the errors of the views, which stand below them."""

    def _threshold(self, bars: Sequence[Bar]) -> float | None:
        """The line that can be pulled down to leave out what is above it; None for none."""
        return None

    # ---- building

    def _build(self, tabs: Sequence[tuple[QWidget, str, str]], folder: str, views: str, one: str) -> None:
        """Put it together.

        Parameters
        ----------
        tabs
            The tabs with title and tool tip; the first is the picture.
        folder
            What is said of the folder of pictures.
        views, one
            What the pictures are called, and one of them.
        """
        p = self.presenter
        for tab, title, tip in tabs:
            self.tabs.add(tab, title, tip)
        self.tabs.currentChanged.connect(lambda _: self._refresh_tab())
        self.add_to_side(self.card)
        self.source = SourceChooser(self.live, what=folder)
        self.pictures_fold = self.add_panel(tr("Pictures"), self.source)
        self.setup_folds = [self.add_panel(title, form) for title, form in self.setup]
        self.target_fold = self.setup_folds[0]
        self._one = one
        self.views_fold = self.add_list(views, self.views)
        self._add_settings()
        self.result_fold = self.add_panel(tr("Result"), self.result)  # last: there it pushes nothing as it comes
        self.source.folder_chosen.connect(p.use_folder)
        self.source.mode_changed.connect(self.refreshing.soon)
        self.source.accept_drops_on(self)
        self.views.toggled_together.connect(lambda names, used: p.set_used(list(names), used))
        self.views.current_changed.connect(p.choose)
        self.bars.bar_clicked.connect(p.choose)
        p.model.opened.connect(self._opened)

    def _add_settings(self) -> None:
        """What else can be set, above the result."""

    def _next_action(self) -> NextAction:
        return self.source.next_action(self.presenter.live)

    def _opened(self) -> None:
        self._folded = ""
        self.tabs.setCurrentIndex(0)
        self.source.set_mode("folder" if self.presenter.folder is not None else "live")

    # ---- showing

    def refresh(self) -> None:
        p, live = self.presenter, self._is_live()
        self.card.refresh()
        for _, form in self.setup:
            form.refresh()
            form.setEnabled(not live)
        known = p.work.pictures is not None and p.folder is not None
        self.source.set_folder(p.folder, self._count(len(p.work.pictures)) if known else "")
        self.live_panel.set_primary(p.stage in (Stage.NONE, Stage.EMPTY))  # taking some is the next thing to do
        self._fold()
        self._show_views()
        self.result_fold.setVisible(self.result.refresh() and not live)
        self._refresh_tab()

    def _is_live(self) -> bool:
        """Whether pictures are being taken."""
        return bool(self.presenter.stage is Stage.LIVE)

    def _fold(self) -> None:
        """Once there is a result, it takes the room of what it was made from; the user may unfold that again."""
        live, work = self._is_live(), self._work
        wanted = "live" if live else "result" if work.searching or work.found is not None else "pictures"
        if wanted == self._folded:
            return
        self._folded = wanted
        if live:
            self.source.set_mode("live")
            self.tabs.setCurrentIndex(0)
        opened = [(self.pictures_fold, wanted != "result")]
        for fold, open_ in opened + [(fold, wanted == "pictures") for fold in self.setup_folds]:
            if open_:
                fold.expand(animate=False)
            else:
                fold.collapse(animate=False)

    @property
    def _work(self) -> CalibrationWork[Any, Any]:
        work: CalibrationWork[Any, Any] = self.presenter.work
        return work

    def _refresh_tab(self) -> None:
        tab: Any = self.tabs.currentWidget()
        tab.refresh()
        self._show_bars()

    def _show_views(self) -> None:
        rows, current = self._view_rows(), self.presenter.current
        self.views_fold.setVisible(bool(rows))
        shown = [(row.name, row.text, row.used, row.reason, id(row.thumbnail)) for row in rows]
        if shown != self._rows:
            self._rows = shown
            measured = self._work.calibration is not None and not self._is_live()
            self.views.set_headers(self._one, f"{tr('RMS')} [{self.UNIT}]" if measured else "")
            self.views.set_rows(rows)
        if current and self.views.current() != current:
            self.views.set_current(current)

    def _view_rows(self) -> list[ListRow]:
        """The pictures, as far as they are known."""
        p, work = self.presenter, self._work
        if p.live.running:
            return [
                ListRow(name, None, tr("taken"), thumbnail=picture, title=p.short(name))
                for name, picture in p.live_views
            ]
        if work.calibration is not None:
            return [
                ListRow(
                    view.name, known(self._error(view)), length(self._error(view), self.UNIT), view.used,
                    text_of(view.reason or ""), work.thumbnails.get(view.name), p.short(view.name),
                )
                for view in p.views()
            ]  # fmt: skip
        excluded, reasons = p.project.options.excluded, work.left_out()
        return [
            ListRow(
                name, None, "", p.stored(name) not in excluded and name not in reasons,
                text_of(reasons.get(name, "")), work.thumbnails.get(name), p.short(name),
            )
            for name in map(work.name_of, work.pictures or ())
        ]  # fmt: skip

    def _show_bars(self) -> None:
        """The error of each view, below what it is about."""
        shown = not self._is_live() and self.tabs.currentWidget() in self._tabs_with_bars()
        bars = [
            Bar(view.name, known(self._error(view)), view.used, self._sentence(view))
            for view in (self.presenter.views() if shown else ())
        ]
        self.bars.setVisible(bool(bars))
        threshold = self._threshold(bars)
        if bars and (bars, threshold) != self._bars:
            self._bars = bars, threshold
            self.bars.set_bars(bars, label=tr("RMS"), unit=self.UNIT, threshold=threshold)
        self.bars.set_current(self.presenter.current)


class Result(QWidget):
    """Panel with the quality of the calibration shown."""

    def __init__(self, presenter: Any, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.column = QVBoxLayout(self)
        self.column.setContentsMargins(0, 0, 0, 0)

    def _add(self, *widgets: QWidget) -> None:
        for widget in widgets:
            self.column.addWidget(widget)

    @abstractmethod
    def refresh(self) -> bool:
        """Show the quality of the calibration; return False if there is no calibration."""


def known(value: float) -> float | None:
    """Return `value`, or None if it is NaN."""
    return None if math.isnan(value) else value
