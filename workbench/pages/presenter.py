"""What all presenters have in common: they decide, keep no widgets, and say when their page must look again."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from core.files.project.data import Project
from workbench.bench import Bench
from workbench.step_state import StepState


class StepPresenter(QObject):
    """Presenter of one page: its actions and decisions.

    `step` is its name in `workbench.step_state.ORDER`. `changed` is emitted whenever the page must be drawn anew. A
    subclass overrides `blocker` and, as needed, `opened` (another project), `project_changed` (an edit, undo or redo),
    `entered` and `left` (the page is shown or hidden).
    """

    step = ""
    changed = Signal()

    go_to = Signal(str)
    """The user wants the page of this step, for what is missing here comes from there."""

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self.bench, self.model = bench, bench.model
        self.model.opened.connect(self._opened)
        self.model.changed.connect(self._project_changed)
        self.model.results_changed.connect(self.changed)

    @property
    def project(self) -> Project:
        """Present project."""
        return self.model.project

    @property
    def state(self) -> StepState:
        """State of this step."""
        return self.model.states[self.step]

    def blocker(self) -> str:
        """Say in one sentence what is missing before Next makes sense, or ""."""
        return ""

    @property
    def waits_to_be_accepted(self) -> bool:
        """Whether there is a calibration that can be accepted."""
        return False

    @property
    def is_working(self) -> bool:
        """Whether a calibration is being computed or stored."""
        return False

    def opened(self) -> None:
        """Forget the last project, and load what this page needs of the opened one (or none)."""

    def project_changed(self, before: Project, after: Project) -> None:
        """Follow an edit of the project, or its undo."""

    def entered(self) -> None:
        """Follow that the page is shown."""

    def left(self) -> None:
        """Follow that the page is hidden."""

    def _opened(self) -> None:
        self.opened()
        self.changed.emit()

    def _project_changed(self, before: Project, after: Project) -> None:
        self.project_changed(before, after)
        self.changed.emit()
