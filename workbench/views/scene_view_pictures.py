"""The scene where a window has no OpenGL: pictures of it, rendered off screen (EGL, OSMesa), shown like photographs."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable

import numpy as np
import vtkmodules.vtkInteractionWidgets
import vtkmodules.vtkViewsContext2D  # noqa: F401  both and Plotter: or pyvista imports them in the GUI thread
from numpy.typing import NDArray
from PySide6.QtWidgets import QWidget
from pyvista import Plotter

from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_colours import Rgb
from workbench.views.scene_view_contents import Scene
from workbench.views.scene_view_messages import route_messages
from workbench.views.scene_view_picture_widget import PictureWidget
from workbench.views.scene_view_pieces import Key
from workbench.views.scene_view_stage import Stage, read_pixels

os.environ.setdefault("ALLOW_PLOTTING", "true")  # the probe has found out; pyvista would try again in the GUI thread


class PicturesSurface:
    """The scene as pictures from VTK; see `SceneSurface`."""

    kind = "pictures"

    def __init__(self, parent: QWidget, draw_now: Callable[[], None]) -> None:
        self._widget = PictureWidget(parent, draw_now)
        route_messages()
        self._plotter = Plotter(off_screen=True)
        window = self._plotter.render_window
        assert window is not None
        for renderer in list(window.GetRenderers()):
            window.RemoveRenderer(renderer)
        self._stage = Stage(window)

    @property
    def widget(self) -> QWidget:
        return self._widget

    @property
    def ready(self) -> bool:
        return True

    def set_look(self, background: Rgb, point_size: float) -> None:
        self._stage.set_background(background)
        self._stage.point_size = point_size

    def is_made(self, scene: Scene, key: Key) -> bool:
        return self._stage.is_made(scene, key)

    def draw(
        self, scene: Scene, camera: SceneCamera, keys: Iterable[Key], *, first: bool, last: bool, smooth: bool
    ) -> None:
        if first:
            self._stage.pixel_ratio = self._widget.devicePixelRatioF()
            self._stage.window.SetSize(*self._widget.device_size)
        self._stage.draw(scene, camera, keys, first=first, last=last, smooth=smooth)
        if last:
            self._widget.show_pixels(read_pixels(self._stage.window))

    def pixels(self) -> NDArray[np.uint8]:
        return self._widget.pixels

    def finish(self) -> None:
        self._stage.close()
        self._plotter.close()
        self._widget.setParent(None)
        self._widget.deleteLater()
