"""The calibrations a project has kept: listed, compared with the one shown, restored."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from typing import Any, ClassVar

from PySide6.QtCore import QObject, Signal

from core.calibrate.camera.changes import CameraChanges
from core.calibrate.results import CameraCalibration
from core.files.project.keys import finished
from workbench.bench import Bench
from workbench.language import tr
from workbench.work import jobs


class StoredCalibrations(QObject):
    """`entries` are StoredCalibration of `KIND`, the newest first."""

    changed = Signal()

    KIND: ClassVar[str]

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self.forget()

    def forget(self) -> None:
        """Nothing is known yet."""
        self.entries: tuple[Any, ...] = ()

    def refresh(self) -> None:
        """Read the list again."""
        folder = self._model.folder
        if folder is None:
            return

        def read(entries: tuple[Any, ...]) -> None:
            if folder == self._model.folder:
                self.entries = tuple(entry for entry in entries if entry.kind == self.KIND)
                self._listed()
                self.changed.emit()

        # the label tells the camera's from the laser planes': only the newest of each is wanted
        self._bench.run_quick(
            self, jobs.HISTORY, folder, label=self._label(), on_done=read, offers={}, replace_waiting=True
        )

    @abstractmethod
    def _label(self) -> str:
        """What reading the list is called."""

    def _listed(self) -> None:
        """Another list is there."""


class CameraHistory(StoredCalibrations):
    """The camera's; `changes` are those from the chosen one to the one shown."""

    KIND = "camera"

    def forget(self) -> None:
        super().forget()
        self.chosen = ""
        self.changes: CameraChanges | None = None
        self._shown: CameraCalibration | None = None

    def _label(self) -> str:
        return tr("Reading the history")

    def _listed(self) -> None:
        if self.chosen not in {entry.id for entry in self.entries}:
            self.chosen, self.changes = "", None

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
        self._model.edit(tr("restore a camera calibration"), after)
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

            self._bench.run_quick(
                self,
                jobs.COMPARE_CAMERAS,
                folder,
                chosen,
                against,
                label=tr("Comparing calibrations"),
                on_done=compared,
                replace_waiting=True,
            )
        self.changed.emit()


class PlanesHistory(StoredCalibrations):
    """The laser planes'."""

    KIND = "fan"

    def _label(self) -> str:
        return tr("Reading the laser planes' history")

    def why_not_restore(self, id_: str) -> str:
        """Why these planes cannot be accepted again, or ""."""
        accepted = self._model.project.accepted
        entry = next((entry for entry in self.entries if entry.id == id_), None)
        if not self.entries:
            return tr("No laser planes have been accepted yet; accepted ones are listed here.")
        if entry is None:
            return tr("Choose a calibration in the list first.")
        if id_ == accepted.fan:
            return tr("These laser planes are in use.")
        if entry.camera_id != accepted.camera:
            return tr("They rest on another camera calibration; restore that one first.")
        return ""

    def restore(self, id_: str) -> None:
        """Accept planes of the history again; undoable."""
        if self.why_not_restore(id_):
            return
        project = self._model.project
        self._model.edit(tr("restore laser planes"), replace(project, accepted=replace(project.accepted, fan=id_)))
        self._model.record("planes", finished("planes", self._model.project, self._model.results))
