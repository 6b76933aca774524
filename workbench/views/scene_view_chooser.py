"""Choosing by hand: a click gives a point of the cloud, a drawn outline gives all points inside.

A large cloud is searched bit by bit between other events, so that nothing waits for it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from PySide6.QtCore import QObject, QPointF, QTimer, Signal

from core.model.arrays import Array
from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_choose import BATCH, Nearest, Outline, points_inside
from workbench.views.scene_view_cloud import SceneCloud
from workbench.views.scene_view_contents import Scene


class Chooser(QObject):
    """Finds points of the scene's cloud on the screen."""

    picked = Signal(int, object)
    selected = Signal(object)

    def __init__(
        self, scene: Scene, camera: Callable[[], SceneCamera], size: Callable[[], tuple[int, int]], parent: QObject
    ) -> None:
        super().__init__(parent)
        self._scene, self._camera, self._size = scene, camera, size
        self.marked: Array | None = None
        self._search: Iterator[None] | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._look_further)

    def pick(self, at: QPointF) -> None:
        """Choose and mark the point under the cursor; `picked` tells which, if there is one."""

        def choose(index: int, point: Array) -> None:
            self.marked = point
            self.picked.emit(index, point)

        self.find(at, choose)

    def find(self, at: QPointF, found: Callable[[int, Array], None]) -> None:
        """Call `found` with number and coordinates (3,) in mm of the point under the cursor, if there is one."""
        cloud = self._cloud()
        if cloud is not None:
            self._begin(self._nearest(cloud, (at.x(), at.y()), found))

    def choose_region(self, corners: list[QPointF]) -> None:
        """Choose all points inside an outline; `selected` tells which."""
        cloud = self._cloud()
        if cloud is None:
            self.selected.emit(np.zeros(self._scene.cloud.given if self._scene.cloud else 0, dtype=bool))
        else:
            self._begin(self._inside(cloud, Outline([(corner.x(), corner.y()) for corner in corners])))

    def stop(self) -> None:
        """Forget what is on its way."""
        self._timer.stop()
        self._search = None

    def _cloud(self) -> SceneCloud | None:
        """The cloud, if it is seen or a mesh of it is."""
        return self._scene.visible_cloud or (self._scene.cloud if self._scene.visible_mesh is not None else None)

    def _begin(self, search: Iterator[None]) -> None:
        """Look at the first points now, at the others later."""
        self._search = search
        self._timer.start()
        self._look_further()

    def _look_further(self) -> None:
        search = self._search
        over = search is None or next(search, self) is self
        if over and search is self._search:  # what it found may have begun another
            self.stop()

    def _nearest(
        self, cloud: SceneCloud, at: tuple[float, float], found: Callable[[int, Array], None]
    ) -> Iterator[None]:
        points, nearest = cloud.points, Nearest(self._camera(), self._size(), at)
        for start in range(0, len(points), BATCH):
            nearest.look(points[start : start + BATCH], start)
            yield
        number = nearest.number
        if number is not None:
            found(number, points[number].copy())

    def _inside(self, cloud: SceneCloud, outline: Outline) -> Iterator[None]:
        points, camera, size = cloud.points, self._camera(), self._size()
        inside = np.zeros(len(points), dtype=bool)
        for start in range(0, len(points), BATCH):
            part = slice(start, start + BATCH)
            inside[part] = points_inside(points[part], camera, size, outline)
            yield
        self.selected.emit(inside)
