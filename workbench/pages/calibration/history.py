"""The camera calibrations a project has kept: listed, compared with the one shown, restored."""

from __future__ import annotations

from dataclasses import replace

from core.calibrate.camera_changes import CameraChanges
from core.calibrate.results import CameraCalibration
from core.files.project_keys import finished
from workbench import jobs
from workbench.pages.stored_calibrations import StoredCalibrations


class CameraHistory(StoredCalibrations):
    """The camera's; `changes` are those from the chosen one to the one shown."""

    KIND = "camera"

    def forget(self) -> None:
        super().forget()
        self.chosen = ""
        self.changes: CameraChanges | None = None
        self._shown: CameraCalibration | None = None

    def _label(self) -> str:
        return self.tr("Reading the history")

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
