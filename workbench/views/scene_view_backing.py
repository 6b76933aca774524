"""Makes whatever draws the scene when it is first seen, dresses it, and takes it away again."""

from __future__ import annotations

import importlib
import logging
from collections.abc import Callable

from PySide6.QtCore import QCoreApplication, QObject, Qt, Signal
from PySide6.QtWidgets import QWidget

from workbench.views import scene_view_choice as choice
from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_canvas import Canvas
from workbench.views.scene_view_contents import Scene
from workbench.views.scene_view_overlay import Look
from workbench.views.scene_view_pace import ScenePace, single_shot
from workbench.views.scene_view_painter import PainterSurface
from workbench.views.scene_view_surface import SceneSurface

DOUBT_MS = 5000
"""An OpenGL view that has shown nothing for so long never will."""

_log = logging.getLogger(__name__)


class Backing(QObject):
    """The surface of one view and its pace; neither exists before there is something to see and somebody to see it."""

    notice = Signal(str)
    presented = Signal()
    waiting = Signal(bool)
    """Whether the 3D libraries are still on their way."""

    def __init__(self, scene: Scene, canvas: Canvas, camera: Callable[[], SceneCamera], parent: QWidget) -> None:
        super().__init__(parent)
        self._scene, self._canvas, self._camera, self._owner = scene, canvas, camera, parent
        self.point_size = 2.0
        self.surface: SceneSurface | None = None
        self.pace: ScenePace | None = None
        self._begin, self._reveal = single_shot(self, 0, self._start), single_shot(self, 0, self._show)
        self._doubt = single_shot(self, DOUBT_MS, self._give_up)
        self.presented.connect(self._doubt.stop)
        app = QCoreApplication.instance()
        if app is not None:
            app.aboutToQuit.connect(self.finish)

    def ensure(self) -> None:
        """Make the surface if there is need of one; later if the libraries are not there yet."""
        if self.surface is not None or self._scene.empty or not self._canvas.isVisible():
            return
        kind = choice.known()
        if kind is None:
            # A second connection of the same slot is refused: one call is enough.
            choice.herald().arrived.connect(self.ensure, Qt.ConnectionType.UniqueConnection)
            choice.warm_up()
            self.waiting.emit(True)
            return
        self.waiting.emit(False)
        self._begin.start()

    def _start(self) -> None:
        """Make the surface now, and show it in the next round of the event loop: both take their time."""
        kind = choice.known()
        if kind is None or self.surface is not None or self._scene.empty:
            return
        self.surface = self._make(kind)
        self.pace = ScenePace(self._scene, self.surface, self._camera, self)
        self.pace.presented.connect(self.presented)
        self._reveal.start()

    def _show(self) -> None:
        if self.surface is not None:
            self._canvas.put_below(self.surface.widget)
            self.dress()
            self._doubt.start()

    def _give_up(self) -> None:
        """A driver that promised OpenGL and shows nothing is not asked again."""
        if self.surface is None or self.surface.ready or not self._canvas.isVisible():
            return
        _log.warning("the 3D view shows nothing as %s", self.surface.kind)
        self.finish()
        choice.forget_opengl()
        self.ensure()

    def dress(self) -> None:
        """Take the colours of the theme and draw again."""
        if self.surface is None or self.pace is None:
            return
        ground = Look.of(self._owner.palette()).ground
        self.surface.set_look((ground.red(), ground.green(), ground.blue()), self.point_size)
        self.pace.moved()

    def rest(self) -> None:
        """Do nothing until it is seen again."""
        self._begin.stop()
        self._doubt.stop()
        if self.pace is not None:
            self.pace.stop()

    def finish(self) -> None:
        """Take the surface away; nothing is left running."""
        for timer in (self._begin, self._reveal, self._doubt):
            timer.stop()
        if self.pace is not None:
            self.pace.stop()
            self.pace.deleteLater()
            self.pace = None
        if self.surface is not None:
            self._canvas.take(self.surface.widget)
            self.surface.finish()
            self.surface = None

    def _draw_now(self) -> None:
        if self.pace is not None:
            self.pace.draw_now()

    def _make(self, kind: choice.SurfaceKind) -> SceneSurface:
        """The surface of a kind; one that fails is replaced by the next simpler one."""
        surface: SceneSurface | None = None
        try:
            if kind == "embedded":
                vtk = importlib.import_module("workbench.views.scene_view_vtk")
                surface = vtk.EmbeddedSurface(self._canvas, self._draw_now)
            elif kind == "pictures":
                pictures = importlib.import_module("workbench.views.scene_view_pictures")
                surface = pictures.PicturesSurface(self._canvas, self._draw_now)
        except Exception:  # noqa: BLE001  whatever the driver does, the program goes on
            _log.exception("the 3D view could not be made as %s", kind)
        if surface is None:
            kind, surface = "painter", PainterSurface(self._canvas, self._draw_now)
        if kind != "embedded" and choice.first_time(kind):
            self.notice.emit(self._sentence(kind))
        return surface

    def _sentence(self, kind: choice.SurfaceKind) -> str:
        if kind == "pictures":
            return self.tr(
                "This computer offers no OpenGL to the window: the 3D view shows rendered pictures of the scene. "
                "Everything works as usual, turning may be slower."
            )
        return self.tr(
            "This computer offers no OpenGL: the 3D view shows simple painted pictures of the scene. "
            "Everything works as usual, turning is slower."
        )
