"""What becomes of an open project: a copy, the next part, a script of what was done, or one packed file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from core.files.project.next_part import drawn_in_picture
from core.translations import languages
from workbench.bench import Bench
from workbench.language import language_name, tr
from workbench.views import ask
from workbench.work import jobs

PACKED = ".trisectz"
SCRIPT = "session.py"


class ProjectCopies(QObject):
    """Maker of copies of projects in the background; it then opens the copy, unless another project is open.

    `save` saves the project and says whether it could; `leave` closes it and goes on with what it is given, unless the
    user stays; `open_folder` opens a folder in a state, or as it was saved, and goes on.
    """

    def __init__(
        self,
        bench: Bench,
        window: QWidget,
        save: Callable[[], bool],
        leave: Callable[[Callable[[], object]], None],
        open_project: Callable[[Path], object],
        open_folder: Callable[..., None],
    ) -> None:
        super().__init__(window)
        self._bench, self._model, self._window = bench, bench.model, window
        self._save, self._leave, self._open_project, self._open = save, leave, open_project, open_folder

    def _folder(self, recording: str) -> Path | None:
        """The open project's folder; None if there is none, or while one is recorded, and then that is said."""
        if self._model.folder is not None and self._model.is_recording:
            self._bench.notices.error(recording)
            return None
        return self._model.folder

    def _saved(self) -> bool:
        return self._model.is_read_only or self._save()

    # ---- a copy

    def offer_copy(self) -> None:
        """Ask whether to continue in a copy, as the project that was opened cannot be saved."""
        folder = self._model.folder
        why = tr("{folder} is read-only: what is changed or measured here cannot be saved.", folder=folder)
        answers = [tr("Save a copy …"), tr("Look at it as it is")]
        text = tr("{why} Go on in a copy?", why=why)
        if ask.ask(self._window, tr("Read-only project"), text, answers, harmless=True) == 0:
            self.save_copy()
        else:
            self._bench.notices.warning(tr("{why} File, Save a copy, goes on in a copy.", why=why))

    def save_copy(self) -> None:
        """Ask for a folder, copy the project with its unsaved changes there, and open the copy."""
        folder = self._folder(tr("Stop the recording first; then the project can be copied."))
        if folder is None:
            return
        name = tr("{name} copy", name=self._model.project.info.name or folder.name)
        answer = ask.ask_name_and_folder(self._window, tr("Save a copy"), name, self._bench.settings.projects_folder)
        if answer is None or not self._saved():
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
            self._open(copy, state, then=lambda: self._bench.notices.info(text))

        if not self._model.is_read_only:
            self._leave(go_on)
        else:
            self._model.close()  # what was changed goes along
            go_on()

    # ---- a script

    def save_script(self) -> None:
        """Ask for a file, and write what was done in the project as a Python script of commands."""
        folder = self._folder(tr("Stop the recording first; then the script can be written."))
        if folder is None:
            return
        kinds = tr("Python scripts (*.py)")
        path = ask.choose_file_to_save(self._window, tr("Save as a script"), Path.home() / SCRIPT, kinds)
        if path is None or not self._saved():
            return
        self._bench.run_quick(
            self,
            jobs.WRITE_SCRIPT,
            folder,
            path,
            language_name() if language_name() in languages() else "en",
            label=tr("Writing the script"),
            on_done=lambda done: self._bench.notices.info(tr("The script was written to {path}.", path=done)),
            offers={},
        )

    # ---- the next part

    def next_part(self, then: Callable[[], object]) -> None:
        """Ask for serial number and operator, make and open the project of the next part, and call `then`."""
        folder = self._folder(tr("Stop the recording first; then the next part can be begun."))
        if folder is None:
            return
        info, person, notices = self._model.project.info, self._model.guard.signed_in, self._bench.notices
        answer = ask.ask_next_part(
            self._window,
            info.part or info.name,
            person.name if person is not None else info.operator,
            self._bench.settings.projects_folder,
        )
        if answer is None or not self._saved():
            return
        serial, operator, to = answer
        drawn = drawn_in_picture(self._model.project)

        def made(project: Path) -> None:
            if self._model.folder != folder:
                notices.info(tr("The next part is {folder}: File, Open project.", folder=project))
                return
            self._open(project, then=opened)

        def opened() -> None:
            self._model.guard.stay_signed_in(person)
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

    # ---- one file

    def pack(self) -> None:
        """Ask for a file, and pack the open project into it, NAME.trisectz."""
        folder = self._folder(tr("Stop the recording first; then the project can be packed."))
        if folder is None:
            return
        start = folder.parent / f"{folder.name}{PACKED}"
        file = ask.choose_file_to_save(
            self._window, tr("Pack into one file"), start, tr("Packed project") + f" (*{PACKED})"
        )
        if file is None or not self._saved():
            return
        if file.suffix.lower() != PACKED:
            file = file.with_name(file.name + PACKED)
        self._bench.run_long(
            self,
            jobs.PACK_PROJECT,
            folder,
            file,
            label=tr("Packing the project"),
            on_done=lambda packed: self._bench.notices.info(
                tr("{count} files of the project are in {file}.", count=packed.files, file=packed.path)
            ),
        )

    def choose_packed(self) -> None:
        """Ask for a packed project, NAME.trisectz, and unpack it."""
        file = ask.choose_file_to_open(
            self._window, tr("Unpack a project"), None, tr("Packed project") + f" (*{PACKED})"
        )
        if file is not None:
            self.unpack(file)

    def unpack(self, file: Path) -> None:
        """Ask for a folder, unpack the project in `file` there, and open it."""
        bench, asked_at = self._bench, self._model.folder
        answer = ask.ask_name_and_folder(
            self._window, tr("Unpack a project"), file.stem, bench.settings.projects_folder
        )
        if answer is None:
            return

        def unpacked(folder: Path) -> None:
            if self._model.folder == asked_at:
                self._open_project(folder)
            else:
                bench.notices.info(tr("The project is in {folder}: File, Open project.", folder=folder))

        to = answer[1] / ask.file_name(answer[0])
        bench.run_long(self, jobs.UNPACK_PROJECT, file, to, label=tr("Unpacking the project"), on_done=unpacked)
