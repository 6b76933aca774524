"""The scene in a window with OpenGL: VTK draws into a widget of Qt's (pyvistaqt), labels are drawn over it by Qt.

The widget only ever shows the last finished picture; when a new one is drawn is decided by `scene_view_pace`. Mouse
and keys never reach VTK: the overlay above takes them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import vtkmodules.vtkInteractionWidgets
import vtkmodules.vtkViewsContext2D  # noqa: F401  both: or pyvista imports them in the GUI thread, which takes 100 ms
from numpy.typing import NDArray
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QWidget
from pyvistaqt import QtInteractor

from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_colours import Rgb
from workbench.views.scene_view_contents import Scene
from workbench.views.scene_view_messages import route_messages
from workbench.views.scene_view_pieces import Key
from workbench.views.scene_view_stage import Stage, read_pixels

COLOUR_BUFFER = 0x4000  # GL_COLOR_BUFFER_BIT
SOON_MS = 1
"""A later round of the event loop: what is to be done after 0 ms Qt does before it looks at mouse and keys again."""


class _Interactor(QtInteractor):
    """The widget, which renders only when it is told to."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, auto_update=False, multi_samples=0)
        self.setAcceptDrops(False)
        self.setAccessibleName(self.tr("3D view"))
        self.iren.interactor.EnableRenderOff()
        self.started = False
        self.ground: Rgb = (0, 0, 0)
        self.before_paint: Callable[[], None] | None = None
        self._drawn_size = self.size()

    def initializeGL(self) -> None:
        """Set up; what is drawn for the first time is drawn in later rounds of the event loop, as it takes its time."""
        super().initializeGL()  # type: ignore[no-untyped-call]
        QTimer.singleShot(SOON_MS, self, self._own_a_picture)

    def paintGL(self) -> None:
        """Show the last picture; a new size needs a new one first."""
        if not self.started and self._gl is not None:
            self._gl.glClearColor(*(shade / 255 for shade in self.ground), 1.0)
            self._gl.glClear(COLOUR_BUFFER)
            return
        if self.before_paint is not None and self._drawn_size != self.size():
            self._drawn_size = self.size()
            self.before_paint()
        super().paintGL()  # type: ignore[no-untyped-call]

    def _own_a_picture(self) -> None:
        """Render once: VTK must own a picture before the first one is shown."""
        if self.before_paint is None:
            return  # it is being taken away
        self._RenderWindow.Render()
        QTimer.singleShot(SOON_MS, self, self._begin)

    def _begin(self) -> None:
        if self.before_paint is not None:
            self.started, self._drawn_size = True, self.size()
            self.setUpdatesEnabled(False)
            self.before_paint()
            QTimer.singleShot(SOON_MS, self, self._reveal)

    def _reveal(self) -> None:
        """Be seen, and draw once more: the first picture is lost where the page itself has only just been shown."""
        self.setUpdatesEnabled(True)
        if self.before_paint is not None:
            self.before_paint()


class EmbeddedSurface:
    """The scene in an OpenGL widget.

    Parameters
    ----------
    parent
        The widget it is put into.
    draw_now
        Called when it must draw before it is next seen, as after a change of size.
    """

    kind = "embedded"

    def __init__(self, parent: QWidget, draw_now: Callable[[], None]) -> None:
        route_messages()
        self._interactor = _Interactor(parent)
        self._interactor.before_paint = draw_now
        window = self._interactor.GetRenderWindow()  # type: ignore[no-untyped-call]
        for renderer in list(window.GetRenderers()):
            window.RemoveRenderer(renderer)
        self._stage = Stage(window)

    @property
    def widget(self) -> QWidget:
        widget: QWidget = self._interactor
        return widget

    @property
    def ready(self) -> bool:
        return bool(self._interactor.started)

    def set_look(self, background: Rgb, point_size: float) -> None:
        self._interactor.ground = background
        self._stage.set_background(background)
        self._stage.point_size = point_size

    def is_made(self, scene: Scene, key: Key) -> bool:
        return self._stage.is_made(scene, key)

    def draw(
        self, scene: Scene, camera: SceneCamera, keys: Iterable[Key], *, first: bool, last: bool, smooth: bool
    ) -> None:
        self._stage.pixel_ratio = self._interactor.devicePixelRatioF()
        self._stage.draw(scene, camera, keys, first=first, last=last, smooth=smooth)

    def pixels(self) -> NDArray[np.uint8]:
        return read_pixels(self._stage.window)

    def finish(self) -> None:
        self._interactor.before_paint = None
        self._stage.close()
        self._interactor.close()
        self._interactor.setParent(None)
        self._interactor.deleteLater()
