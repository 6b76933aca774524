"""Going on in a copy of the open project: where it lies it may be read-only."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from workbench.bench import Bench
from workbench.language import tr
from workbench.views import ask
from workbench.work import jobs


class ProjectCopy(QObject):
    """Copies the open project and goes on in the copy, with what is changed and not saved.

    `save` saves the project and says whether it could; `leave` closes it and goes on with what it is given, unless the
    user stays; `open_copy` opens a folder in a state, or as it was saved.
    """

    def __init__(
        self,
        bench: Bench,
        window: QWidget,
        save: Callable[[], bool],
        leave: Callable[[Callable[[], object]], None],
        open_copy: Callable[..., None],
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._window = bench, bench.model, window
        self._save, self._leave, self._open_copy = save, leave, open_copy

    def offer(self) -> None:
        """The project that was opened cannot be saved: offer a copy at once."""
        folder = self._model.folder
        why = tr("{folder} is read-only: what is changed or measured here cannot be saved.", folder=folder)
        answers = [tr("Save a copy …"), tr("Look at it as it is")]
        text = tr("{why} Go on in a copy?", why=why)
        if ask.ask(self._window, tr("Read-only project"), text, answers, harmless=True) == 0:
            self.save_copy()
        else:
            self._bench.notices.warning(tr("{why} File, Save a copy, goes on in a copy.", why=why))

    def save_copy(self) -> None:
        """Ask for a place, copy the project there, and open the copy."""
        folder, notices = self._model.folder, self._bench.notices
        if folder is None:
            return
        if self._model.is_recording:
            notices.error(tr("Stop the recording first; then the project can be copied."))
            return
        name = tr("{name} copy", name=self._model.project.info.name or folder.name)
        answer = ask.ask_name_and_folder(self._window, tr("Save a copy"), name, self._bench.settings.projects_folder)
        if answer is None or (not self._model.is_read_only and not self._save()):
            return
        to = answer[1] / ask.file_name(answer[0])
        self._bench.run_long(
            self,
            jobs.COPY_PROJECT,
            folder,
            to,
            label=tr("Copying the project"),
            on_done=lambda copy: self._go_on_in(copy, folder),
        )

    def _go_on_in(self, copy: Path, folder: Path) -> None:
        if folder != self._model.folder:
            self._bench.notices.info(tr("The copy is {folder}: File, Open project.", folder=copy))
            return
        state = self._model.file if self._model.is_modified else None
        text = tr("This is the copy in {folder}.", folder=copy)

        def go_on() -> None:
            self._open_copy(copy, state, then=lambda: self._bench.notices.info(text))

        if not self._model.is_read_only:
            self._leave(go_on)
        else:
            self._model.close()  # what was changed goes along
            go_on()
