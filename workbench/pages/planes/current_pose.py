"""The pose that is looked at: its picture, and what was found in it once it has been measured."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Signal

from core.calibrate.fan.poses.pose_features import PoseFeatures
from workbench.pages.calibration.current_picture import CurrentPicture
from workbench.pages.planes.work import PlanesWork
from workbench.work import jobs


class CurrentPose(CurrentPicture):
    """Current pose: what was found in a measured one, and the present numbers of its stripes."""

    _work: PlanesWork

    measured = Signal(object)
    """PoseStages of the current pose."""

    def names(self) -> Sequence[str]:
        return super().names() or [pose.name for pose in self._work.poses or ()]

    def features_of(self, name: str) -> PoseFeatures | None:
        """Return the target and stripes found in the pose called `name`; None if it has not been searched."""
        return next((pose for pose in self._work.poses or () if pose.name == name), None)

    def refresh(self) -> None:
        features, calibration = self.features_of(self.current), self._work.calibration
        if features is None:
            super().refresh()
            return
        if self._model.folder is None or self._read == (features, calibration):
            return
        self._read = (features, calibration)
        self._bench.run_quick(
            self,
            jobs.SHOW_POSE,
            self._model.folder,
            self._model.project,
            features,
            calibration.fan if calibration is not None else None,
            label=self._label,
            on_done=lambda stages: self.measured.emit(stages) if stages.name == self.current else None,
            replace_waiting=True,
        )
