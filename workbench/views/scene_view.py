"""The 3D view: a point cloud, a mesh, planes and marks in millimetres, to look at, turn, measure on and choose from.

Everything a page needs of 3D is a method or a signal of `SceneView`; pages know nothing of VTK.

Inside, `Scene` holds what is shown and `Navigator` from where; a surface draws it (`scene_view_choice` says which),
`ScenePace` decides when and how much, Qt writes labels and colour bar over it, and tools turn mouse and keys into
motions and choices.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import QEvent, QPointF, Signal
from PySide6.QtGui import QCloseEvent, QPainter
from PySide6.QtWidgets import QVBoxLayout, QWidget

from core.model.arrays import Array
from workbench.views import scene_view_choice as choice
from workbench.views.scene_view_backing import Backing
from workbench.views.scene_view_buttons import SceneButtons
from workbench.views.scene_view_canvas import Canvas, Overlay
from workbench.views.scene_view_chooser import Chooser
from workbench.views.scene_view_contents import GRID, Scene, as_points
from workbench.views.scene_view_grid import ground_grid
from workbench.views.scene_view_navigator import Navigator
from workbench.views.scene_view_overlay import Look, bar_width, paint_marker, paint_overlay, place_text
from workbench.views.scene_view_shown import ColourLike, ColourMap, SceneShown
from workbench.views.scene_view_snapshot import Snapshot
from workbench.views.scene_view_tools import Lasso, Navigate, Pick, Polygon

__all__ = ["ColourLike", "ColourMap", "SceneView", "ViewName", "warm_up"]

ViewName = Literal["front", "back", "left", "right", "top", "bottom", "iso", "camera"]


def warm_up() -> None:
    """Import the 3D libraries in the background; call it in the GUI thread when the program is idle.

    Returns at once. Views made earlier or later start as soon as the libraries are there.
    """
    choice.warm_up()


class SceneView(SceneShown):
    """A 3D scene with its tool bar, colour bar, axes and scale.

    All coordinates are in mm, in the camera's frame unless `set_orientation` says which way is up. Arrays are kept,
    not copied: do not change them afterwards. Nothing of OpenGL is made before there is something to see in a view
    that is seen.
    """

    notice = Signal(str)
    """One sentence, once, when pictures are shown because there is no OpenGL for the window."""

    point_picked = Signal(int, object)
    """Number of the point among those given to `set_cloud` and `add_points`, and its coordinates (3,) in mm."""

    region_selected = Signal(object)
    """Which of the cloud's points, as given, lie inside the drawn region: (N,) bool."""

    drawing_cancelled = Signal()
    """Picking or drawing was ended by Esc or `stop_drawing`, without a result."""

    def __init__(self, parent: QWidget | None = None, *, tools: bool = True) -> None:
        super().__init__(parent)
        self._scene = Scene()
        self._pyramid: Array | None = None
        self._message = ""
        self._axes = True
        self._grid_mm = 0.0
        self._point_size = 2.0
        self._canvas = Canvas(self)
        self._navigator = Navigator(self._scene, self._size, self._margin, lambda: self._pyramid, self)
        self._chooser = Chooser(self._scene, lambda: self._navigator.camera, self._size, self)
        self._backing = Backing(self._scene, self._canvas, lambda: self._navigator.camera, self)
        self._snapshot = Snapshot(
            self._scene, self._backing, lambda: self._navigator.camera, self._size, self._paint_overlay, self
        )
        self._overlay = Overlay(self._canvas, Navigate(self), self._paint_overlay)
        self._canvas.put_above(self._overlay)
        self._overlay.setAccessibleName(self.tr("3D view"))
        self.setFocusProxy(self._overlay)
        self._buttons = SceneButtons(self)
        self._buttons.setVisible(tools)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.setSpacing(0)
        rows.addWidget(self._buttons)
        rows.addWidget(self._canvas, 1)
        self._connect()
        choice.reserve_opengl(self)
        self._show_message()

    def _connect(self) -> None:
        self._buttons.view_asked.connect(self.view)
        self._buttons.fit_asked.connect(self.fit)
        self._buttons.parallel_asked.connect(self._navigator.set_parallel)
        self._buttons.grid_asked.connect(self._toggle_grid)
        self._buttons.save_asked.connect(self._snapshot.ask_and_save)
        self._canvas.shown.connect(self._on_shown)
        self._canvas.hidden.connect(self._on_hidden)
        self._canvas.resized.connect(self._navigator.resized)
        self._navigator.moved.connect(self._on_moved)
        self._chooser.picked.connect(self.repaint_tool)
        self._chooser.picked.connect(self.point_picked)
        self._chooser.selected.connect(self._on_selected)
        self._overlay.cancelled.connect(self.stop_drawing)
        self._backing.notice.connect(self.notice)
        self._snapshot.failed.connect(self.notice)
        self._backing.presented.connect(self._overlay.update)
        self._backing.waiting.connect(self._show_message)

    # ---- from where it is seen

    def view(self, name: ViewName) -> None:
        """Look from a standard direction and fit."""
        self._navigator.view(name)

    def fit(self) -> None:
        """Keep the direction, show everything."""
        self._navigator.fit()

    def set_parallel(self, parallel: bool) -> None:
        """Parallel projection, in which lengths can be compared, or perspective."""
        self._buttons.parallel.setChecked(parallel)

    def screen_positions(self, points: ArrayLike) -> Array:
        """Where points (N, 3) are in this view: (N, 2) in logical pixels of its canvas; NaN behind the viewer."""
        return self._navigator.camera.project(as_points(points), self._size())[0]

    # ---- choosing

    def start_picking(self) -> None:
        """Every click on the cloud gives `point_picked` until Esc or `stop_drawing`; dragging still turns the view."""
        self._start(Pick(self))

    def start_polygon(self) -> None:
        """Let the user click the corners of a region; a double click or Enter closes it, Esc cancels."""
        self._start(Polygon(self))

    def start_lasso(self) -> None:
        """Let the user draw round a region with the button held down; Esc cancels."""
        self._start(Lasso(self))

    def stop_drawing(self) -> None:
        """End picking or drawing without a result."""
        if type(self._overlay.tool) is not Navigate:
            self._overlay.set_tool(Navigate(self))
            self._chooser.stop()
            self._chooser.marked = None
            self.drawing_cancelled.emit()

    # ---- pictures

    def picture(self) -> NDArray[np.uint8]:
        """What is shown, whole, with colour bar and labels: (h, w, 3). Waits until everything is drawn."""
        return self._snapshot.picture()

    def save_picture(self, path: Path) -> None:
        """Write the picture as PNG; InputError if the file cannot be written."""
        self._snapshot.save(path)

    def state(self) -> dict[str, Any]:
        """How the scene is drawn, for messages and tests.

        `kind` of surface ("none" before the first is made), `points` in the cloud, `drawn_moving` points and triangles
        in the last quick picture, `complete` when everything is shown, `pass_ms` of the last passes.
        """
        pace, surface = self._backing.pace, self._backing.surface
        return {
            "kind": surface.kind if surface is not None else "none",
            "points": self._scene.cloud.given if self._scene.cloud is not None else 0,
            "drawn_moving": pace.moving_elements if pace is not None else 0,
            "complete": pace is not None and pace.complete,
            "pass_ms": list(pace.pass_ms) if pace is not None else [],
        }

    # ---- what tools do (`Hands`)

    def orbit(self, dx: float, dy: float) -> None:
        """Turn by a drag in pixels."""
        self._navigator.orbit(dx, dy)

    def pan(self, dx: float, dy: float) -> None:
        """Move by a drag in pixels."""
        self._navigator.pan(dx, dy)

    def zoom(self, factor: float, at: QPointF | None = None) -> None:
        """Nearer by a factor, towards a point of the screen or its middle."""
        self._navigator.zoom(factor, at)

    def pick(self, at: QPointF) -> None:
        """Choose the point of the cloud under the cursor."""
        self._chooser.pick(at)

    def centre_on(self, at: QPointF) -> None:
        """Turn about the point under the cursor from now on."""
        self._chooser.find(at, lambda _, point: self._navigator.centre_on(point))

    def choose_region(self, corners: list[QPointF]) -> None:
        """Choose the points of the cloud inside an outline."""
        self._chooser.choose_region(corners)
        self._overlay.set_tool(Navigate(self))

    def repaint_tool(self) -> None:
        """Paint the tool again."""
        self._overlay.update()

    # ---- Qt

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.PaletteChange, QEvent.Type.StyleChange) and hasattr(self, "_buttons"):
            self._buttons.dress()
            self._backing.dress()
            self._overlay.update()

    def closeEvent(self, event: QCloseEvent) -> None:
        self._chooser.stop()
        self._backing.finish()
        super().closeEvent(event)

    # ---- inside

    def _changed(self, *, afresh: bool = False) -> None:
        """Something else is to be seen."""
        self._lay_grid()
        self._navigator.follow(afresh=afresh)
        self._show_message()
        self._backing.ensure()
        if self._backing.pace is not None:
            self._backing.pace.changed()
        self._overlay.update()

    def _toggle_grid(self) -> None:
        self._lay_grid()
        self._navigator.resized()
        if self._backing.pace is not None:
            self._backing.pace.changed()
        self._overlay.update()

    def _lay_grid(self) -> None:
        """Lay the grid under what there is now."""
        self._scene.remove(GRID)
        self._grid_mm = 0.0
        points = self._scene.to_fit() if self._buttons.grid.isChecked() else np.empty((0, 3))
        if len(points):
            lines, self._grid_mm = ground_grid(points, self._navigator.orientation)
            self._scene.put(GRID, lines)

    def _on_shown(self) -> None:
        self._navigator.resized()
        self._backing.ensure()
        if self._backing.pace is not None and not self._backing.pace.complete:
            self._backing.pace.moved()

    def _on_hidden(self) -> None:
        self._chooser.stop()
        self._backing.rest()

    def _on_moved(self) -> None:
        if self._backing.pace is not None:
            self._backing.pace.moved()
        self._overlay.update()

    def _on_selected(self, inside: NDArray[np.bool_]) -> None:
        self.region_selected.emit(inside)

    def _start(self, tool: Navigate) -> None:
        self.stop_drawing()
        self._overlay.set_tool(tool)
        self._overlay.setFocus()

    def _show_message(self, waiting: bool = False) -> None:
        message: str | None = None
        if self._scene.empty:
            message = self._message
        elif waiting:
            message = self.tr("Preparing the 3D view …")
        self._overlay.show_message(message)

    def _size(self) -> tuple[int, int]:
        return max(self._canvas.width(), 2), max(self._canvas.height(), 2)

    def _margin(self) -> tuple[int, int]:
        return bar_width(self._scene.colouring, self.font()), 0

    def _paint_overlay(self, painter: QPainter) -> None:
        look, camera, size = Look.of(self.palette()), self._navigator.camera, self._size()
        painter.setFont(self.font())
        paint_overlay(painter, self._scene, camera, size, look, axes=self._axes, grid_mm=self._grid_mm)
        if self._chooser.marked is not None:
            x, y = camera.project(self._chooser.marked, size)[0][0]
            if np.isfinite([x, y]).all():
                paint_marker(painter, QPointF(float(x), float(y)), place_text(self._chooser.marked), look)
