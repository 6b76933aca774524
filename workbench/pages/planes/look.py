"""The pose that is looked at: its picture, and what was found in it once it has been measured."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, Signal

from core.calibrate.fan.pose_features import PoseFeatures
from workbench.bench import Bench
from workbench.pages.planes.work import PlanesWork
from workbench.work import jobs

NOTHING: tuple[str, Any, Any] = ("", None, None)


class PlanesLook(QObject):
    """Reads each picture once: again only where another pose is looked at, or something else was found in it."""

    measured = Signal(object)
    """PoseStages of the current pose."""

    picture = Signal(str, object)
    """Name of the current pose and its picture, before it is measured."""

    def __init__(self, bench: Bench, work: PlanesWork, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model, self._work = bench, bench.model, work
        self.current = ""
        self._read = NOTHING

    def forget(self) -> None:
        """Look at nothing."""
        self.current, self._read = "", NOTHING

    def again(self) -> None:
        """What was looked at is wanted again."""
        self._read = NOTHING
        self.refresh()

    def features_of(self, name: str) -> PoseFeatures | None:
        """What the pictures of a pose show; None if nobody has looked."""
        return next((pose for pose in self._work.poses or () if pose.name == name), None)

    def follow(self) -> None:
        """Poses or their calibration are others; look at the first pose where the current one is gone."""
        work = self._work
        names = [path.stem for path in work.pictures or ()] or [pose.name for pose in work.poses or ()]
        if self.current not in names:
            self.current = names[0] if names else ""
        self.refresh()

    def refresh(self) -> None:
        """Have the current pose's picture read, with what was found in it and the numbers its stripes have now."""
        name, folder, features = self.current, self._model.folder, self.features_of(self.current)
        calibration = self._work.calibration
        if not name or folder is None or self._read == (name, features, calibration):
            return
        path = next((path for path in self._work.pictures or () if path.stem == name), None)
        if features is not None:
            self._read = (name, features, calibration)
            self._bench.run_quick(
                self,
                jobs.SHOW_POSE,
                folder,
                self._model.project,
                features,
                calibration.fan if calibration is not None else None,
                label=self.tr("Reading a pose"),
                on_done=lambda stages: self.measured.emit(stages) if stages.name == self.current else None,
                replace_waiting=True,
            )
        elif path is not None:
            self._read = (name, None, None)
            self._bench.run_quick(
                self,
                jobs.READ_PICTURE,
                path,
                self._model.project.rig.channel,
                label=self.tr("Reading a pose"),
                on_done=lambda found: self.picture.emit(name, found) if name == self.current else None,
                offers={},
                replace_waiting=True,
            )
