"""Choosing by hand: a click gives a point of the cloud, a drawn outline gives all points inside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QPointF, QTimer, Signal

from core.model.arrays import Array
from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_choose import BATCH, Outline, nearest_point, points_inside
from workbench.views.scene_view_cloud import SceneCloud
from workbench.views.scene_view_contents import Scene


@dataclass(eq=False, slots=True)
class _Search:
    """A region on its way: what has been looked at so far."""

    cloud: SceneCloud
    camera: SceneCamera
    size: tuple[int, int]
    outline: Outline
    inside: NDArray[np.bool_]
    done: int = 0


class Chooser(QObject):
    """Finds points of the scene's cloud on the screen. A large cloud is searched bit by bit, so that nothing waits."""

    picked = Signal(int, object)
    selected = Signal(object)

    def __init__(
        self, scene: Scene, camera: Callable[[], SceneCamera], size: Callable[[], tuple[int, int]], parent: QObject
    ) -> None:
        super().__init__(parent)
        self._scene, self._camera, self._size = scene, camera, size
        self.marked: Array | None = None
        self._search: _Search | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._look_further)

    def point_at(self, at: QPointF) -> tuple[int, Array] | None:
        """Number and coordinates (3,) in mm of the point under the cursor."""
        cloud = self._cloud()
        if cloud is None:
            return None
        index = nearest_point(cloud.points, self._camera(), self._size(), (at.x(), at.y()))
        return None if index is None else (index, cloud.points[index].copy())

    def pick(self, at: QPointF) -> None:
        """Choose and mark the point under the cursor, if there is one."""
        found = self.point_at(at)
        if found is not None:
            self.marked = found[1]
            self.picked.emit(*found)

    def choose_region(self, corners: list[QPointF]) -> None:
        """Choose all points inside an outline; `selected` tells which, a little later."""
        cloud = self._cloud()
        if cloud is None:
            self.selected.emit(np.zeros(self._scene.cloud.given if self._scene.cloud else 0, dtype=bool))
            return
        outline = Outline([(corner.x(), corner.y()) for corner in corners])
        self._search = _Search(cloud, self._camera(), self._size(), outline, np.zeros(cloud.given, dtype=bool))
        self._timer.start()

    def stop(self) -> None:
        """Forget what is on its way."""
        self._timer.stop()
        self._search = None

    def _cloud(self) -> SceneCloud | None:
        """The cloud, if it is seen or a mesh of it is."""
        return self._scene.visible_cloud or (self._scene.cloud if self._scene.visible_mesh is not None else None)

    def _look_further(self) -> None:
        search = self._search
        if search is None:
            self._timer.stop()
            return
        part = slice(search.done, min(search.done + BATCH, len(search.inside)))
        search.inside[part] = points_inside(search.cloud.points[part], search.camera, search.size, search.outline)
        search.done = part.stop
        if search.done == len(search.inside):
            self.stop()
            self.selected.emit(search.inside)
