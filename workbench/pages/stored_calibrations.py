"""The calibrations of one kind that a project has kept: listed."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

from PySide6.QtCore import QObject, Signal

from workbench import jobs
from workbench.bench import Bench


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
        self._bench.glance(jobs.HISTORY, folder, label=self._label(), on_done=read, offers={}, replace_waiting=True)

    @abstractmethod
    def _label(self) -> str:
        """What reading the list is called."""

    def _listed(self) -> None:
        """Another list is there."""
