"""All ways into and out of a project: new, open, from a recording set, the sample, the simulated rig, close."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from core.errors import InputError
from core.files.project import (
    OPENER,
    Project,
    ProjectFile,
    can_be_saved,
    is_project,
    new_project,
    project_from_set,
    read_project,
    rescues,
)
from core.files.unfinished import Unfinished, forget_recording, unfinished_recording
from workbench.bench import Bench
from workbench.pages.copy_door import CopyDoor
from workbench.pages.project_states import wanted_state
from workbench.pages.sample_door import SampleDoor
from workbench.pages.sources import put_source
from workbench.views import ask

PROJECT, BACKUPS, SET = "project.json", "backups", "rig.toml"


class ProjectDoors(QObject):
    """Opens and closes projects; asks where something could be lost, and only there."""

    go_to = Signal(str)

    def __init__(self, bench: Bench, window: QWidget) -> None:
        super().__init__(window)
        self.bench, self.model, self._window = bench, bench.model, window
        self.sample = SampleDoor(bench, self.open_project, self)
        self.copy = CopyDoor(bench, window, self.save, self.close_project, self._open, self)

    def new_project(self) -> None:
        """Ask for a name and make an empty project."""
        self._make(self.tr("New project"), self.tr("New project"), new_project)

    def choose_project(self) -> None:
        """Ask for a project folder and open it."""
        folder = ask.choose_folder(self._window, self.tr("Open a project folder"), self.bench.settings.projects_folder)
        if folder is not None:
            self.open_dropped(folder)

    def choose_set(self) -> None:
        """Ask for a recording set and make a project of it."""
        folder = ask.choose_folder(
            self._window, self.tr("Choose a recording set (a folder with rig.toml)"), Path.home()
        )
        if folder is not None:
            self.open_dropped(folder)

    def open_dropped(self, path: Path) -> None:
        """Open what `path` is: a project, its project.json or NAME.trisect, an earlier version, or a recording set."""
        path = path.resolve()
        if path.suffix == OPENER and not path.is_dir():
            path = path.parent
        if is_project(path) or rescues(path):
            self.open_project(path)
        elif path.is_file() and path.parent.name == BACKUPS and is_project(path.parent.parent):
            self.open_version(path)
        elif (path / SET).exists() or path.name == SET:
            self.open_set(path.parent if path.name == SET else path)
        else:
            self.bench.notices.error(
                self.tr("{0}: is neither a project (project.json) nor a recording set (rig.toml).").format(path)
            )

    def open_project(self, path: Path) -> None:
        """Open a project; asks what to do about changes saved before a crash, or about a damaged project.json."""
        folder = (path.parent if path.name == PROJECT else path).resolve()
        if folder == self.model.folder:
            return
        try:
            wanted = wanted_state(self._window, folder)
        except InputError as error:
            self.bench.notices.error(str(error))
            return
        if wanted is not None:
            self._open(folder, wanted.version, recover=wanted.recover)

    def open_version(self, path: Path) -> None:
        """Open a project as it was in one of its backups; saving makes that the present one."""
        try:
            version = read_project(path)
        except InputError as error:
            self.bench.notices.error(str(error))
            return
        if self._open(path.parent.parent, version):
            self.bench.notices.info(
                self.tr("This is an earlier version; once it is saved, the present one is among the backups.")
            )

    def open_set(self, folder: Path) -> None:
        """Make a project that measures a recording set where it lies."""
        self._make(
            self.tr("New project from {0}").format(folder.name),
            folder.resolve().name,
            lambda name: project_from_set(folder, name),
        )

    def open_sample(self) -> None:
        """Open the finished sample project; it is measured first if this has not been done yet."""
        self.sample.open()

    def try_simulated(self) -> None:
        """A new project whose live source is the simulated rig."""
        base = self.bench.settings.projects_folder
        names = (self.tr("Simulated rig") + (f" {number}" if number > 1 else "") for number in range(1, 1000))
        name = next(name for name in names if not (base / name).exists())
        if self._create(base / name, new_project, name):
            self.go_to.emit("camera")

    def save(self) -> bool:
        """Save, with what is being typed; False if it could not be."""
        self._take_typed()
        try:
            self.model.save()
        except InputError as error:
            self.bench.notices.error(str(error))
            return False
        return True

    def close_project(self) -> bool:
        """Save and close the project; False if it is to stay open."""
        if not self.model.is_open:
            return True
        if not self.may_leave([self.tr("A recording is running.")] if self.bench.live.busy else []):
            return False
        self.bench.measuring.cancel_all()
        self.model.close()
        return True

    def may_leave(self, busy: Sequence[str]) -> bool:
        """Whether the project can be left: asks if something runs or cannot be saved, else saves.

        `busy`: a sentence for each recording that runs; what is being measured is known here.
        """
        job = self.bench.measuring.current
        measuring = self.tr("A job is not finished yet: {0}.").format(job.label) if job is not None else ""
        running = " ".join(dict.fromkeys(sentence for sentence in (*busy, measuring) if sentence))
        if running:
            text = self.tr("{0} What is recorded is kept. Stop it and leave?").format(running)
            if ask.ask(self._window, self.tr("Leave the project"), text, [self.tr("Stop and leave"), self.tr("Stay")]):
                return False
        self._take_typed()
        self.model.leaving.emit()
        if not self.model.is_modified:
            self.model.autosave()  # nothing is left that could be offered for recovery
            return True
        if self.save():
            return True
        text = self.tr("The project cannot be saved. Leave and lose the changes?")
        answers = [self.tr("Leave without saving"), self.tr("Stay")]
        return ask.ask(self._window, self.tr("Leave the project"), text, answers) == 0

    def _take_typed(self) -> None:
        """What is being typed counts, too: an editor tells its text when it loses the focus."""
        editor = self._window.focusWidget()
        if editor is not None and editor.hasFocus():
            editor.clearFocus()
            editor.setFocus()

    def _open(self, folder: Path, version: ProjectFile | None = None, *, recover: bool = False) -> bool:
        if not self.close_project():
            return False
        try:
            self.model.open(folder, recover=recover, version=version)
        except InputError as error:
            self.bench.notices.error(str(error))
            return False
        self.bench.settings.remember(folder)
        if not can_be_saved(folder):
            self.copy.offer()
        if (unfinished := unfinished_recording(folder)) is not None:
            self._offer(folder, unfinished)
        return True

    def _offer(self, folder: Path, unfinished: Unfinished) -> None:
        """A recording was cut short by a crash: its pictures are whole, and may be used."""
        words = {
            "camera": self.tr("Views of the camera's target were being recorded when the program ended: {0} pictures."),
            "planes": self.tr("Poses of the plate were being recorded when the program ended: {0} pictures."),
            "scan": self.tr("A scan was being recorded when the program ended: {0} pictures."),
        }
        text = " ".join(
            [
                words[unfinished.step].format(unfinished.pictures),
                self.tr("They are kept in {0}. Use them?").format(unfinished.folder),
            ]
        )
        answers = [self.tr("Use them"), self.tr("Leave them there")]
        if ask.ask(self._window, self.tr("Interrupted recording"), text, answers) == 0:
            put_source(self.model, unfinished.step, unfinished.folder, self.tr("use an interrupted recording"))
            self.go_to.emit(unfinished.step)
        try:
            forget_recording(folder)
        except InputError as error:
            self.bench.notices.error(str(error))

    def _make(self, title: str, name: str, project: Callable[[str], Project]) -> None:
        answer = ask.ask_name_and_folder(self._window, title, name, self.bench.settings.projects_folder)
        if answer is None:
            return
        name, folder = answer
        self.bench.settings.projects_folder = folder
        self._create(folder / ask.file_name(name), project, name)

    def _create(self, folder: Path, project: Callable[[str], Project], name: str) -> bool:
        try:
            made = project(name)
            if not self.close_project():
                return False
            self.model.create(folder, replace(made, info=replace(made.info, name=name)))
        except InputError as error:
            self.bench.notices.error(str(error))
            return False
        self.bench.settings.remember(folder)
        return True
