"""The finished sample project: opened, and made when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from core.files.project.folder import free_folder, is_project
from workbench.bench import Bench
from workbench.language import printed, tr
from workbench.work import jobs
from workbench.work.tasks import Task


class SampleProject(QObject):
    """Opener of the sample by `open_project`; it is made first, once, if it is missing."""

    changed = Signal()
    """The sample is being prepared, or no longer."""

    def __init__(self, bench: Bench, open_project: Callable[[Path], object], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._bench, self._open_project = bench, open_project
        self._task: Task | None = None

    @property
    def preparing(self) -> bool:
        """Whether the sample project is being made in the background."""
        return self._task is not None

    def open(self) -> None:
        """Open the sample project; if it is missing, make it first, and open it unless another project is open then."""
        if self._task is not None:
            self._bench.notices.info(tr("The sample is being prepared; the status bar says how far it is."))
            return
        folder, asked_at = self._folder(), self._bench.model.folder
        if is_project(folder):
            self._open_project(folder)
            return

        def made(project: Path) -> None:
            self._ended()
            if self._bench.model.folder == asked_at:
                self._open_project(project)
            else:
                self._bench.notices.info(tr("The sample is ready: File, Open sample."))

        def cancelled() -> None:
            self._ended()
            self._bench.run_quick(
                self, jobs.CLEAR_SAMPLE, folder, label=tr("Clearing up"), on_done=lambda _: None, offers={}
            )

        self._task = self._bench.run_long(
            self,
            jobs.SAMPLE_PROJECT,
            folder,
            printed(),
            label=tr("Preparing the sample"),
            on_done=made,
            on_failed=lambda _: self._ended(),
            on_cancelled=cancelled,
        )
        self.changed.emit()

    def _folder(self) -> Path:
        """Where the sample is, or the first free place for it."""
        base = self._bench.settings.projects_folder
        return free_folder(base, tr("Sample"), lambda path: is_project(path) or not path.exists())

    def _ended(self, *_: Any) -> None:
        self._task = None
        self.changed.emit()
