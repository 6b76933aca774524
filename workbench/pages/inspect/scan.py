"""The scan that is shown: read from the results when the page is seen and there is another one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from core.files.project.data import Project
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.inspect.stage import SurfaceButtons, SurfaceFacts, surface_buttons
from workbench.step_state import State
from workbench.work import jobs

if TYPE_CHECKING:
    from core.inspect.results import GaugeResult
    from core.inspect.shown.shown_scan import InspectionView

Key = tuple[object, ...]
"""Names a scan, and its thickness."""


class InspectScan(QObject):
    """Scan that is shown, `view`, with `serial` to tell it from the one before; `problem` is why there is none."""

    changed = Signal()
    """Another scan or another thickness is shown, or none."""

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self._bench, self._model = bench, bench.model
        self.view: InspectionView | None = None
        self.serial = 0
        self.problem = ""
        self.is_new = False
        self._folder: Path | None = None
        """The project that the scan shown is of."""
        self._shown: Key = ()
        self._asked: Key = ()

    @property
    def stale(self) -> bool:
        """Whether a newer scan than the one shown is being read."""
        return self._shown != self._asked

    @property
    def is_of_project(self) -> bool:
        """Whether the scan shown is the one in the project's results, not an earlier one."""
        return self.view is not None and not self.stale and self._folder == self._model.folder

    @property
    def gauge(self) -> GaugeResult | None:
        """Thickness of the scan shown; None if none was measured."""
        return self.view.gauge if self.view is not None else None

    @property
    def buttons(self) -> SurfaceButtons:
        """Reason why each button of the view is disabled; "" if it is enabled."""
        view = self.view
        return surface_buttons(
            SurfaceFacts(
                scan="scan" in self._model.results,
                unreadable=bool(self.problem),
                shown=view is not None,
                mesh=view is not None and view.mesh is not None,
            )
        )

    @property
    def is_old(self) -> bool:
        """Whether the scan shown is out of date: its inputs have changed since."""
        return self._model.states["scan"].state is State.OUTDATED

    @property
    def is_thickness_old(self) -> bool:
        """Whether the thickness shown differs from what the project's settings would give now."""
        return self.stale or self._model.states["inspect"].state is not State.DONE

    @property
    def recording(self) -> str:
        """Name, in the project, of the recording that the scan shown was measured from."""
        done = self._model.results.get("scan")
        return done.rests_on.get("recording", "") if done is not None else ""

    def as_scanned(self) -> Project:
        """Return the project with the recording that the scan in its results was measured from."""
        project = self._model.project
        return replace(project, sources=replace(project.sources, scan=self.recording))

    def look(self, *, seen: bool) -> None:
        """Read the scan in the project's results, if it is not shown yet and the page is `seen`."""
        results = self._model.results
        if "scan" not in results or not self._model.is_open:
            if self.view is not None or self._asked:
                self.forget()
            return
        finished = (results.get("scan"), results.get("gauge"))
        wanted = tuple((done.key, done.at) for done in finished if done is not None)
        if not seen or wanted == self._asked:
            return
        self._asked, self.problem = wanted, ""
        folder = self._model.folder

        def is_wanted() -> bool:
            return wanted == self._asked and folder == self._model.folder

        def done(view: Any) -> None:
            if is_wanted():
                self._take(view)

        def failed(problem: Any) -> None:
            if is_wanted():
                self.problem, self.view = text_of(problem), None
                self.changed.emit()

        def cancelled() -> None:
            if is_wanted():
                self._asked = ()  # what is shown stays old, and is asked for again

        self._bench.run_quick(
            self,
            jobs.INSPECTION_VIEW,
            folder,
            self.as_scanned(),
            label=tr("Reading the scan"),
            on_done=done,
            on_failed=failed,
            on_cancelled=cancelled,
            replace_waiting=True,
        )

    def forget(self) -> None:
        """Drop the scan shown."""
        self.view, self.problem, self.is_new = None, "", True
        self._shown = self._asked = ()
        self.changed.emit()

    def _take(self, view: InspectionView) -> None:
        self.is_new = self._shown[:1] != self._asked[:1]
        self._shown, self._folder = self._asked, self._model.folder
        self.view, self.serial = view, self.serial + 1
        self.changed.emit()
