"""The way from a project to a copy of it: where it lies it may be read-only."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from core.files.project import ProjectFile, can_be_saved
from workbench import jobs
from workbench.bench import Bench
from workbench.views import ask


class CopyDoor(QObject):
    """Copies the open project and goes on in the copy, with what is changed and not saved.

    `save` saves the project, `leave` closes it, and both say whether they could; `open_copy` opens a folder in a state,
    or as it was saved.
    """

    def __init__(
        self,
        bench: Bench,
        window: QWidget,
        save: Callable[[], bool],
        leave: Callable[[], bool],
        open_copy: Callable[[Path, ProjectFile | None], bool],
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._window = bench, bench.model, window
        self._save, self._leave, self._open_copy = save, leave, open_copy

    def offer(self) -> None:
        """The project that was opened cannot be saved: offer a copy at once."""
        folder = self._model.folder
        why = self.tr("{0} is read-only: what is changed or measured here cannot be saved.").format(folder)
        answers = [self.tr("Save a copy …"), self.tr("Look at it as it is")]
        text = self.tr("{0} Go on in a copy?").format(why)
        if ask.ask(self._window, self.tr("Read-only project"), text, answers) == 0:
            self.save_copy()
        else:
            self._bench.notices.warning(self.tr("{0} File, Save a copy, goes on in a copy.").format(why))

    def save_copy(self) -> None:
        """Ask for a place, copy the project there, and open the copy."""
        folder, notices = self._model.folder, self._bench.notices
        if folder is None:
            return
        if self._bench.live.busy:
            notices.error(self.tr("Stop the recording first; then the project can be copied."))
            return
        name = self.tr("{0} copy").format(self._model.project.info.name or folder.name)
        answer = ask.ask_name_and_folder(
            self._window, self.tr("Save a copy"), name, self._bench.settings.projects_folder
        )
        if answer is None or (can_be_saved(folder) and not self._save()):
            return
        to = answer[1] / ask.file_name(answer[0])
        self._bench.measure(
            jobs.COPY_PROJECT,
            folder,
            to,
            label=self.tr("Copying the project"),
            on_done=lambda copy: self._go_on_in(copy, folder),
        )

    def _go_on_in(self, copy: Path, folder: Path) -> None:
        if folder != self._model.folder:
            self._bench.notices.info(self.tr("The copy is {0}: File, Open project.").format(copy))
            return
        state = self._model.file if self._model.is_modified else None
        if not can_be_saved(folder):
            self._model.close()  # what was changed goes along
        elif not self._leave():
            return
        if self._open_copy(copy, state):
            self._bench.notices.info(self.tr("This is the copy in {0}.").format(copy))
