"""Where the scene is looked at from, and how mouse, keys and buttons change it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QObject, QPointF, Signal

from core.inspect.shown.view_frame import ViewFrame
from core.model.arrays import Array
from workbench.views.scene.camera import FROM_CAMERA, VIEW_ANGLE, Orientation, SceneCamera, from_origin
from workbench.views.scene.contents import Scene

GROWN = 1.15
"""A scene that has grown by this factor is fitted again, as long as the view has not been turned by hand."""

ROOM, OUTSIDE = 1.12, 0.01
"""How much farther away a growing scene is looked at from, and which part of it may be out of sight."""

CLOSEST, FARTHEST = 0.01, 1e7
"""Distances in mm between which one can zoom."""


class Navigator(QObject):
    """Camera of one view and its motions.

    Parameters
    ----------
    size, margin
        Give the size of the view in logical pixels, and what to leave free at the right and at the lower edge.
    """

    moved = Signal()

    def __init__(
        self,
        scene: Scene,
        size: Callable[[], tuple[int, int]],
        margin: Callable[[], tuple[int, int]],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._scene, self._size, self._margin = scene, size, margin
        self.pyramid: Array | None = None
        """Corners (5, 3) of the measuring camera's pyramid, if it is known."""
        self.orientation = FROM_CAMERA
        self._name = "iso"
        self._touched = False
        self._ever_turned = False
        """Whether the user has chosen a view of this scene, whatever it is seen from now."""
        self._extent, self._box = 0.0, np.empty((0, 3))
        self.camera = SceneCamera.looking(*FROM_CAMERA.direction("iso"), np.zeros(3), 500.0)

    @property
    def is_turned_by_hand(self) -> bool:
        """Whether the user has chosen the view, which then is not fitted automatically."""
        first, _ = self.orientation.direction("iso")
        return self._touched or self._name != "iso" or not np.allclose(self.camera.axes[2], first)

    @property
    def is_put_back(self) -> bool:
        """Whether the user has chosen a view and then returned to the first one."""
        return self._ever_turned and not self.is_turned_by_hand

    def view(self, name: str) -> None:
        """Look at the scene from the standard direction called `name`, and fit it."""
        self._name, self._touched = name, False
        self._ever_turned = self._ever_turned or name != "iso"
        points = self._scene.to_fit()
        if name == "camera":
            seen = from_origin(points, self._size(), self.pyramid)
        else:
            back, up = self.orientation.direction(name)
            seen = SceneCamera.looking(back, up, self.camera.focal, self.camera.distance)
            seen = replace(seen, view_angle=VIEW_ANGLE)
        self.camera = replace(seen, parallel=self.camera.parallel)
        if name == "camera" and not self.camera.parallel:
            self._extent = _extent(points)
            self.moved.emit()
        else:
            self.fit()

    def fit(self) -> None:
        """Move the camera, in its present direction, so that the whole scene is seen."""
        self._touched = False
        points = self._scene.to_fit()
        self._extent = _extent(points)
        self.camera = self.camera.fitted(points, self._size(), self._margin())
        self.moved.emit()

    def follow(self, *, afresh: bool = False) -> bool:
        """Fit a scene that is new or has grown, unless the user chose the view; return whether the camera moved."""
        box = self._scene.box()
        before, self._box = self._box, box
        if not afresh and self._extent > 0 and (self._touched or np.array_equal(box, before)):
            return False  # a cloud that grows within its box many times a second
        points = self._scene.to_fit()
        extent = _extent(points)
        if extent == 0:
            return False
        outgrown = not self._touched and (extent > GROWN * self._extent or self._leaves_view(points))
        if afresh or self._extent == 0 or outgrown:
            # One that is growing gets room, or it would have to be fitted again and again.
            self._fit_or_view(1.0 if afresh or self._extent == 0 else ROOM)
            return True
        return False

    def _leaves_view(self, points: Array) -> bool:
        """Whether some of the points (N, 3) are outside."""
        screen, _ = self.camera.project(points, self._size())
        return bool(((screen < 0) | (screen > np.array(self._size()))).any(axis=1).mean() > OUTSIDE)

    def resized(self) -> None:
        """Fit the scene to the view's new size, unless the user chose the view."""
        if not self._touched and self._extent > 0:
            self._fit_or_view()

    def forget(self) -> None:
        """Reset the camera, as the scene is empty; the next scene is seen from a corner."""
        self._extent, self._touched, self._name, self.pyramid = 0.0, False, "iso", None
        self._ever_turned = False

    def set_frame(self, frame: ViewFrame) -> None:
        """Set which directions are up and north by a view frame, and turn the view with them."""
        before, self.orientation = self.orientation, Orientation.of(frame)
        if self._touched:
            self._move(self.camera.turned(before, self.orientation))
        else:
            self.view(self._name)

    def set_parallel(self, parallel: bool) -> None:
        """Set parallel projection, or, with False, perspective."""
        self.camera = replace(self.camera, parallel=parallel)
        self.moved.emit()

    def orbit(self, dx: float, dy: float) -> None:
        """Turn the view by a drag of (dx, dy) pixels."""
        self._move(self.camera.orbited(dx, dy, self.orientation.up))

    def pan(self, dx: float, dy: float) -> None:
        """Move the view by a drag of (dx, dy) pixels."""
        self._move(self.camera.panned(dx, dy, self._size()))

    def zoom(self, factor: float, at: QPointF | None) -> None:
        """Move nearer by `factor`, towards the screen point `at`, or, for None, the middle."""
        width, height = self._size()
        place = (at.x(), at.y()) if at is not None else (width / 2, height / 2)
        factor = float(np.clip(factor, self.camera.distance / FARTHEST, self.camera.distance / CLOSEST))
        self._move(self.camera.zoomed(factor, place, (width, height)))

    def centre_on(self, point: Array) -> None:
        """Move the view so that `point` (3,) in mm is in the middle, about which it then turns."""
        self._move(replace(self.camera, focal=np.asarray(point, dtype=np.float64)))

    def _fit_or_view(self, room: float = 1.0) -> None:
        if self._touched:
            self.fit()
        else:
            self.view(self._name)
        if room > 1 and self._name != "camera":
            self.camera = replace(self.camera, distance=self.camera.distance * room)

    def _move(self, camera: SceneCamera) -> None:
        self.camera, self._touched, self._ever_turned = camera, True, True
        self.moved.emit()


def _extent(points: Array) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0))) + 1e-9 if len(points) else 0.0
