"""The accepted camera, through which the laser planes are seen: live pictures and the 3D view want it."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, Signal

from core.model import Camera
from workbench import jobs
from workbench.bench import Bench


class PlanesCamera(QObject):
    """`camera` is None where none is accepted, while it is read (`reading`), and where it cannot be."""

    changed = Signal()

    def __init__(self, bench: Bench, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._model = bench, bench.model
        self.forget()

    def forget(self) -> None:
        """Nothing is known yet."""
        self.camera: Camera | None = None
        self.reading = False
        self._id = ""

    def follow(self) -> None:
        """Read the accepted camera if it is another than before."""
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

        self._bench.glance(
            jobs.READ_CAMERA, folder, id_, label=self.tr("Reading the camera"), on_done=ended,
            on_failed=lambda _: ended(), offers={},
        )  # fmt: skip
