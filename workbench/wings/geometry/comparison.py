"""The scan compared with another surface: with which, how it is aligned, and what is seen of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from core.wings.geometry.comparison.shown import AUTOMATIC, ShownComparison
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.inspect.scan import InspectScan
from workbench.wing import Coloured
from workbench.wings.geometry import jobs
from workbench.wings.geometry.buttons import ComparisonButtons, ComparisonFacts, comparison_buttons

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from workbench.work.tasks import Task


class InspectComparison(QObject):
    """Comparison with another surface: it is written among the results, and is no edit of the project."""

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
        self.shows_other = False
        self._coloured: Coloured | None = None
        self._running: Task | None = None

    @property
    def buttons(self) -> ComparisonButtons:
        """Reason why each button of the comparison is disabled; "" if it is enabled."""
        return comparison_buttons(
            ComparisonFacts(
                no_surface=self._scan.buttons.measure,
                cannot_write=self._bench.cannot_write,
                running=self._running is not None,
                shown=self.shown is not None,
            )
        )

    @property
    def coloured(self) -> Coloured | None:
        """Deviations that colour the surface, without those that are not significant if so chosen; None for none."""
        shown, only = self.shown, self.significant_only
        if shown is not None and self._coloured is None:
            self._coloured = Coloured(
                tr("deviation from {other}", other=shown.other),
                shown.range_mm,
                shown.of_points(significant_only=only),
                shown.of_mesh(significant_only=only),
                tr("not significant") if only else "",
            )
        return self._coloured

    @property
    def why_not(self) -> str:
        """Reason why the surface cannot be coloured by the deviation; "" if it can."""
        return "" if self.shown is not None else self.buttons.look

    @property
    def beside(self) -> NDArray[np.float32] | None:
        """Points (M, 3) in mm of the other surface, if they are to be shown beside the scan."""
        return self.shown.other_points if self.shown is not None and self.shows_other else None

    def compare(self, other: Path) -> None:
        """Compare the scan with the surface in the file or folder `other`, in the background."""
        folder = self._bench.model.folder
        if folder is None or self.buttons.compare:
            return
        self.other = other

        def done(shown: Any) -> None:
            if folder == self._bench.model.folder:
                self.shown, self._coloured = shown, None
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
            writes=True,
        )
        self._running.ended.connect(self._ended)
        self.changed.emit()

    def set_value(self, key: str, value: Any) -> None:
        """Set the alignment ("align") or the diameter ("diameter") in mm, and compare again."""
        if value == getattr(self, key):
            return
        setattr(self, key, value)
        if self.other is not None and self.shown is not None and not self.buttons.compare:
            self.compare(self.other)
        self.changed.emit()

    def show_significant_only(self, only: bool) -> None:
        """Grey out places whose deviation is not significant, or not."""
        self.significant_only, self._coloured = only, None
        self.changed.emit()

    def show_beside(self, beside: bool) -> None:
        """Show the other surface beside the scan, or not."""
        self.shows_other = beside
        self.changed.emit()

    def take_away(self) -> None:
        """Remove the comparison from the view and from the project's results."""
        folder = self._bench.model.folder
        if folder is None or self.buttons.take_away:
            return
        self._bench.run_quick(
            self,
            jobs.FORGET_COMPARISON,
            folder,
            label=tr("Taking the comparison away"),
            on_done=lambda _: self.forget() if folder == self._bench.model.folder else None,
            writes=True,
        )

    def forget(self) -> None:
        """Drop the comparison shown, as another scan or another project is shown."""
        self.shown = self.other = self._coloured = None
        self.changed.emit()

    def _ended(self) -> None:
        self._running = None
        self.changed.emit()


def comparison_of(presenter: InspectPresenter) -> InspectComparison:
    """Make the comparison of the scan that the page shows."""
    return InspectComparison(presenter.bench, presenter.scan)
