"""The camera calibrations a project has kept: listed, compared with the one shown, restored."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.calibrate.camera_changes import CameraChanges
from core.calibrate.results import CameraCalibration
from core.files.project_keys import finished
from workbench import jobs
from workbench.bench import Bench


class CameraHistory(QObject):
    """`entries` are StoredCalibration, the newest first; `changes` from the chosen one to the one shown."""

    changed = Signal()

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self.forget()

    def forget(self) -> None:
        """Nothing is known yet."""
        self.entries: tuple[Any, ...] = ()
        self.chosen = ""
        self.changes: CameraChanges | None = None
        self._shown: CameraCalibration | None = None

    def refresh(self) -> None:
        """Read the list again."""
        folder = self._model.folder
        if folder is None:
            return

        def read(entries: tuple[Any, ...]) -> None:
            if folder == self._model.folder:
                self.entries = tuple(entry for entry in entries if entry.kind == "camera")
                if self.chosen not in {entry.id for entry in self.entries}:
                    self.chosen, self.changes = "", None
                self.changed.emit()

        self._bench.glance(
            jobs.HISTORY, folder, label=self.tr("Reading the history"), on_done=read, offers={}, replace_waiting=True
        )

    def choose(self, id_: str) -> None:
        """Compare this one with the calibration shown."""
        if id_ != self.chosen:
            self.chosen = id_
            self._compare()

    def shown_is(self, calibration: CameraCalibration | None) -> None:
        """Another calibration is shown."""
        if calibration is not self._shown:
            self._shown = calibration
            if self.chosen:
                self._compare()

    def restore(self) -> None:
        """Accept the chosen one again; undoable."""
        project = self._model.project
        if not self.chosen or self.chosen == project.accepted.camera:
            return
        after = replace(project, accepted=replace(project.accepted, camera=self.chosen))
        self._model.edit(self.tr("restore a camera calibration"), after)
        self._model.record("camera", finished("camera", self._model.project, self._model.results))

    def _compare(self) -> None:
        self.changes = None
        folder, chosen = self._model.folder, self.chosen
        against = self._shown or self._model.project.accepted.camera
        if folder is not None and chosen and against:

            def compared(changes: CameraChanges) -> None:
                if chosen == self.chosen:
                    self.changes = changes
                    self.changed.emit()

            self._bench.glance(
                jobs.COMPARE_CAMERAS,
                folder,
                chosen,
                against,
                label=self.tr("Comparing calibrations"),
                on_done=compared,
                replace_waiting=True,
            )
        self.changed.emit()
