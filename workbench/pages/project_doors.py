"""All ways into and out of a project: new, open, from a recording set, the sample, the simulated rig, close."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from core.errors import InputError
from core.files.project import Project, is_project, new_project, project_from_set, recoverable
from workbench import jobs
from workbench.bench import Bench
from workbench.views import ask


class ProjectDoors(QObject):
    """Opens and closes projects; asks where something could be lost, and only there."""

    go_to = Signal(str)

    def __init__(self, bench: Bench, window: QWidget) -> None:
        super().__init__(window)
        self.bench, self.model, self._window = bench, bench.model, window

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
            self.open_set(folder)

    def open_dropped(self, path: Path) -> None:
        """Open whatever this is: a project, or a recording set."""
        if is_project(path):
            self.open_project(path)
        elif (path / "rig.toml").exists() or path.name == "rig.toml":
            self.open_set(path.parent if path.name == "rig.toml" else path)
        else:
            self.bench.notices.error(
                self.tr("{0}: is neither a project (project.json) nor a recording set (rig.toml).").format(path)
            )

    def open_project(self, path: Path) -> None:
        """Open a project; asks whether to recover what was autosaved before a crash."""
        if not self.close_project():
            return
        folder = path.parent if path.name == "project.json" else path
        try:
            recover = recoverable(folder) is not None and self._wants_recovery(folder)
            self.model.open(folder, recover=recover)
        except InputError as error:
            self.bench.notices.error(str(error))
            return
        self.bench.settings.remember(folder)

    def open_set(self, folder: Path) -> None:
        """Make a project that measures a recording set where it lies."""
        self._make(
            self.tr("New project from {0}").format(folder.name),
            folder.resolve().name,
            lambda name: project_from_set(folder, name),
        )

    def open_sample(self) -> None:
        """Open the finished sample project; it is measured first if this has not been done yet."""
        folder = self.bench.settings.projects_folder / self.tr("Sample")
        if is_project(folder):
            self.open_project(folder)
            return
        self.bench.measure(
            jobs.SAMPLE_PROJECT,
            folder,
            label=self.tr("Preparing the sample"),
            on_done=lambda made: self.open_project(made),
        )

    def try_simulated(self) -> None:
        """A new project whose live source is the simulated rig."""
        base = self.bench.settings.projects_folder
        names = (self.tr("Simulated rig") + (f" {number}" if number > 1 else "") for number in range(1, 1000))
        name = next(name for name in names if not (base / name).exists())
        if self._create(base / name, lambda given: new_project(given), name):
            self.go_to.emit("camera")

    def save(self) -> bool:
        """Save; False if it could not be."""
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
        if self.bench.live.busy or self.bench.measuring.busy:
            if not self.may_leave([self.tr("A job is running.")]):
                return False
        elif not self.may_leave([]):
            return False
        self.model.close()
        return True

    def may_leave(self, busy: Sequence[str]) -> bool:
        """Whether the project can be left: asks if something runs or cannot be saved, else saves."""
        running = " ".join(sentence for sentence in busy if sentence)
        if running:
            text = self.tr("{0} What is recorded is kept. Stop it and leave?").format(running)
            if ask.ask(self._window, self.tr("Leave the project"), text, [self.tr("Stop and leave"), self.tr("Stay")]):
                return False
        self.model.leaving.emit()
        if not self.model.is_modified or self.save():
            return True
        text = self.tr("The project cannot be saved. Leave and lose the changes?")
        answers = [self.tr("Leave without saving"), self.tr("Stay")]
        return ask.ask(self._window, self.tr("Leave the project"), text, answers) == 0

    def _wants_recovery(self, folder: Path) -> bool:
        text = self.tr("{0} was not closed properly. There are newer changes than the saved ones.").format(folder.name)
        answers = [self.tr("Recover the changes"), self.tr("Open the saved state")]
        return ask.ask(self._window, self.tr("Recover the project"), text, answers) == 0

    def _make(self, title: str, name: str, project: Callable[[str], Project]) -> None:
        answer = ask.ask_name_and_folder(self._window, title, name, self.bench.settings.projects_folder)
        if answer is None:
            return
        name, folder = answer
        self.bench.settings.projects_folder = folder
        self._create(folder / ask.file_name(name), project, name)

    def _create(self, folder: Path, project: Callable[[str], Project], name: str) -> bool:
        if not self.close_project():
            return False
        try:
            made = project(name)
            self.model.create(folder, replace(made, info=replace(made.info, name=name)))
        except InputError as error:
            self.bench.notices.error(str(error))
            return False
        self.bench.settings.remember(folder)
        return True
