"""Which way of drawing the scene this computer can do, found out without stopping the window and without crashing it.

1. `TRISECT_NO_OPENGL=painter` in the environment: painted by numpy, nothing is imported or tried. Any other value but
   an empty one: no OpenGL in the window, go on at 3.
2. Qt can make an OpenGL 3.2 context for its windows (tried once, in this process; Qt refuses politely where VTK would
   abort): VTK is embedded. Qt's platforms without a screen are not asked.
3. Another process renders a small picture off screen with VTK: if it comes back well, pictures are rendered.
4. Else numpy paints. So it does if 2 turns out to show nothing after all.

Step 3 and the import of the libraries take a second or two; they run on a thread, started by `warm_up` when the
program is idle or by the first view that is shown. The answer holds for the life of the program.
"""

from __future__ import annotations

import gc
import importlib
import logging
import os
import subprocess
import sys
import threading
from typing import Literal

from PySide6.QtCore import QCoreApplication, QObject, Signal
from PySide6.QtGui import QGuiApplication, QOffscreenSurface, QOpenGLContext, QSurfaceFormat
from PySide6.QtWidgets import QWidget

SurfaceKind = Literal["embedded", "pictures", "painter"]

VARIABLE = "TRISECT_NO_OPENGL"
WITH_WINDOWS = ("xcb", "wayland", "wayland-egl", "windows", "cocoa")
"""Qt's platforms whose windows can have OpenGL."""

PROBE_SECONDS = 30

_log = logging.getLogger(__name__)


class Herald(QObject):
    """Says when the libraries are there."""

    arrived = Signal()


class _Choice:
    """What is known so far."""

    herald: Herald | None = None
    thread: threading.Thread | None = None
    kind: SurfaceKind | None = None
    opengl: bool | None = None
    told: frozenset[str] = frozenset()


def herald() -> Herald:
    """The one that tells; made in the GUI thread."""
    if _Choice.herald is None:
        _Choice.herald = Herald()
        app = QCoreApplication.instance()
        if app is not None:
            _Choice.herald.moveToThread(app.thread())
    return _Choice.herald


def known() -> SurfaceKind | None:
    """How the scene is drawn here, its libraries imported; None while that is not known."""
    if _Choice.kind is None and os.environ.get(VARIABLE) == "painter":
        return "painter"
    return _Choice.kind


def opengl_in_windows() -> bool:
    """Whether Qt gives its windows OpenGL good enough for VTK. GUI thread only; asks once.

    Sets the default surface format: it must be known before the first window is made.
    """
    if os.environ.get(VARIABLE):
        return False
    if _Choice.opengl is None:
        _Choice.opengl = QGuiApplication.platformName() in WITH_WINDOWS and _context_can_be_made()
    return _Choice.opengl


def reserve_opengl(view: QWidget) -> None:
    """A window that gets its first OpenGL widget while it is seen is made anew and flickers: let it have one."""
    if opengl_in_windows():
        from PySide6.QtOpenGLWidgets import QOpenGLWidget

        placeholder = QOpenGLWidget(view)
        placeholder.setGeometry(0, 0, 1, 1)
        placeholder.hide()


def first_time(kind: SurfaceKind) -> bool:
    """Whether no view of the program has been drawn so before: what there is to say about it is said once."""
    first = kind not in _Choice.told
    _Choice.told |= {kind}
    return first


def forget_opengl() -> None:
    """OpenGL was promised and does not work: paint from now on."""
    _Choice.opengl, _Choice.kind = False, "painter"


def warm_up() -> None:
    """Find out and import in the background, unless that is done or on its way. GUI thread only."""
    if known() is not None or _Choice.thread is not None:
        return
    teller, embedded = herald(), opengl_in_windows()
    _Choice.thread = threading.Thread(target=_find_out, args=(embedded, teller), name="pyvista import")
    _Choice.thread.start()


def _find_out(embedded: bool, teller: Herald) -> None:
    """On its own thread. Imports only; no object of VTK's is touched."""
    kind: SurfaceKind = "painter"
    collecting = gc.isenabled()
    gc.disable()  # so many new objects make collections of 100 ms, which would stop the window
    try:
        if embedded:
            importlib.import_module("workbench.views.scene_view_vtk")
            kind = "embedded"
        elif _pictures_can_be_rendered():
            importlib.import_module("workbench.views.scene_view_pictures")
            kind = "pictures"
    except Exception:  # noqa: BLE001  whatever is wrong with the libraries, the program goes on without them
        _log.exception("the 3D libraries cannot be imported; pictures of the scene are painted without them")
    finally:
        gc.freeze()  # what was imported stays for good: later collections need not go through it again
        if collecting:
            gc.enable()
    _Choice.kind, _Choice.thread = kind, None
    try:
        teller.arrived.emit()
    except RuntimeError:
        _log.debug("the program ended before the 3D libraries were there")


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


def _pictures_can_be_rendered() -> bool:
    """Let another process try: where drivers are broken, trying ends it."""
    if getattr(sys, "frozen", False):
        return False  # the executable is not a Python that could run the probe
    try:
        probe = subprocess.run(
            [sys.executable, "-m", "workbench.views.scene_view_probe"],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=PROBE_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        _log.warning("off-screen rendering could not be tried: %s", error)
        return False
    if probe.returncode != 0:
        _log.warning("off-screen rendering does not work: %s", probe.stderr.decode(errors="replace")[-500:])
    return probe.returncode == 0
