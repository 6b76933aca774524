"""How this computer can draw in 3D, found out without stopping the window and without crashing it.

1. Qt can make an OpenGL 3.2 context for its windows (Qt refuses politely where VTK would abort): VTK is embedded.
2. Else another process renders a small picture off screen: if it comes out well, pictures of the scene are shown.
3. Else there is no 3D.

The libraries are imported by a thread that makes and holds no object of Qt's, though PySide6 and pyvistaqt are among
what it imports: importing pyvista takes 1 s of processor time and, from a slow disk, many seconds, for which the
window would stand still. It is the only thread that the window starts; at the program's end it stops before the next
module. The answer holds for the life of the program.
"""

from __future__ import annotations

import importlib
import logging
import os
import sys
import threading
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Literal

from PySide6.QtCore import QCoreApplication, QObject, QProcess, QTimer, Signal
from PySide6.QtGui import QGuiApplication, QOffscreenSurface, QOpenGLContext, QSurfaceFormat
from PySide6.QtWidgets import QWidget

from core.processes import module_command

Kind = Literal["embedded", "pictures", "none"]

VARIABLE = "TRISECT_NO_OPENGL"
"""In the environment: "none" for no 3D at all, anything else but nothing for no OpenGL in the window."""

WITH_WINDOWS = ("xcb", "wayland", "wayland-egl", "windows", "cocoa")
"""Qt's platforms whose windows can have OpenGL."""

SURFACES = "workbench.views.scene.surfaces"
"""The module that draws; run as a program it tries whether pictures can be rendered."""

TRIAL_MS = 60_000
"""A driver that has drawn nothing by then never will; a very busy machine may take half a minute."""

LOOK_MS = 30
"""How often is looked whether the libraries are there."""

_log = logging.getLogger(__name__)


class Readiness(QObject):
    """Knowledge about drawing in 3D; one for the program: see `readiness`."""

    known = Signal()
    """`kind` has become known, or has changed."""

    def __init__(self, parent: QObject | None) -> None:
        super().__init__(parent)
        self._kind: Kind | None = None
        self._opengl: bool | None = None
        self._trial: QProcess | None = None
        self._thread: threading.Thread | None = None
        self._stoppable = _StoppableImport()
        self._look_again = QTimer(self, singleShot=True, interval=LOOK_MS)
        self._look_again.timeout.connect(self._look)
        self._importing: tuple[Kind, list[Exception]] = ("none", [])
        """What holds once the libraries are imported, and why they could not be."""
        self.notified: frozenset[Kind] = frozenset()
        """What the technician has been told of: once is enough."""

    @property
    def kind(self) -> Kind | None:
        """How this computer draws in 3D: in an OpenGL window, as pictures, or not at all; None while not known."""
        return "none" if os.environ.get(VARIABLE) == "none" else self._kind

    def opengl_in_windows(self) -> bool:
        """Whether Qt's windows have an OpenGL that is good enough for VTK; tried once."""
        if os.environ.get(VARIABLE):
            return False
        if self._opengl is None:
            self._opengl = QGuiApplication.platformName() in WITH_WINDOWS and _context_can_be_made()
        return self._opengl

    def find_out(self) -> None:
        """Find out in the background how this computer can draw in 3D, unless that is known or under way."""
        if self.kind is not None or self._trial is not None or self._thread is not None:
            return
        if self.opengl_in_windows():
            self._import("embedded")
            return
        trial = self._trial = QProcess(self)
        trial.setStandardInputFile(QProcess.nullDevice())
        trial.finished.connect(self._tried)
        trial.errorOccurred.connect(self._tried)
        patience = QTimer(trial)  # ends with the trial, as a single shot would not
        patience.setSingleShot(True)
        patience.timeout.connect(trial.kill)
        patience.start(TRIAL_MS)
        program, *arguments = module_command(SURFACES)
        trial.start(program, arguments)

    def give_up(self, kind: Kind) -> None:
        """Replace a way of drawing that fails by the next one: OpenGL window, pictures, nothing."""
        self._opengl = False
        self._kind = None if kind == "embedded" else "none"
        self.find_out()
        self.known.emit()

    def stop(self) -> None:
        """Stop finding out how to draw in 3D, as the program ends."""
        self._stoppable.stopped = True
        if self._trial is not None:
            self._trial.blockSignals(True)
            self._trial.kill()
            self._trial.waitForFinished(1000)
            self._trial = None

    def _tried(self) -> None:
        trial, self._trial = self._trial, None
        if trial is None:
            return
        trial.deleteLater()
        if trial.error() == QProcess.ProcessError.UnknownError and trial.exitCode() == 0:  # "unknown" is Qt's "none"
            self._import("pictures")
            return
        said = bytes(trial.readAllStandardError().data()).decode(errors="replace")[-500:]
        _log.warning("drawing in 3D does not work here: %s", said or trial.errorString())
        self.give_up("pictures")

    def _import(self, kind: Kind) -> None:
        """Import the libraries on a thread that makes no object of Qt's."""
        failed: list[Exception] = []
        self._thread = threading.Thread(target=self._stoppable.run, args=(failed,), name="pyvista import")
        self._thread.start()
        self._importing = kind, failed
        self._look()

    def _look(self) -> None:
        """Whether the libraries are there; else once more in a moment."""
        kind, failed = self._importing
        if self._thread is not None and self._thread.is_alive():
            self._look_again.start()
            return
        self._thread = None
        if self._stoppable.stopped:
            return  # not everything is imported, and who is told now would import the rest in the GUI thread
        if failed:
            _log.error("the 3D libraries cannot be imported: %r", failed[0])
        self._kind = "none" if failed else kind
        self.known.emit()


class _Stopped(BaseException):
    """Ends an import; no library takes it for a module that is missing."""


class _StoppableImport(MetaPathFinder):
    """Imports SURFACES on a thread, and can be told to stop before the next of the modules this takes."""

    def __init__(self) -> None:
        self.stopped = False
        self._thread = 0

    def run(self, failed: list[Exception]) -> None:
        """Import them; why they cannot be imported is added to `failed`."""
        self._thread = threading.get_ident()
        sys.meta_path.insert(0, self)
        try:
            importlib.import_module(SURFACES)
        except _Stopped:
            pass
        except Exception as error:  # noqa: BLE001  whatever is wrong with them, the program goes on without 3D
            failed.append(error)
        finally:
            sys.meta_path.remove(self)

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Asked by Python before each module: leave it to the other finders, unless we are to stop."""
        if self.stopped and threading.get_ident() == self._thread:
            raise _Stopped
        return None


def reserve_opengl(view: QWidget) -> None:
    """Give a window an OpenGL widget before it is shown, as adding one later would make it flicker."""
    if readiness().opengl_in_windows():
        from PySide6.QtOpenGLWidgets import QOpenGLWidget

        placeholder = QOpenGLWidget(view)
        placeholder.setGeometry(0, 0, 1, 1)
        placeholder.hide()


def _context_can_be_made() -> bool:
    wanted = QSurfaceFormat()
    wanted.setRenderableType(QSurfaceFormat.RenderableType.OpenGL)
    wanted.setProfile(QSurfaceFormat.OpenGLContextProfile.CoreProfile)
    wanted.setVersion(3, 2)
    context = QOpenGLContext()
    context.setFormat(wanted)
    if not context.create() or context.format().version() < (3, 2) or context.isOpenGLES():
        return False
    surface = QOffscreenSurface()
    surface.setFormat(context.format())
    surface.create()
    if not surface.isValid() or not context.makeCurrent(surface):
        return False
    context.doneCurrent()
    return True


_readiness: list[Readiness] = []


def readiness() -> Readiness:
    """Return the program's one `Readiness`, what is known of drawing in 3D; in the GUI thread only."""
    if not _readiness:
        app = QCoreApplication.instance()
        made = Readiness(app)
        if app is not None:
            app.aboutToQuit.connect(made.stop)
        _readiness.append(made)
    return _readiness[0]
