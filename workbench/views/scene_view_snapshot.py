"""A 3D view as a picture, for the eye and for the disk."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QBuffer, QIODevice, QObject, Signal
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QFileDialog, QWidget

from core.errors import InputError
from core.files import atomic
from workbench.views.scene_view_backing import Backing
from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_contents import Scene
from workbench.views.scene_view_overlay import Look
from workbench.views.scene_view_painter import PainterSurface
from workbench.views.scene_view_picture_widget import image_pixels, pixels_image
from workbench.views.scene_view_pieces import whole


class Snapshot(QObject):
    """Takes pictures of `view`: what its surface has drawn, or drawn here if nobody has seen it yet.

    `camera` and `size` say how it is seen now; `paint` paints the colour bar and the labels over it.
    """

    failed = Signal(str)
    """Why a picture could not be saved."""

    def __init__(
        self,
        scene: Scene,
        backing: Backing,
        camera: Callable[[], SceneCamera],
        size: Callable[[], tuple[int, int]],
        paint: Callable[[QPainter], None],
        view: QWidget,
    ) -> None:
        super().__init__(view)
        self._scene, self._backing, self._camera = scene, backing, camera
        self._size, self._paint, self._view = size, paint, view

    def picture(self) -> NDArray[np.uint8]:
        """What is shown, whole, with colour bar and labels: (h, w, 3). Waits until everything is drawn."""
        surface, pace = self._backing.surface, self._backing.pace
        if surface is not None and pace is not None and surface.ready and surface.widget.isVisible():
            pace.finish_now()
            pixels = surface.pixels()
        else:
            pixels = self._painted()
        image = pixels_image(pixels).convertToFormat(QImage.Format.Format_RGB32)
        painter = QPainter(image)
        painter.scale(image.width() / self._size()[0], image.height() / self._size()[1])
        self._paint(painter)
        painter.end()
        return image_pixels(image)

    def save(self, path: Path) -> None:
        """Write the picture as PNG.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        buffer = QBuffer()
        buffer.open(QIODevice.OpenModeFlag.WriteOnly)
        pixels_image(self.picture()).save(buffer, "PNG")  # type: ignore[call-overload]
        atomic.write_bytes(path, bytes(buffer.data().data()))

    def ask_and_save(self) -> None:
        """Ask for a place, and write the picture there."""
        name, _ = QFileDialog.getSaveFileName(
            self._view, self.tr("Save this picture"), "scene.png", self.tr("Pictures (*.png)")
        )
        if not name:
            return
        try:
            self.save(Path(name).with_suffix(".png"))
        except InputError as error:
            self.failed.emit(str(error))

    def _painted(self) -> NDArray[np.uint8]:
        """The picture of a view that nobody has seen yet."""
        hidden = QWidget()
        surface = PainterSurface(hidden, lambda: None)
        surface.widget.resize(*self._size())
        ground = Look.of(self._view.palette()).ground
        surface.set_look((ground.red(), ground.green(), ground.blue()), self._backing.point_size)
        surface.draw(self._scene, self._camera(), whole(self._scene), first=True, last=True, smooth=True)
        return surface.pixels()
