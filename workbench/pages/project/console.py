"""The Python console of the open project: one window, which ends with the project and says when that has changed."""

from __future__ import annotations

from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QWidget

from core.files.project.data import ProjectFile
from workbench.project_model import ProjectModel
from workbench.views.console import ConsoleWindow
from workbench.work.process import ChildProcess


class ProjectConsole(QObject):
    """Owner of the console's window, which follows the project.

    Parameters
    ----------
    parent
        The window that the console belongs to.
    """

    def __init__(self, model: ProjectModel, parent: QWidget) -> None:
        super().__init__(parent)
        self._model, self._parent = model, parent
        self.window: ConsoleWindow | None = None
        self._read: ProjectFile | None = None
        model.opened.connect(self.end)
        model.changed.connect(self._look)
        model.results_changed.connect(self._look)

    def open(self) -> None:
        """Show the Python console of the project, which is started if it does not run."""
        folder = self._model.folder
        if folder is None:
            return
        if self.window is None:
            self.window = ConsoleWindow(folder, self._put_on_disk, self._parent)
            self.window.ended.connect(self._gone)
        self.window.begin()

    def end(self, *, wait: bool = False) -> None:
        """End the Python console if it runs; with `wait`, return when its processes are gone."""
        if self.window is not None:
            self.window.end()
        if wait:
            for process in self._parent.findChildren(ChildProcess, options=Qt.FindChildOption.FindDirectChildrenOnly):
                process.wait()

    def _put_on_disk(self) -> None:
        self._model.save_by_itself()
        self._read = self._model.file

    def _look(self, *_: object) -> None:
        if self.window is not None and self._read is not None:
            self.window.set_outdated(self._model.file != self._read)

    def _gone(self) -> None:
        self.window = None
