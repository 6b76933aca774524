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
        """Project that is open, as it is now."""
        return self.model.project

    @property
    def state(self) -> StepState:
        """State of this page's step, as the rail shows it."""
        return self.model.states[self.step]

    def blocker(self) -> str:
        """Return a sentence on what is missing before Next makes sense; "" if nothing is."""
        return ""

    @property
    def waits_to_be_accepted(self) -> bool:
        """Whether a calibration is shown that can be accepted now."""
        return False

    @property
    def is_working(self) -> bool:
        """Whether a calibration is being computed or stored."""
        return False

    def opened(self) -> None:
        """Drop what belongs to the last project, and load what the page needs of the one now open."""

    def project_changed(self, before: Project, after: Project) -> None:
        """React to an edit of the project, or its undo, by which `before` became `after`."""

    def entered(self) -> None:
        """React to the page being shown."""

    def left(self) -> None:
        """React to the page being hidden."""

    def _opened(self) -> None:
        self.opened()
        self.changed.emit()

    def _project_changed(self, before: Project, after: Project) -> None:
        self.project_changed(before, after)
        self.changed.emit()
