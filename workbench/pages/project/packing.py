"""The open project packed into one file, and a packed one unpacked and opened."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from workbench.bench import Bench
from workbench.language import tr
from workbench.views import ask
from workbench.work import jobs

PACKED = ".trisectz"


class ProjectPack(QObject):
    """Packs and unpacks; `save` saves the project and says whether it could, `open_project` opens what came out."""

    def __init__(
        self,
        bench: Bench,
        window: QWidget,
        save: Callable[[], bool],
        open_project: Callable[[Path], object],
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._bench, self._window, self._save, self._open_project = bench, window, save, open_project

    def pack(self) -> None:
        """Ask for a file, and put the open project into it as it is now."""
        model, notices = self._bench.model, self._bench.notices
        folder = model.folder
        if folder is None:
            return
        if model.is_recording:
            notices.error(tr("Stop the recording first; then the project can be packed."))
            return
        start = folder.parent / f"{folder.name}{PACKED}"
        file = ask.choose_file_to_save(
            self._window, tr("Pack into one file"), start, tr("Packed project") + f" (*{PACKED})"
        )
        if file is None or (not model.is_read_only and not self._save()):
            return
        if file.suffix.lower() != PACKED:
            file = file.with_name(file.name + PACKED)
        self._bench.run_long(
            self,
            jobs.PACK_PROJECT,
            folder,
            file,
            label=tr("Packing the project"),
            on_done=lambda packed: notices.info(
                tr("{count} files of the project are in {file}.", count=packed.files, file=packed.path)
            ),
        )

    def choose(self) -> None:
        """Ask for a packed project, and unpack it."""
        file = ask.choose_file_to_open(
            self._window, tr("Unpack a project"), None, tr("Packed project") + f" (*{PACKED})"
        )
        if file is not None:
            self.unpack(file)

    def unpack(self, file: Path) -> None:
        """Ask where to, unpack a project there, and open it, unless another one is open by then."""
        bench, asked_at = self._bench, self._bench.model.folder
        answer = ask.ask_name_and_folder(
            self._window, tr("Unpack a project"), file.stem, bench.settings.projects_folder
        )
        if answer is None:
            return

        def unpacked(folder: Path) -> None:
            if bench.model.folder == asked_at:
                self._open_project(folder)
            else:
                bench.notices.info(tr("The project is in {folder}: File, Open project.", folder=folder))

        to = answer[1] / ask.file_name(answer[0])
        bench.run_long(self, jobs.UNPACK_PROJECT, file, to, label=tr("Unpacking the project"), on_done=unpacked)
