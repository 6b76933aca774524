"""The calibrations a project has kept: listed, compared with the one shown, restored."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal

from PySide6.QtCore import QObject, Signal

from core.calibrate.camera.changes import CameraChanges
from core.calibrate.results import CameraCalibration
from core.files.project.keys import finished
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.calibration.acceptance import Acceptance
from workbench.pages.calibration.stage import RestoreFacts, WhyNotRestore, why_not_restore
from workbench.pages.live.presenter import LivePresenter
from workbench.work import jobs


class StoredCalibrations(QObject):
    """Stored calibrations of one step, `entries`, the newest first; `chosen` is the id of one of them, or ""."""

    changed = Signal()

    STEP: ClassVar[Literal["camera", "planes"]]

    def __init__(
        self, bench: Bench, acceptance: Acceptance, live: LivePresenter, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._acceptance, self._live = bench, bench.model, acceptance, live
        bench.measuring.task_started.connect(self.changed)
        bench.measuring.task_ended.connect(self.changed)
        self.forget()

    def forget(self) -> None:
        """Clear the list of stored calibrations."""
        self.entries: tuple[Any, ...] = ()
        self.chosen = ""

    def refresh(self) -> None:
        """Read the list of stored calibrations from the project again, in the background."""
        folder = self._model.folder
        if folder is None:
            return

        def read(entries: tuple[Any, ...]) -> None:
            if folder == self._model.folder:
                self.entries = tuple(entry for entry in entries if entry.kind == self.STEP)
                if self.chosen not in {entry.id for entry in self.entries}:
                    self.chosen = ""
                    self._choice_changed()
                self.changed.emit()

        # the label tells the camera's from the laser planes': only the newest of each is wanted
        self._bench.run_quick(
            self, jobs.HISTORY, folder, label=self._labels()[0], on_done=read, offers={}, replace_waiting=True
        )

    def choose(self, id_: str) -> None:
        """Choose the stored calibration with this id."""
        if id_ != self.chosen:
            self.chosen = id_
            self._choice_changed()
            self.changed.emit()

    @property
    def accepted(self) -> str:
        """Id of the calibration that is accepted; "" for none."""
        return self._acceptance.accepted

    def why_not_restore(self) -> str:
        """Return the reason why the chosen calibration cannot be accepted again; "" if it can."""
        entry = next((entry for entry in self.entries if entry.id == self.chosen), None)
        job = self._bench.measuring.current
        running = self._acceptance.label if self._acceptance.keeping else job.label if job is not None else ""
        facts = RestoreFacts(
            kept=bool(self.entries),
            chosen=entry is not None,
            in_use=self.chosen == self.accepted,
            other_camera=self.STEP == "planes"
            and entry is not None
            and entry.camera_id != self._model.project.accepted.camera,
            live=self._live.running,
            keeping=self._acceptance.keeping,
            job=job is not None,
        )
        return {
            WhyNotRestore.NOTHING: "",
            WhyNotRestore.LIVE: tr("Stop the live source first."),
            WhyNotRestore.KEEPING: tr("A job is not finished yet: {job}.", job=running),
            WhyNotRestore.JOB: tr("A job is not finished yet: {job}.", job=running),
            **self._sentences(),
        }[why_not_restore(facts)]

    @abstractmethod
    def _sentences(self) -> dict[WhyNotRestore, str]:
        """What is missing, where that is this step's own."""

    def restore(self) -> None:
        """Accept the chosen stored calibration again; undoable."""
        if not self.why_not_restore():
            self._accept(self.chosen, self._labels()[1])

    def _accept(self, id_: str, label: str) -> None:
        """Measure with this one from now on; `label` is what undo calls that."""
        project, changed = self._model.project, {self.STEP: id_}
        self._model.edit(label, replace(project, accepted=replace(project.accepted, **changed)))
        self._model.record(self.STEP, finished(self.STEP, self._model.project, self._model.results))

    @abstractmethod
    def _labels(self) -> tuple[str, str]:
        """What reading the list, and restoring one, are called."""

    def _choice_changed(self) -> None:
        """Another one is chosen, or none."""


class CameraHistory(StoredCalibrations):
    """Stored calibrations of the camera; `changes` are those from the chosen one to the one shown."""

    STEP = "camera"

    def forget(self) -> None:
        super().forget()
        self.changes: CameraChanges | None = None
        self._shown: CameraCalibration | None = None

    def _labels(self) -> tuple[str, str]:
        return tr("Reading the history"), tr("restore a camera calibration")

    def shown_is(self, calibration: CameraCalibration | None) -> None:
        """Set the camera calibration that the chosen one is compared with; None for none."""
        if calibration is not self._shown:
            self._shown = calibration
            if self.chosen:
                self._choice_changed()
                self.changed.emit()

    def why_not_import(self) -> str:
        """Return the reason why no camera of another program can be imported now; "" if it can."""
        job = self._bench.measuring.current
        running = self._acceptance.label if self._acceptance.keeping else job.label if job is not None else ""
        if self._live.running:
            return tr("Stop the live source first.")
        return tr("A job is not finished yet: {job}.", job=running) if running else self._bench.cannot_write

    def take(self, path: Path) -> None:
        """Import and accept the camera that OpenCV or ROS has written to a file; undoable."""
        folder = self._model.folder
        if folder is None or self.why_not_import():
            return

        def kept(id_: str) -> None:
            if folder == self._model.folder:
                self._accept(id_, tr("take a camera calibration from a file"))
                self.refresh()

        self._bench.run_quick(
            self,
            jobs.KEEP_IMPORTED_CAMERA,
            folder,
            self._model.project,
            path,
            label=tr("Reading the calibration"),
            on_done=kept,
            offers={},
        )

    def _sentences(self) -> dict[WhyNotRestore, str]:
        return {
            WhyNotRestore.NONE_KEPT: tr("No calibration has been accepted yet; accepted ones are listed here."),
            WhyNotRestore.NONE_CHOSEN: tr("Choose a calibration above to compare it with the one shown."),
            WhyNotRestore.IN_USE: tr("This calibration is in use."),
        }

    def _choice_changed(self) -> None:
        self.changes = None
        folder, chosen = self._model.folder, self.chosen
        against = self._shown or self.accepted
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


class PlanesHistory(StoredCalibrations):
    """Stored calibrations of the laser planes."""

    STEP = "planes"

    def _labels(self) -> tuple[str, str]:
        return tr("Reading the laser planes' history"), tr("restore laser planes")

    def _sentences(self) -> dict[WhyNotRestore, str]:
        return {
            WhyNotRestore.NONE_KEPT: tr("No laser planes have been accepted yet; accepted ones are listed here."),
            WhyNotRestore.NONE_CHOSEN: tr("Choose a calibration in the list first."),
            WhyNotRestore.IN_USE: tr("These laser planes are in use."),
            WhyNotRestore.OTHER_CAMERA: tr("They rest on another camera calibration; restore that one first."),
        }
