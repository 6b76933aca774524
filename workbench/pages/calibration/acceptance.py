"""Accepting and rejecting a calibration: both are decisions of the project, undone and kept like any other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

from PySide6.QtCore import QObject, Signal

from core.files.project.data import Project
from core.files.project.keys import finished, with_outdated
from workbench.bench import Bench
from workbench.language import tr
from workbench.work.jobs import Job


class Acceptance(QObject):
    """State of acceptance of one step's calibrations; `keep` is the job that stores one."""

    changed = Signal()
    kept = Signal()
    """One was accepted: the history has it."""

    def __init__(
        self, bench: Bench, step: Literal["camera", "planes"], keep: Job, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._step, self._keep = bench, bench.model, step, keep
        self.keeping = False

    @property
    def accepted(self) -> str:
        """Id of the calibration of this step that the project has accepted; "" for none."""
        return str(getattr(self._model.project.accepted, self._step))

    @property
    def label(self) -> str:
        """Name of the job that stores a calibration, in the window's language."""
        return self._words()[2]

    def is_rejected(self, id_: str) -> bool:
        """Whether the calibration with this id is rejected in the project."""
        return id_ in self._model.project.rejected

    def forget(self) -> None:
        """Reset, as another project is open: no calibration is being stored."""
        self.keeping = False

    def accept(self, *made: Any) -> None:
        """Store a calibration in the project and accept it; `made` are the arguments of the job that stores it."""
        folder, project = self._model.folder, self._model.project
        if folder is None or self.keeping:
            return
        self.keeping = True
        self.changed.emit()

        def kept(id_: str) -> None:
            self.keeping = False
            if folder != self._model.folder:
                return
            now = self._model.project
            after = replace(self._with(now, id_), rejected=now.rejected - {id_})
            self._model.edit(self._words()[0], after)
            results = self._model.results
            if id_ == getattr(project.accepted, self._step):
                results = with_outdated(self._step, results)  # the same numbers, and more is known of them
            made_from = replace(project, accepted=after.accepted)
            self._model.record_all({**results, self._step: finished(self._step, made_from, results)})
            self.kept.emit()

        def failed(_: Any) -> None:
            self.keeping = False
            self.changed.emit()

        self._bench.run_quick(
            self, self._keep, folder, project, *made, label=self.label, on_done=kept, on_failed=failed
        )

    def reject(self, id_: str) -> None:
        """Mark the calibration with this id as rejected in the project."""
        now = self._model.project
        after = self._with(now, "") if id_ == self.accepted else now
        self._model.edit(self._words()[1], replace(after, rejected=now.rejected | {id_}))

    def _with(self, project: Project, id_: str) -> Project:
        return replace(project, accepted=replace(project.accepted, **{self._step: id_}))

    def _words(self) -> tuple[str, str, str]:
        """Names of the edits that accept and reject, and of the job."""
        if self._step == "camera":
            return (
                tr("accept the camera calibration"),
                tr("reject the camera calibration"),
                tr("Keeping the calibration"),
            )
        return (
            tr("accept the laser planes"),
            tr("reject the laser planes"),
            tr("Keeping the laser planes"),
        )
