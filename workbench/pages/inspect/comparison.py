"""The scan compared with another surface: with which, how it is aligned, and what is seen of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from core.inspect.shown.shown_comparison import AUTOMATIC, ShownComparison
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.inspect.scan import InspectScan
from workbench.pages.inspect.stage import ComparisonButtons, ComparisonFacts, comparison_buttons
from workbench.work import jobs

if TYPE_CHECKING:
    from workbench.work.tasks import Task


class InspectComparison(QObject):
    """Nothing of it is an edit of the project: it is written among its results, and is of the scan that is shown."""

    changed = Signal()

    made = Signal()
    """A comparison was made, and is shown now."""

    def __init__(self, bench: Bench, scan: InspectScan) -> None:
        super().__init__()
        self._bench, self._scan = bench, scan
        self.shown: ShownComparison | None = None
        self.other: Path | None = None
        self.align = AUTOMATIC
        self.diameter_mm: float | None = None
        self.significant_only = True
        self.beside = False
        self._running: Task | None = None
        self.serial = 0

    @property
    def buttons(self) -> ComparisonButtons:
        """What can be done."""
        return comparison_buttons(
            ComparisonFacts(
                no_surface=self._scan.buttons.measure,
                cannot_write=self._bench.cannot_write,
                running=self._running is not None,
                shown=self.shown is not None,
            )
        )

    @property
    def look(self) -> tuple[object, ...]:
        """What the colours of the surface hang on."""
        return self.serial, self.significant_only

    def compare(self, other: Path) -> None:
        """Compare the scan with what lies there."""
        folder = self._bench.model.folder
        if folder is None or self.buttons.compare:
            return
        self.other = other

        def done(shown: Any) -> None:
            if folder == self._bench.model.folder:
                self.shown, self.serial = shown, self.serial + 1
                self.made.emit()

        self._running = self._bench.run_long(
            self,
            jobs.SHOW_COMPARISON,
            folder,
            other,
            self.align,
            self.diameter_mm or 0.0,
            label=tr("Comparing surfaces"),
            on_done=done,
        )
        self._running.ended.connect(self._ended)
        self.changed.emit()

    def set_value(self, key: str, value: Any) -> None:
        """Align in another way ("align"), or over another diameter; what is shown is compared anew."""
        if value == getattr(self, key):
            return
        setattr(self, key, value)
        if self.other is not None and self.shown is not None and not self.buttons.compare:
            self.compare(self.other)
        self.changed.emit()

    def show_significant_only(self, only: bool) -> None:
        """Grey out what may be chance."""
        self.significant_only = only
        self.changed.emit()

    def show_beside(self, beside: bool) -> None:
        """Show the other surface beside the scan."""
        self.beside = beside
        self.changed.emit()

    def take_away(self) -> None:
        """Show it no more, and take it out of the results."""
        folder = self._bench.model.folder
        if folder is None or self.buttons.take_away:
            return
        self._bench.run_quick(
            self,
            jobs.FORGET_COMPARISON,
            folder,
            label=tr("Taking the comparison away"),
            on_done=lambda _: self.forget() if folder == self._bench.model.folder else None,
        )

    def forget(self) -> None:
        """Show none: another scan or another project is looked at."""
        self.shown, self.other, self.serial = None, None, self.serial + 1
        self.changed.emit()

    def _ended(self) -> None:
        self._running = None
        self.changed.emit()
