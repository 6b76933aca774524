"""Tools, Plan a rig: what the open project's rig, or that of a rig.toml, will measure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QPushButton, QWidget

from workbench.bench import Bench
from workbench.language import printed, tr
from workbench.theme import icon
from workbench.views import ask
from workbench.views.layouts import enable, in_column, in_row, muted, resize_on_screen
from workbench.views.lists.data_table import DataTable
from workbench.views.plots.map import HeatMap
from workbench.wings.rig_planning import jobs
from workbench.work.jobs import Job
from workbench.work.tasks import Task

if TYPE_CHECKING:
    from core.wings.rig_planning.rig_plan import ForetoldRig

SIZE = (1000, 640)
"""Width and height of the window at first, in pixels."""


def planning_of(bench: Bench, window: QWidget) -> Callable[[], object]:
    """Make the function that opens the planning of a rig, to be called by the menu entry."""
    return RigPlans(bench, window).open


class RigPlans(QObject):
    """Background plans of the open project's rig, or of that in a file, and the window that shows them."""

    def __init__(self, bench: Bench, window: QWidget) -> None:
        super().__init__(window)
        self._bench, self._window = bench, window
        self.shown: PlanWindow | None = None
        """The plan that was made last, or that is being made."""

    def open(self) -> None:
        """Show the window, and predict what the open project's rig will measure, or ask for a rig.toml."""
        model = self._bench.model
        if model.folder is None:
            self.choose()
            return
        name = model.project.info.name or model.folder.name
        said = tr(
            "The rig of {project}: targets, laser and part as stated, camera and laser as they are calibrated, as many "
            "pictures as there are; what is not known yet is as in the paper's rig. Save also writes its rig.toml, to "
            "be changed and planned again.",
            project=name,
        )
        self._run(jobs.FORETELL_PROJECT, (model.folder, model.project), name, said)

    def choose(self) -> None:
        """Ask for a rig.toml, and predict what that rig will measure."""
        kinds = tr("Rig (*.toml)")
        path = ask.choose_file_to_open(self._window, tr("Plan a rig"), self._bench.settings.projects_folder, kinds)
        if path is not None:
            self.plan(path)

    def plan(self, rig: Path) -> None:
        """Predict what the rig in a rig.toml will measure, in the background."""
        self._run(jobs.FORETELL_RIG, (rig,), rig.name, str(rig))

    def _run(self, job: Job, what: tuple[object, ...], name: str, said: str) -> None:
        """Plan, in a window that is there at once; closed before there is a plan, it needs none any more."""
        if self.shown is not None:
            self.shown.close()
        self.shown = shown = PlanWindow(self._bench, name, said, self._window)
        task = self._bench.run_long(
            shown,
            job,
            *what,
            printed(),
            label=tr("Planning the rig"),
            on_done=shown.show_plan,
            on_failed=lambda _: shown.close(),
            on_cancelled=shown.close,
        )
        shown.closed.connect(lambda: self._closed(shown, task))
        shown.other.clicked.connect(self.choose)
        shown.show()

    def _closed(self, window: PlanWindow, task: Task) -> None:
        if self.shown is window:
            self.shown = None
        if not window.is_planned:
            task.cancel()


class PlanWindow(QWidget):
    """Window with the predicted values in rows and the map of σ over the picture; empty until `show_plan`."""

    closed = Signal()

    def __init__(self, bench: Bench, name: str, said: str, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(tr("Plan of {rig}", rig=name))
        resize_on_screen(self, *SIZE)
        self._bench = bench
        self._foretold: ForetoldRig | None = None
        self.table, self.map, self.where = DataTable(), HeatMap(), muted(said)
        self.table.set_headers([(tr("Foretold"), ""), (tr("Value"), "")])
        self.map.clear(tr("The plan is being worked out …"))
        self.save = QPushButton(icon("mdi6.content-save-outline"), tr("Save …"))
        enable(self.save, tr("The plan is being worked out."), "")
        self.save.clicked.connect(self._save)
        self.other = QPushButton(icon("mdi6.file-outline"), tr("Another rig …"))
        self.other.setToolTip(tr("Plan the rig of a rig.toml"))
        foot = in_row((self.where, 1), self.other, self.save)
        in_column((self.table, 1), (self.map, 1), foot, on=self, margins=(8, 8, 8, 8))

    @property
    def is_planned(self) -> bool:
        """Whether the window shows a prediction, so that it can be saved."""
        return self._foretold is not None

    def show_plan(self, foretold: ForetoldRig) -> None:
        """Show the rows and the map of σ of a prediction."""
        self._foretold = foretold
        self.table.set_rows(foretold.rows, [value for _, value in foretold.rows])
        self.map.set_map(foretold.sigma_mm, size=foretold.image_size, label=tr("σ of a depth"), unit="mm")
        enable(self.save, "", tr("Write plan.json and sigma.png into a folder"))

    def closeEvent(self, event: QCloseEvent) -> None:
        super().closeEvent(event)
        self.closed.emit()

    def _save(self) -> None:
        folder = ask.choose_folder(self, tr("Folder of the plan"), self._bench.settings.projects_folder)
        if folder is not None:
            self._bench.run_quick(
                self,
                jobs.WRITE_RIG_PLAN,
                self._foretold,
                folder,
                label=tr("Writing the plan"),
                on_done=lambda _: self._bench.notices.info(tr("The plan was written to {path}.", path=folder)),
                offers={},
            )
