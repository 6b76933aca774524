"""The laser planes a project has kept: listed, restored."""

from __future__ import annotations

from dataclasses import replace

from core.files.project_keys import finished
from workbench.pages.stored_calibrations import StoredCalibrations


class PlanesHistory(StoredCalibrations):
    """The laser planes'."""

    KIND = "fan"

    def _label(self) -> str:
        return self.tr("Reading the laser planes' history")

    def why_not_restore(self, id_: str) -> str:
        """Why these planes cannot be accepted again, or ""."""
        accepted = self._model.project.accepted
        entry = next((entry for entry in self.entries if entry.id == id_), None)
        if not self.entries:
            return self.tr("No laser planes have been accepted yet; accepted ones are listed here.")
        if entry is None:
            return self.tr("Choose a calibration in the list first.")
        if id_ == accepted.fan:
            return self.tr("These laser planes are in use.")
        if entry.camera_id != accepted.camera:
            return self.tr("They rest on another camera calibration; restore that one first.")
        return ""

    def restore(self, id_: str) -> None:
        """Accept planes of the history again; undoable."""
        if self.why_not_restore(id_):
            return
        project = self._model.project
        self._model.edit(self.tr("restore laser planes"), replace(project, accepted=replace(project.accepted, fan=id_)))
        self._model.record("planes", finished("planes", self._model.project, self._model.results))
