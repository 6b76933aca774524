"""Tools, Plan a rig: what the open project's rig, or that of a rig.toml, will measure."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QPushButton, QWidget

from workbench.bench import Bench
from workbench.language import printed, tr
from workbench.theme import icon
from workbench.views import ask
from workbench.views.layouts import in_column, in_row, muted, resize_on_screen
from workbench.views.lists.data_table import DataTable
from workbench.views.plots.map import HeatMap
from workbench.work import jobs

if TYPE_CHECKING:
    from core.pipeline.project.rig_plan import ForetoldRig

SIZE = (1000, 640)
"""Width and height of the window at first, in pixels."""


class RigPlans(QObject):
    """Plans the open project's rig, or that of a file, in the background, and shows what comes of it."""

    def __init__(self, bench: Bench, window: QWidget) -> None:
        super().__init__(window)
        self._bench, self._window = bench, window
        self.shown: PlanWindow | None = None
        """The plan that was made last."""

    def open(self) -> None:
        """Plan the rig of the open project; without one, of a file that is asked for."""
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
        """Ask for the file, and plan."""
        kinds = tr("Rig (*.toml)")
        path = ask.choose_file_to_open(self._window, tr("Plan a rig"), self._bench.settings.projects_folder, kinds)
        if path is not None:
            self.plan(path)

    def plan(self, rig: Path) -> None:
        """Plan the rig in a file."""
        self._run(jobs.FORETELL_RIG, (rig,), rig.name, str(rig))

    def _run(self, job: jobs.Job, what: tuple[object, ...], name: str, said: str) -> None:
        self._bench.run_long(
            self,
            job,
            *what,
            printed(),
            label=tr("Planning the rig"),
            on_done=lambda foretold: self._show(name, said, foretold),
        )

    def _show(self, name: str, said: str, foretold: ForetoldRig) -> None:
        if self.shown is not None:
            self.shown.close()
        self.shown = PlanWindow(self._bench, name, said, foretold, self._window)
        self.shown.closed.connect(self._closed)
        self.shown.other.clicked.connect(self.choose)
        self.shown.show()

    def _closed(self) -> None:
        self.shown = None


class PlanWindow(QWidget):
    """What a rig will measure: rows, and where in the picture how well."""

    closed = Signal()

    def __init__(self, bench: Bench, name: str, said: str, foretold: ForetoldRig, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(tr("Plan of {rig}", rig=name))
        resize_on_screen(self, *SIZE)
        self._bench, self._foretold = bench, foretold
        self.table, self.map, self.where = DataTable(), HeatMap(), muted(said)
        self.table.set_headers([(tr("Foretold"), ""), (tr("Value"), "")])
        self.table.set_rows(foretold.rows, [value for _, value in foretold.rows])
        self.map.set_map(foretold.sigma_mm, size=foretold.image_size, label=tr("σ of a depth"), unit="mm")
        self.save = QPushButton(icon("mdi6.content-save-outline"), tr("Save …"))
        self.save.setToolTip(tr("Write plan.json and sigma.png into a folder"))
        self.save.clicked.connect(self._save)
        self.other = QPushButton(icon("mdi6.file-outline"), tr("Another rig …"))
        self.other.setToolTip(tr("Plan the rig of a rig.toml"))
        foot = in_row((self.where, 1), self.other, self.save)
        in_column((self.table, 1), (self.map, 1), foot, on=self, margins=(8, 8, 8, 8))

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
