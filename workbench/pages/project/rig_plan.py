"""Tools, Plan a rig: what a rig.toml will measure, before anything is bolted down."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QPushButton, QWidget

from core.translations import languages
from workbench.bench import Bench
from workbench.language import spoken, tr
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
    """Asks for a rig.toml, plans it in the background, and shows what comes of it."""

    def __init__(self, bench: Bench, window: QWidget) -> None:
        super().__init__(window)
        self._bench, self._window = bench, window
        self.shown: PlanWindow | None = None
        """The plan that was made last."""

    def choose(self) -> None:
        """Ask for the file, and plan."""
        kinds = tr("Rig (*.toml)")
        path = ask.choose_file_to_open(self._window, tr("Plan a rig"), self._bench.settings.projects_folder, kinds)
        if path is not None:
            self.plan(path)

    def plan(self, rig: Path) -> None:
        """Plan the rig in a file."""
        self._bench.run_long(
            self,
            jobs.FORETELL_RIG,
            rig,
            spoken() if spoken() in languages() else "en",
            label=tr("Planning the rig"),
            on_done=lambda foretold: self._show(rig, foretold),
        )

    def _show(self, rig: Path, foretold: ForetoldRig) -> None:
        if self.shown is not None:
            self.shown.close()
        self.shown = PlanWindow(self._bench, rig, foretold, self._window)
        self.shown.closed.connect(self._closed)
        self.shown.show()

    def _closed(self) -> None:
        self.shown = None


class PlanWindow(QWidget):
    """What a rig will measure: rows, and where in the picture how well."""

    closed = Signal()

    def __init__(self, bench: Bench, rig: Path, foretold: ForetoldRig, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(tr("Plan of {rig}", rig=rig.name))
        resize_on_screen(self, *SIZE)
        self._bench, self._foretold = bench, foretold
        self.table, self.map, self.where = DataTable(), HeatMap(), muted(str(rig))
        self.table.set_headers([(tr("Foretold"), ""), (tr("Value"), "")])
        self.table.set_rows(foretold.rows, [value for _, value in foretold.rows])
        self.map.set_map(foretold.sigma_mm, size=foretold.image_size, label=tr("σ of a depth"), unit="mm")
        self.save = QPushButton(icon("mdi6.content-save-outline"), tr("Save …"))
        self.save.setToolTip(tr("Write plan.json and sigma.png into a folder"))
        self.save.clicked.connect(self._save)
        in_column((self.table, 1), (self.map, 1), in_row((self.where, 1), self.save), on=self, margins=(8, 8, 8, 8))

    def closeEvent(self, event: QCloseEvent) -> None:
        super().closeEvent(event)
        self.closed.emit()

    def _save(self) -> None:
        folder = ask.choose_folder(self, tr("Folder of the plan"), self._bench.settings.projects_folder)
        if folder is not None:
            self._bench.run_quick(
                self,
                jobs.WRITE_RIG_PLAN,
                self._foretold.result,
                folder,
                label=tr("Writing the plan"),
                on_done=lambda _: self._bench.notices.info(tr("The plan was written to {path}.", path=folder)),
                offers={},
            )
