"""What a way of drawing the scene has to offer, whether it is OpenGL in the window, pictures from VTK, or numpy."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from PySide6.QtWidgets import QWidget

from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_colours import Rgb
from workbench.views.scene_view_contents import Scene
from workbench.views.scene_view_pieces import Key


class SceneSurface(Protocol):
    """Draws the scene in passes onto a widget. Everything happens in the GUI thread."""

    kind: str
    """"embedded", "pictures" or "painter"."""

    @property
    def widget(self) -> QWidget:
        """Where it is seen."""

    @property
    def ready(self) -> bool:
        """Whether a pass can be drawn now."""

    def set_look(self, background: Rgb, point_size: float) -> None:
        """Colour behind the scene, and how many logical pixels wide points are."""

    def is_made(self, scene: Scene, key: Key) -> bool:
        """Whether a piece can be drawn at once, without being gathered first."""

    def draw(
        self, scene: Scene, camera: SceneCamera, keys: Iterable[Key], *, first: bool, last: bool, smooth: bool
    ) -> None:
        """Draw one pass and wait for it.

        Parameters
        ----------
        keys
            Pieces of cloud and mesh to draw.
        first
            Start a new picture, with lines; else draw over what is there.
        last
            Finish it with marks and all that is transparent, and show it.
        smooth
            Smooth the edges of what is there after this pass, if that can be done. Not for points: small ones fade.
        """

    def pixels(self) -> NDArray[np.uint8]:
        """The picture that was shown last, (h, w, 3) in device pixels."""

    def finish(self) -> None:
        """Give back everything; the surface is not used again."""
