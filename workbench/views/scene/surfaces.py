"""Where the scene is drawn: an OpenGL widget in the window (pyvistaqt), or a picture rendered off screen (pyvista).

`ready` says which, and imports this module. Mouse and keys never reach VTK: the canvas above takes them.
"""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
import shiboken6
import vtkmodules.vtkInteractionWidgets
import vtkmodules.vtkViewsContext2D  # noqa: F401  both: or pyvista imports them in the GUI thread, which takes 100 ms
from numpy.typing import NDArray
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QWidget
from pyvista import Plotter
from pyvistaqt import QtInteractor

from workbench.language import tr
from workbench.views.scene.colours import Rgb
from workbench.views.scene.renderer import Renderer, route_messages

os.environ.setdefault("ALLOW_PLOTTING", "true")  # the trial has found out; pyvista would try again in the GUI thread

COLOUR_BUFFER = 0x4000
"""GL_COLOR_BUFFER_BIT"""

SOON_MS = 1
"""A later round of the event loop: what is to be done after 0 ms Qt does before it looks at mouse and keys again."""


class EmbeddedWidget(QtInteractor):
    """OpenGL widget with the last finished picture; it renders only on request."""

    def __init__(self, parent: QWidget, draw: Callable[[], None]) -> None:
        super().__init__(parent, auto_update=False, multi_samples=0)
        self.setAcceptDrops(False)
        self.setAccessibleName(tr("3D view"))
        self.iren.interactor.EnableRenderOff()
        self.started = False
        self.ground: Rgb = (0, 0, 0)
        self.draw: Callable[[], None] | None = draw
        self._drawn_size = self.size()

    def initializeGL(self) -> None:
        """Prepare for drawing, which begins in later turns of the event loop (called by Qt)."""
        super().initializeGL()  # type: ignore[no-untyped-call]
        QTimer.singleShot(SOON_MS, self, self._own_a_picture)

    def paintGL(self) -> None:
        """Show the picture drawn last; after a resize a new one is drawn first (called by Qt)."""
        if not self.started and self._gl is not None:
            self._gl.glClearColor(*(shade / 255 for shade in self.ground), 1.0)
            self._gl.glClear(COLOUR_BUFFER)
            return
        if self.draw is not None and self._drawn_size != self.size():
            self._drawn_size = self.size()
            self.draw()
        super().paintGL()  # type: ignore[no-untyped-call]

    def _own_a_picture(self) -> None:
        """Render once: VTK must own a picture before the first one is shown."""
        if self.draw is None:
            return  # it is being taken away
        self._RenderWindow.Render()
        QTimer.singleShot(SOON_MS, self, self._begin)

    def _begin(self) -> None:
        if self.draw is not None:
            self.started, self._drawn_size = True, self.size()
            self.setUpdatesEnabled(False)
            self.draw()
            QTimer.singleShot(SOON_MS, self, self._reveal)

    def _reveal(self) -> None:
        """Be seen, and draw once more: the first picture is lost where the page itself has only just been shown."""
        self.setUpdatesEnabled(True)
        if self.draw is not None:
            self.draw()


class EmbeddedSurface:
    """Scene in an OpenGL widget below `canvas`; `draw` is called when it must draw before it is next seen."""

    def __init__(self, canvas: QWidget, draw: Callable[[], None]) -> None:
        route_messages()
        parent = canvas.parentWidget()
        assert parent is not None
        self._canvas = canvas
        self.widget: EmbeddedWidget | None = EmbeddedWidget(parent, draw)
        self.renderer = Renderer(self.widget.GetRenderWindow())  # type: ignore[no-untyped-call]
        self.widget.setGeometry(canvas.geometry())
        self.widget.stackUnder(canvas)
        self.widget.show()

    @property
    def ready(self) -> bool:
        """Whether the OpenGL widget can draw a pass now."""
        return self.widget is not None and self.widget.started

    def fit(self, ground: Rgb) -> None:
        """Give the OpenGL widget the canvas's geometry and the background colour `ground`."""
        if self.widget is not None:
            self.widget.ground = ground
            self.widget.setGeometry(self._canvas.geometry())

    def picture(self) -> NDArray[np.uint8] | None:
        """Return None, as the OpenGL widget shows its drawing itself."""
        return None

    def close(self) -> None:
        """Release everything that the OpenGL widget draws with; it is not used again."""
        widget, self.widget = self.widget, None
        if widget is not None and shiboken6.isValid(widget):
            widget.draw = None
            self.renderer.close()
            widget.close()
            widget.setParent(None)
            widget.deleteLater()


class PictureSurface:
    """Scene as pictures for the canvas, rendered off screen (EGL, GLX, Mesa)."""

    ready = True

    def __init__(self) -> None:
        route_messages()
        self._plotter: Plotter | None = Plotter(off_screen=True)
        window = self._plotter.render_window
        assert window is not None
        self.renderer = Renderer(window)

    def fit(self, ground: Rgb) -> None:
        """Do nothing, as each picture has the size it is drawn in."""

    def picture(self) -> NDArray[np.uint8] | None:
        """Return the picture (h, w, 3), uint8, that was drawn last."""
        return self.renderer.pixels()

    def close(self) -> None:
        """Release everything that pictures are drawn with; this object is not used again."""
        plotter, self._plotter = self._plotter, None
        if plotter is not None:
            self.renderer.close()
            plotter.close()


def works() -> bool:
    """Whether drawing off screen works: a small picture comes out with the background it was given."""
    from workbench.views.scene.camera import SceneCamera
    from workbench.views.scene.contents import Scene
    from workbench.views.scene.passes import Pass

    plotter = Plotter(off_screen=True)
    assert plotter.render_window is not None
    renderer = Renderer(plotter.render_window)
    renderer.set_background((200, 100, 50))
    camera = SceneCamera.looking((0, 0, -1), (0, -1, 0), (0, 0, 500), 500)
    renderer.draw(Scene(), camera, Pass((), first=True, last=True), (16, 16), 1.0)
    shown = np.median(renderer.pixels().reshape(-1, 3), axis=0)
    renderer.close()
    plotter.close()
    return bool(np.abs(shown - (200, 100, 50)).max() < 4)


if __name__ == "__main__":
    import sys

    sys.exit(0 if works() else 1)
