"""Going on with the next part of a series: the same calibrations, plan and report, another serial number."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from core.files.project.next_part import drawn_in_picture
from workbench.bench import Bench
from workbench.language import tr
from workbench.views import ask
from workbench.work import jobs


class NextPart(QObject):
    """Makes the next part's project, and opens it where its scan is taken.

    `save` saves the open project and says whether it could; `open_next` opens a folder and goes on.
    """

    def __init__(
        self,
        bench: Bench,
        window: QWidget,
        save: Callable[[], bool],
        open_next: Callable[..., None],
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._window = bench, bench.model, window
        self._save, self._open_next = save, open_next

    def begin(self, then: Callable[[], object]) -> None:
        """Ask for serial number and operator, make the project, open it, `then` go on."""
        folder, notices, person = self._model.folder, self._bench.notices, self._model.signed_in
        if folder is None:
            return
        if self._model.is_recording:
            notices.error(tr("Stop the recording first; then the next part can be begun."))
            return
        info = self._model.project.info
        answer = ask.ask_next_part(
            self._window,
            info.part or info.name,
            person.name if person is not None else info.operator,
            self._bench.settings.projects_folder,
        )
        if answer is None or (not self._model.is_read_only and not self._save()):
            return
        serial, operator, to = answer
        drawn = drawn_in_picture(self._model.project)

        def made(project: Path) -> None:
            if self._model.folder != folder:
                notices.info(tr("The next part is {folder}: File, Open project.", folder=project))
                return
            self._open_next(project, then=opened)

        def opened() -> None:
            self._model.stay_signed_in(person)
            if drawn:
                text = tr("Faces drawn in the picture are as for the last part: lay this one where that one lay.")
                notices.warning(text)
            then()

        self._bench.run_long(
            self,
            jobs.NEXT_PART,
            folder,
            to,
            serial,
            operator,
            person,
            label=tr("Making the next part's project"),
            on_done=made,
        )
