"""What is known of the pictures of the plate under the fan, and the camera they are seen through."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration
from core.files.project.data import Project
from core.files.project.keys import FOUND_BY, inputs_of, is_needed
from core.messages import Message
from core.model import Camera
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.calibration.work import CalibrationWork
from workbench.work import jobs

Poses = tuple[PoseFeatures, ...]


class PlanesWork(CalibrationWork[Poses, FanCalibration]):
    """Worker that finds target and stripes, and solves the light planes.

    `poses` and `calibration` are of the project as it is, or None.
    """

    STEP = "planes"
    FIND, SOLVE, FOUND = jobs.FIND_POSES, jobs.SOLVE_POSES, jobs.FOUND_POSES

    @property
    def poses(self) -> Poses | None:
        """Poses found in the pictures of the plane target; None until the pictures have been searched."""
        return self.found

    def left_out(self) -> dict[str, Message]:
        return {pose.name: pose.reason for pose in self.poses or () if pose.reason}

    @staticmethod
    def name_of(path: Path) -> str:
        """Return the name in the project of a pose's picture; "" for its second picture with the laser off."""
        return "" if path.stem.endswith("_off") else path.stem

    def _labels(self) -> tuple[str, str]:
        return tr("Laser planes"), tr("Solving the laser planes")

    def _can_search(self, project: Project) -> bool:
        return bool(is_needed(self.STEP, project) and project.sources.planes and project.accepted.camera)

    def _recall(self, folder: Path, project: Project) -> None:
        if self._accepted_is_of_these_pictures(project):
            self._bench.run_quick(
                self,
                jobs.RECALL_POSES,
                folder,
                project,
                label=tr("Reading the laser planes"),
                on_done=lambda recalled: self._take_up(folder, project, *recalled),
            )
        else:
            self._ask_what_was_found(folder, project)

    def _accepted_is_of_these_pictures(self, project: Project) -> bool:
        done, keys = self._model.results.get("planes"), inputs_of("planes", project, {})
        known = {} if done is None else done.rests_on
        return bool(project.accepted.planes) and all(keys.get(name) == known.get(name) for name in FOUND_BY["planes"])


class PlanesCamera(QObject):
    """Accepted camera, for live pictures and the 3D view.

    `camera` is None where none is accepted, while it is read (`reading`), and where it cannot be.
    """

    changed = Signal()

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self.forget()

    def forget(self) -> None:
        """Drop the camera that was read."""
        self.camera: Camera | None = None
        self.reading = False
        self._id = ""

    def follow(self) -> None:
        """Read the accepted camera calibration, if it has changed."""
        folder, id_ = self._model.folder, self._model.project.accepted.camera
        if folder is None or not id_:
            self.forget()
            return
        if id_ == self._id:
            return
        self._id, self.camera, self.reading = id_, None, True

        def ended(calibration: Any = None) -> None:
            if id_ == self._id and folder == self._model.folder:
                self.reading = False
                self.camera = calibration.camera if calibration is not None else None
                self.changed.emit()

        self._bench.run_quick(
            self,
            jobs.READ_CAMERA,
            folder,
            id_,
            label=tr("Reading the camera"),
            on_done=ended,
            on_failed=lambda _: ended(),
            offers={},
        )
