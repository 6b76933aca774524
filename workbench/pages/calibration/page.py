"""What the pages of both calibrations share: pictures in the middle with the error of each below, the rest at the side.

A page adds its panels, says which rows and bars there are, and draws its own tabs.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

from PySide6.QtWidgets import QTabWidget, QWidget
from superqt import QCollapsible

from workbench.pages.calibration.work import CalibrationWork
from workbench.pages.step_page import StepPage
from workbench.views.forms.live_panel import LivePanel, LiveStrip
from workbench.views.forms.source_chooser import SourceChooser
from workbench.views.lists.view_list import ListRow, ViewList
from workbench.views.plots.bars import Bar, BarsWithThreshold

BARS_HEIGHT = 150


class CalibrationPage(StepPage):
    """Record, calibrate, judge, accept."""

    UNIT: str
    """Of the errors of views."""

    def __init__(self, presenter: Any, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.strip, self.tabs, self.bars = LiveStrip(presenter.live), QTabWidget(), BarsWithThreshold()
        self.tabs.currentChanged.connect(lambda _: self._refresh_tab())
        self.bars.setFixedHeight(BARS_HEIGHT)
        self.centre.addWidget(self.strip)
        self.centre.addWidget(self.tabs, 1)
        self.centre.addWidget(self.bars)
        self.views = ViewList()
        self.source: SourceChooser
        self.live_panel: LivePanel
        self.pictures_fold: QCollapsible
        self._setup_folds: tuple[QCollapsible, ...] = ()
        self._rows: Any = None
        self._bars: Any = None
        self._folded = ""

    # ---- what differs

    @abstractmethod
    def _is_live(self) -> bool:
        """Whether pictures are being taken."""

    @abstractmethod
    def _view_rows(self) -> list[ListRow]:
        """The pictures, as far as they are known."""

    @abstractmethod
    def _headings(self) -> tuple[str, str]:
        """What is listed, and what its number is."""

    @abstractmethod
    def _view_bars(self) -> list[Bar]:
        """The errors that belong below the tab that is shown; none below one that is about something else."""

    def _threshold(self, bars: Sequence[Bar]) -> float | None:
        """The line that can be pulled down to leave out what is above it; None for none."""
        return None

    # ---- building

    def _add_tabs(self, *tabs: tuple[QWidget, str, str]) -> None:
        """Tabs with title and tool tip; the first is the picture."""
        for tab, title, tip in tabs:
            self.tabs.setTabToolTip(self.tabs.addTab(tab, title), tip)

    def _add_source(self, live: QWidget, panel: LivePanel, what: str) -> None:
        """Where pictures come from; `what` is said of the folder of pictures."""
        self.live_panel, self.source = panel, SourceChooser(live, what=what)
        self.pictures_fold = self.add_panel(self.tr("Pictures"), self.source)

    def _connect(self, choose: Callable[[str], None]) -> None:
        """Join everything; `choose` shows the view of that name."""
        p = self.presenter
        self.source.folder_chosen.connect(p.use_folder)
        self.source.accept_drops_on(self)
        self.views.toggled_together.connect(lambda names, used: p.set_used(list(names), used))
        self.views.current_changed.connect(choose)
        self.bars.bar_clicked.connect(choose)
        p.model.opened.connect(self._opened)

    def _opened(self) -> None:
        self._folded = ""
        self.tabs.setCurrentIndex(0)
        self.source.set_mode("folder" if self.presenter.folder is not None else "live")

    # ---- showing

    def _show_source(self, detail: str, *, first: bool) -> None:
        """The folder and how many pictures it holds; `first`: taking some is the next thing to do."""
        p = self.presenter
        known = p.work.pictures is not None and p.folder is not None
        self.source.set_folder(p.folder, detail.format(len(p.work.pictures)) if known else "")
        self.live_panel.set_primary(first)

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
        for fold, open_ in opened + [(fold, wanted == "pictures") for fold in self._setup_folds]:
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

    def _show_views(self, fold: QCollapsible) -> None:
        rows, current = self._view_rows(), self.presenter.current
        fold.setVisible(bool(rows))
        shown = [(row.name, row.text, row.used, row.reason, id(row.thumbnail)) for row in rows]
        if shown != self._rows:
            self._rows = shown
            measured = self._work.calibration is not None and not self._is_live()
            title, number = self._headings()
            self.views.set_headers(title, number if measured else "")
            self.views.set_rows(rows)
        if current and self.views.current() != current:
            self.views.set_current(current)

    def _show_bars(self) -> None:
        """The error of each view, below what it is about."""
        bars = [] if self._is_live() else self._view_bars()
        self.bars.setVisible(bool(bars))
        threshold = self._threshold(bars)
        if bars and (bars, threshold) != self._bars:
            self._bars = bars, threshold
            self.bars.set_bars(bars, label=self.tr("RMS"), unit=self.UNIT, threshold=threshold)
        self.bars.set_current(self.presenter.current)


def known(value: float) -> float | None:
    """None for NaN."""
    return None if math.isnan(value) else value
