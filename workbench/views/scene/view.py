"""The 3D view: a point cloud, a mesh, planes and marks in millimetres, to look at, turn, measure on and choose from.

Everything a page needs of 3D is a method or a signal of `SceneView`; pages know nothing of VTK. Inside, `Scene` holds
what is shown and `Navigator` from where; `Drawing` decides when and how much is drawn, the canvas shows the picture
with labels and colour bar written over it by Qt, and tools turn mouse and keys into motions and choices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import QBuffer, QEvent, QIODevice, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QAction, QCloseEvent, QColor, QImage, QPainter
from PySide6.QtWidgets import QFileDialog, QWidget

from core.errors import InputError
from core.files import atomic
from core.inspect.shown.seen_from import SeenFrom
from core.inspect.shown.view_frame import CAMERA_FRAME, ViewFrame
from core.model.arrays import Array
from workbench.language import text_of, tr
from workbench.views.layouts import in_column
from workbench.views.scene.buttons import SceneButtons, ViewName
from workbench.views.scene.callouts import lay_out, paint_callouts, plate_sizes
from workbench.views.scene.camera import SceneCamera
from workbench.views.scene.canvas import Canvas, as_image, as_pixels
from workbench.views.scene.chooser import Outline, nearest_point, points_inside
from workbench.views.scene.cloud import SceneCloud, as_points
from workbench.views.scene.colours import PLAIN, Colouring, Rgb, as_colours
from workbench.views.scene.contents import (
    GRID,
    Callout,
    HiddenSide,
    Item,
    Labels,
    Lines,
    Marks,
    Measure,
    Patches,
    Scene,
    as_mesh,
    each,
)
from workbench.views.scene.drawing import Drawing
from workbench.views.scene.navigator import Navigator
from workbench.views.scene.overlay import (
    HANDLE_PX,
    NAME_ROOM,
    OverlayColours,
    bar_width,
    corner_rects,
    paint_handle,
    paint_marker,
    paint_overlay,
    place_text,
)
from workbench.views.scene.ready import Kind, readiness, reserve_opengl
from workbench.views.scene.shapes import camera_pyramid, ground_grid
from workbench.views.scene.tools import Lasso, Navigate, Pick, Polygon

__all__ = ["ColourLike", "Colouring", "SceneView", "ViewName", "prepare_3d"]

ColourLike = str | tuple[int, int, int] | QColor

PYRAMID = "#pyramid"
"""Name of the lines that show the camera."""

HIGHLIGHT_WIDER_PX = 1.5
"""Highlighted points are wider than the cloud's by so much, to be seen among them."""

HANDLE_REACH = 1.5
"""The handle is taken up to so many of its radii from its middle."""

LEAST_PX_PER_MM = 0.02
"""A handle that moves less than this over the screen is seen end-on and cannot be dragged."""


def prepare_3d() -> None:
    """Find out whether 3D can be drawn, and import its libraries, between other events.

    Returns at once. Views made earlier or later start as soon as the libraries are there.
    """
    readiness().find_out()


@dataclass(frozen=True, slots=True)
class DrawingState:
    """State of drawing the scene, for messages and tests.

    `kind` tells how ("none" before anything of OpenGL has been made), `points` are those in the cloud,
    `drawn_moving` the points and triangles in the last quick picture, `complete` means that everything is shown,
    `pass_ms` is how long the last passes took.
    """

    kind: Kind
    points: int
    drawn_moving: int
    complete: bool
    pass_ms: tuple[float, ...]


class SceneView(QWidget):
    """View of a 3D scene with its tool bar, colour bar, axes and scale.

    All coordinates are given and told in mm in the camera's frame, whatever frame is shown (`set_frame`). Arrays are
    kept, not copied: do not change them afterwards. Nothing of OpenGL is made before there is something to see in a
    view that is seen. Where nothing can be drawn in 3D, the view says so in place of the scene.
    """

    notice = Signal(str)
    """One sentence: there is no OpenGL for the window, or no 3D at all (each once), or why a picture was not saved."""

    point_picked = Signal(int, object)
    """Number of the point among those given to `set_cloud` and `add_points`, and its coordinates (3,) in mm."""

    region_selected = Signal(object)
    """Which of the cloud's points, as given, lie inside the drawn region: (N,) bool."""

    taken = Signal()
    """Enter was pressed while points are picked."""

    handle_pulled = Signal(float)
    """The handle was dragged by so many mm along its direction."""

    callout_moved = Signal(str, object)
    """Name of a callout whose plate was dragged, and how far (right, down) in pixels from its place; None: put back."""

    callout_chosen = Signal(str)
    """Name of a callout that was clicked."""

    drawing_cancelled = Signal()
    """Picking or drawing was ended by Esc or `stop_drawing`, without a result."""

    def __init__(self, parent: QWidget | None = None, *, tools: bool = True) -> None:
        super().__init__(parent)
        self._scene = Scene()
        self._message = ""
        self._axes = True
        self._frame = CAMERA_FRAME
        self._grid_mm = 0.0
        self._marked: Array | None = None
        self._handle: tuple[Array, Array] | None = None
        self._held = ""
        self._canvas = Canvas(Navigate(self), self._paint_overlay, lambda: self._margin()[0], self)
        self._canvas.setAccessibleName(tr("3D view"))
        self.setFocusProxy(self._canvas)
        self._navigator = Navigator(self._scene, lambda: self._canvas.logical_size, self._margin, self)
        self._drawing = Drawing(self._scene, lambda: self._navigator.camera, self._canvas)
        self._buttons = SceneButtons(self)
        self._buttons.setVisible(tools)
        self._column = in_column(self._buttons, (self._canvas, 1), on=self, spacing=0)
        self._buttons.view_asked.connect(self.view)
        self._buttons.fit_asked.connect(self.fit)
        self._buttons.parallel_asked.connect(self._navigator.set_parallel)
        self._buttons.grid_asked.connect(self._toggle_grid)
        self._buttons.save_asked.connect(self._ask_and_save)
        self._canvas.shown.connect(self._on_shown)
        self._canvas.hidden.connect(self._drawing.stop)
        self._canvas.resized.connect(self._on_resized)
        self._canvas.cancelled.connect(self.stop_drawing)
        self._navigator.moved.connect(self._on_moved)
        readiness().known.connect(self._on_known)
        reserve_opengl(self)
        self._show_message()

    # ---- what is shown

    def set_cloud(
        self,
        points: ArrayLike,
        *,
        values: ArrayLike | None = None,
        colouring: Colouring | None = None,
        colours: ArrayLike | ColourLike | None = None,
        normals: NDArray[np.float32] | None = None,
        keep_camera: bool = True,
    ) -> None:
        """Show a point cloud (N, 3) in mm, with values, colours or normals, in place of the earlier one.

        Parameters
        ----------
        points
            (N, 3) in mm; may be empty, to grow by `add_points`. Points that are not finite are not drawn.
        values, colouring
            (N,) one number a point, and how it is coloured. NaN is grey.
        colours
            Instead of values: (N, 3) uint8, or one colour for all.
        normals
            (N, 3) unit normals, zero where unknown, to shade the points by; None: they are not shaded.
        keep_camera
            Leave the view as it is, except when nothing was shown before.

        Raises
        ------
        ValueError
            If the shapes do not match.
        """
        colouring = colouring or Colouring()
        if colours is not None and values is None:
            if isinstance(colours, str | tuple | QColor):
                colouring = Colouring(plain_colour=_rgb(colours))
            else:
                colouring = Colouring(colours=as_colours(colours, len(np.asarray(points).reshape(-1, 3))))
        self._marked = None
        self._scene.cloud = SceneCloud(points, values, colouring, normals)
        self._changed(afresh=not keep_camera)

    def add_points(self, points: ArrayLike, values: ArrayLike | None = None) -> None:
        """Append `points` (M, 3) in mm to the cloud, with `values` (M,) if the cloud has values.

        Cheap: only new points are sent to the graphics card, at most ten times a second. `set_cloud` with empty
        arrays before says how the values are called and coloured.
        """
        if self._scene.cloud is None:
            self.set_cloud(points, values=values)
            return
        first = self._scene.empty
        self._scene.cloud.add(points, values)
        if self._scene.visible_cloud is None:
            return
        if self._navigator.follow() or first:
            self._changed()
        else:
            self._drawing.grown()

    def set_mesh(
        self,
        points: ArrayLike,
        triangles: ArrayLike,
        *,
        values: ArrayLike | None = None,
        colouring: Colouring | None = None,
        colour: ColourLike | None = None,
        keep_camera: bool = True,
    ) -> None:
        """Show a mesh: vertices (V, 3) in mm, triangles (T, 3) of vertex indices, and values (V,) if any.

        Raises
        ------
        ValueError
            If the shapes do not match or a triangle names a vertex that is not there.
        """
        how = colouring or Colouring(plain_colour=_rgb(colour) if colour is not None else PLAIN)
        self._scene.mesh = as_mesh(points, triangles, values, how) if len(np.asarray(triangles)) else None
        self._changed(afresh=not keep_camera)

    def show_cloud(self, shown: bool) -> None:
        """Show or hide the point cloud."""
        self._scene.cloud_shown = shown
        self._changed()

    def show_mesh(self, shown: bool) -> None:
        """Show or hide the mesh."""
        self._scene.mesh_shown = shown
        self._changed()

    def set_highlight(self, name: str, points: ArrayLike, colour: ColourLike) -> None:
        """Show the marks called `name` at points (N, 3) in mm, larger than the cloud's points."""
        self._put(name, Marks(as_points(points), _rgb(colour), self._drawing.point_size + HIGHLIGHT_WIDER_PX))

    def remove_highlight(self, name: str) -> None:
        """Remove the marks called `name`, if there are any."""
        self._scene.remove(name, Marks)
        self._changed()

    def set_planes(
        self,
        name: str,
        corners: Sequence[ArrayLike],
        colours: Sequence[ColourLike] | ColourLike,
        opacity: float = 0.25,
    ) -> None:
        """Show the transparent patches called `name`, corners (4, 3) in mm each; those not finite are left out."""
        patches = [as_points(patch, "corners") for patch in corners]
        shades = each(_rgbs(colours), len(patches))
        kept = [k for k, patch in enumerate(patches) if np.isfinite(patch).all()]
        self._put(name, Patches(tuple(patches[k] for k in kept), tuple(shades[k] for k in kept), opacity))

    def set_surface(self, name: str, triangles: ArrayLike, colour: ColourLike, opacity: float = 0.25) -> None:
        """Show the transparent surface called `name`, triangles (T, 3, 3) in mm."""
        corners = np.asarray(triangles, dtype=np.float64).reshape(-1, 3, 3)
        patches = np.concatenate([corners, corners[:, 2:]], axis=1)  # the last corner twice
        self._put(name, Patches(tuple(patches), each([_rgb(colour)], len(patches)), opacity))

    def set_polylines(
        self, name: str, lines: Sequence[ArrayLike], colour: ColourLike | Sequence[ColourLike], width: float = 2.0
    ) -> None:
        """Show the polylines called `name`, each (N, 3) in mm, `width` pixels wide."""
        given = [as_points(line, "lines") for line in lines]
        self._put(name, Lines(tuple(given), each(_rgbs(colour), len(given)), width))

    def set_camera_frustum(self, corners: ArrayLike | None) -> None:
        """Show the camera as a pyramid (5, 3) in mm, its centre and its picture's corners; None removes it.

        See `shapes.frustum`. The view "camera" then shows what the camera sees.
        """
        self._scene.remove(PYRAMID)
        pyramid = self._navigator.pyramid = None if corners is None else as_points(corners, "corners")
        if pyramid is not None:
            for item in camera_pyramid(pyramid, tr("camera")):
                self._scene.put(PYRAMID, item)
        self._changed()

    def set_labels(self, name: str, labels: Sequence[tuple[ArrayLike, str]], colour: ColourLike | None = None) -> None:
        """Show the texts called `name`, each at a place (3,) in mm."""
        places = as_points([np.asarray(place, dtype=np.float64) for place, _ in labels], "places")
        self._put(name, Labels(places, tuple(text for _, text in labels), None if colour is None else _rgb(colour)))

    def set_measure(self, name: str, a: ArrayLike, b: ArrayLike, text: str) -> None:
        """Show the dimension line called `name` from `a` to `b`, (3,) in mm, with a text."""
        ends = as_points([np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)], "ends")
        self._put(name, Measure(ends, text))

    def set_handle(self, handle: tuple[ArrayLike, ArrayLike] | None) -> None:
        """Show a ring at a place (3,) that can be dragged along a unit vector (3,); None removes it."""
        self._handle = None if handle is None else (np.asarray(handle[0], float), np.asarray(handle[1], float))
        self._canvas.update()

    def set_callouts(self, callouts: Sequence[Callout]) -> None:
        """Show these callouts, text plates with lines to their places, in place of earlier ones."""
        self._scene.callouts = tuple(callouts)
        self._canvas.update()

    def visible_callouts(self) -> list[tuple[Callout, QPointF, QRectF]]:
        """List the callouts that are visible, each with its place and plate in logical pixels of the canvas."""
        callouts, hidden, size = self._scene.callouts, self._scene.hidden, self._canvas.logical_size
        if not callouts:
            return []
        places = np.array([one.place for one in callouts], float)
        screen, depth = self._camera.project(places, size)
        room = QRectF(4, NAME_ROOM, size[0] - self._margin()[0] - 8, size[1] - NAME_ROOM - 4)
        sizes = plate_sizes(callouts, self.font())
        with np.errstate(invalid="ignore"):
            seen = (depth > 0) & ((screen >= 0) & (screen <= size)).all(axis=1)
        seen &= (sizes <= [room.width(), room.height()]).all(axis=1)
        seen &= True if hidden is None else ~hidden.hides(places)
        shown = np.flatnonzero(seen)
        moved = [callouts[k].moved for k in shown]
        kept = corner_rects(size) if self._axes else []
        if self._handle is not None:
            x, y = np.nan_to_num(self.screen_positions(self._handle[0][None])[0], nan=-1e6)
            kept += [QRectF(x - 2 * HANDLE_PX, y - 2 * HANDLE_PX, 4 * HANDLE_PX, 4 * HANDLE_PX)]
        plates = lay_out(screen[shown], sizes[shown], moved, room, kept)
        return [(callouts[k], QPointF(*screen[k]), plate) for k, plate in zip(shown, plates, strict=True)]

    def hide_side(self, side: tuple[ArrayLike, ArrayLike] | None) -> None:
        """Hide what lies beyond a place (3,) in mm in the direction of a unit vector (3,); None hides nothing."""
        if side is None and self._scene.hidden is None:
            return
        self._scene.hidden = None if side is None else HiddenSide(*(np.asarray(one, float) for one in side))
        self._drawing.changed()
        self._canvas.update()

    def set_axes(self, shown: bool) -> None:
        """Show or hide the axes' triad and the scale bar."""
        self._axes = shown
        self._canvas.update()

    def remove(self, name: str) -> None:
        """Remove all planes, lines, labels, measures and marks called `name`."""
        self._scene.remove(name)
        self._changed()

    def clear(self, message: str = "") -> None:
        """Remove everything from the view, and show a message in it."""
        self.stop_drawing()
        self._marked = None
        self._scene.clear()
        self._message = message
        self._navigator.forget()
        self._changed()

    # ---- from where it is seen

    def view(self, name: ViewName) -> None:
        """Look at the scene from the standard direction called `name`, and fit it."""
        self._navigator.view(name)

    def fit(self) -> None:
        """Move the camera, in its present direction, so that the whole scene is seen."""
        self._navigator.fit()

    def set_parallel(self, parallel: bool) -> None:
        """Set parallel projection, in which lengths can be compared, or, with False, perspective."""
        self._buttons.parallel.setChecked(parallel)

    def set_frame(self, frame: ViewFrame) -> None:
        """Set the frame that standard views, turning, axes, grid and coordinates refer to.

        In the camera's own, up is towards the camera and north is up in the camera's picture. What is given to the view
        and what it tells stays in the camera's frame.
        """
        if not frame.same_as(self._frame):
            self._frame = frame
            self._navigator.set_frame(frame)
            self._changed()

    @property
    def frame(self) -> ViewFrame:
        """Frame that standard views, axes, grid and coordinates refer to."""
        return self._frame

    def screen_positions(self, points: ArrayLike) -> Array:
        """Project points (N, 3) in mm to the canvas: (N, 2) in logical px; NaN behind the viewer."""
        return self._camera.project(as_points(points), self._canvas.logical_size)[0]

    # ---- choosing

    def add_tool(self, text: str, key: str, symbol: str) -> QAction:
        """Add a checkable button with a key and an icon to the view's tool bar, and return its action."""
        return self._buttons.add_tool(text, key, symbol)

    def start_picking(self) -> None:
        """Start picking: a click on the cloud emits `point_picked`, Enter emits `taken`, Esc ends it.

        Dragging still turns the view.
        """
        self._start(Pick(self))

    def set_hint(self, hint: str) -> None:
        """Show over the view what the tool does, in place of the tool's own words; one line or two."""
        self._canvas.tool.hint = hint
        self._canvas.update()

    def start_polygon(self) -> None:
        """Start drawing a region by clicks at its corners; a double click or Enter closes it, Esc cancels."""
        self._start(Polygon(self))

    def start_lasso(self) -> None:
        """Start drawing a region by one stroke round it, the button held down; Esc cancels."""
        self._start(Lasso(self))

    def stop_drawing(self) -> None:
        """End picking, or drawing without a region."""
        if type(self._canvas.tool) is not Navigate:
            self._canvas.set_tool(Navigate(self))
            self._marked = None
            self.drawing_cancelled.emit()

    # ---- pictures

    def picture(self) -> NDArray[np.uint8]:
        """Wait until everything is drawn, and return the view with its labels and colour bar: (h, w, 3), uint8."""
        pixels = self._drawing.whole_picture()
        if pixels is None:  # nothing to see, or no 3D here
            image = QImage(*self._canvas.device_size, QImage.Format.Format_RGB32)
            image.fill(OverlayColours.of(self.palette()).ground)
        else:
            image = as_image(pixels).convertToFormat(QImage.Format.Format_RGB32)
        width, height = self._canvas.logical_size
        painter = QPainter(image)
        if self._canvas.edges is not None:
            painter.drawImage(image.rect(), self._canvas.edges)
        painter.scale(image.width() / width, image.height() / height)
        self._paint_overlay(painter)
        painter.end()
        return as_pixels(image)

    def seen_from(self) -> SeenFrom | None:
        """Return the view that the user has chosen; None if it is still the first one."""
        if self._scene.empty or not self._navigator.is_turned_by_hand:
            return None
        camera, (width, height), hidden = self._camera, self._canvas.logical_size, self._scene.hidden
        beyond = None if hidden is None else np.array([hidden.place, hidden.towards])
        return SeenFrom(camera.axes, camera.focal, camera.half_height, width / height, beyond)

    def is_put_back(self) -> bool:
        """Whether the user has chosen a view and then returned to the first one."""
        return not self._scene.empty and self._navigator.is_put_back

    def save_picture(self, path: Path) -> None:
        """Write a picture of the view to a PNG file; InputError if the file cannot be written."""
        buffer = QBuffer()
        buffer.open(QIODevice.OpenModeFlag.WriteOnly)
        as_image(self.picture()).save(buffer, "PNG")  # type: ignore[call-overload]
        atomic.write_bytes(path, bytes(buffer.data().data()))

    def state(self) -> DrawingState:
        """Return how far the scene is drawn, for messages and tests."""
        drawing, cloud = self._drawing, self._scene.cloud
        return DrawingState(
            kind=drawing.kind,
            points=cloud.given if cloud is not None else 0,
            drawn_moving=drawing.moving_elements,
            complete=drawing.complete,
            pass_ms=tuple(drawing.pass_ms),
        )

    # ---- what tools do (`ViewControl`)

    def orbit(self, dx: float, dy: float) -> None:
        """Turn the view by a drag of (dx, dy) pixels."""
        self._navigator.orbit(dx, dy)

    def pan(self, dx: float, dy: float) -> None:
        """Move the view by a drag of (dx, dy) pixels."""
        self._navigator.pan(dx, dy)

    def zoom(self, factor: float, at: QPointF | None = None) -> None:
        """Move nearer by `factor`, towards the screen point `at`, or, for None, the middle."""
        self._navigator.zoom(factor, at)

    def grasp(self, at: QPointF) -> bool:
        """Hold the handle or callout at the screen point `at`; False if there is none."""
        callout = None if self._handle_under(at) else self._callout_under(at)
        self._held = "" if callout is None else callout.name
        return callout is not None or self._handle_under(at)

    def pull(self, dx: float, dy: float) -> None:
        """Move the held callout by a drag of (dx, dy) pixels; of a handle, emit how far it is pulled in mm."""
        if self._held:
            self._pull_callout(dx, dy)
        elif self._handle is not None:
            along = self._handle_on_screen()
            squared = float(along @ along)
            if squared > LEAST_PX_PER_MM**2:
                self.handle_pulled.emit(float(along @ [dx, dy]) / squared)

    def drop(self) -> None:
        """Release the handle or callout that is held, and emit where a callout is now."""
        for one in self._scene.callouts:
            if self._held and one.name == self._held:
                self.callout_moved.emit(one.name, one.moved)
        self._held = ""

    def point_at(self, at: QPointF) -> None:
        """Show by the cursor whether what is at the screen point `at` can be dragged."""
        held = self._handle_under(at) or self._callout_under(at) is not None
        self._canvas.setCursor(Qt.CursorShape.OpenHandCursor if held else self._canvas.tool.cursor)

    def choose(self, at: QPointF) -> None:
        """Emit that the callout at the screen point `at` was clicked, if there is one."""
        callout = self._callout_under(at)
        if callout is not None:
            self.callout_chosen.emit(callout.name)

    def pick(self, at: QPointF) -> None:
        """Choose the point of the cloud at the screen point `at`, mark it and emit it."""
        number, points = self._under(at), self._points_seen()
        if number is not None:
            self._marked = points[number].copy()
            self._canvas.update()
            self.point_picked.emit(number, self._marked)

    def take(self) -> None:
        """Emit that Enter was pressed, and remove the mark of the point picked last."""
        self._marked = None
        self._canvas.update()
        self.taken.emit()

    def centre_on(self, at: QPointF) -> None:
        """Turn the view from now on about the point at the screen point `at`; a callout there is put back."""
        callout = self._callout_under(at)
        if callout is not None:
            self._move_callout(callout.name, None)
            self.callout_moved.emit(callout.name, None)
            return
        number = self._under(at)
        if number is not None:
            self._navigator.centre_on(self._points_seen()[number])

    def look_at(self, point: Array) -> None:
        """Move the view so that `point` (3,) in mm is in the middle, about which it then turns."""
        self._navigator.centre_on(point)

    def choose_region(self, corners: list[QPointF]) -> None:
        """Emit which points of the cloud are seen inside a drawn outline."""
        inside = np.zeros(self._scene.cloud.given if self._scene.cloud is not None else 0, dtype=bool)
        points = self._points_seen()
        if len(points):
            outline = Outline([(corner.x(), corner.y()) for corner in corners])
            inside = points_inside(points, self._camera, self._canvas.logical_size, outline)
        self._canvas.set_tool(Navigate(self))
        self.region_selected.emit(inside)

    def repaint_tool(self) -> None:
        """Paint again what the tool draws over the scene."""
        self._canvas.update()

    # ---- Qt

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.PaletteChange, QEvent.Type.StyleChange):
            self._buttons.dress()
            self._on_moved()

    def closeEvent(self, event: QCloseEvent) -> None:
        self._drawing.finish()
        super().closeEvent(event)

    # ---- inside

    def _handle_under(self, at: QPointF) -> bool:
        if self._handle is None:
            return False
        x, y = self.screen_positions(self._handle[0][None])[0]
        return float(np.hypot(at.x() - x, at.y() - y)) <= HANDLE_REACH * HANDLE_PX

    def _callout_under(self, at: QPointF) -> Callout | None:
        return next((one for one, _, plate in reversed(self.visible_callouts()) if plate.contains(at)), None)

    def _pull_callout(self, dx: float, dy: float) -> None:
        for one, place, plate in self.visible_callouts():
            if one.name == self._held:
                to = plate.center() - place + QPointF(dx, dy)
                self._move_callout(one.name, (to.x(), to.y()))

    def _move_callout(self, name: str, to: tuple[float, float] | None) -> None:
        self.set_callouts([replace(one, moved=to) if one.name == name else one for one in self._scene.callouts])

    def _handle_on_screen(self) -> Array:
        """How the handle goes over the screen: (2,) in pixels for one mm."""
        assert self._handle is not None
        place, direction = self._handle
        ends: Array = np.diff(self.screen_positions([place - direction / 2, place + direction / 2]), axis=0)[0]
        return ends

    @property
    def _camera(self) -> SceneCamera:
        return self._navigator.camera

    def _put(self, name: str, item: Item) -> None:
        self._scene.put(name, item)
        self._changed()

    def _changed(self, *, afresh: bool = False) -> None:
        """Something else is to be seen; `afresh`: fit it."""
        self._lay_grid()
        self._navigator.follow(afresh=afresh)
        self._show_message()
        self._drawing.changed()
        self._canvas.update()

    def _toggle_grid(self) -> None:
        self._lay_grid()
        self._navigator.resized()
        self._drawing.changed()

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
        self._show_message()
        if not self._drawing.complete:
            self._drawing.moved()

    def _on_resized(self) -> None:
        if self._canvas.geometry().bottom() != self.rect().bottom():
            # What is around was laid out anew while this was being laid out, as Qt does when the tool bar's button for
            # what it has no room for comes up: the canvas has the height of before, and would keep it.
            self._column.invalidate()
        self._navigator.resized()
        self._drawing.moved()

    def _on_moved(self) -> None:
        self._drawing.moved()
        self._canvas.update()

    def _on_known(self) -> None:
        """It is known now whether there is 3D."""
        self._show_message()
        self._drawing.changed()

    def _start(self, tool: Navigate) -> None:
        self.stop_drawing()
        self._canvas.set_tool(tool)
        self._canvas.setFocus()

    def _points_seen(self) -> Array:
        """Points (N, 3) of the cloud, if it is seen or a mesh of it is; else none."""
        seen = self._scene.visible_cloud or (self._scene.cloud if self._scene.visible_mesh is not None else None)
        points = seen.points if seen is not None else np.empty((0, 3))
        hidden = self._scene.hidden
        return points if hidden is None else np.where(hidden.hides(points)[:, None], np.nan, points)

    def _under(self, at: QPointF) -> int | None:
        """Number of the cloud's point under the cursor."""
        return nearest_point(self._points_seen(), self._camera, self._canvas.logical_size, (at.x(), at.y()))

    def _show_message(self) -> None:
        """What stands in the place of the scene, if anything."""
        kind, message = readiness().kind, None
        no_3d = tr("This computer cannot draw in 3D (no OpenGL). Everything else works as usual.")
        if self._scene.empty:
            message = self._message
        elif kind is None:
            message = tr("Preparing the 3D view …")
        elif kind == "none":
            message = no_3d
        self._canvas.show_message(message)
        if (
            kind in ("pictures", "none")
            and not self._scene.empty
            and self.isVisible()
            and kind not in readiness().notified
        ):
            readiness().notified |= {kind}
            pictures = tr(
                "This computer offers no OpenGL to the window: the 3D view shows rendered pictures of the scene. "
                "Everything works as usual, turning may be slower."
            )
            self.notice.emit(pictures if kind == "pictures" else no_3d)

    def _margin(self) -> tuple[int, int]:
        return bar_width(self._scene.colouring, self.font()), 0

    def _paint_overlay(self, painter: QPainter) -> None:
        colours, size = OverlayColours.of(self.palette()), self._canvas.logical_size
        painter.setFont(self.font())
        axes = self._frame if self._axes else None
        paint_overlay(painter, self._scene, self._camera, size, colours, axes=axes, grid_mm=self._grid_mm)
        paint_callouts(painter, self.visible_callouts(), colours)
        if self._handle is not None:
            at, along = self.screen_positions(self._handle[0][None])[0], self._handle_on_screen()
            length = float(np.hypot(*along))
            if np.isfinite([*at, length]).all() and length > LEAST_PX_PER_MM:
                paint_handle(painter, QPointF(*at), QPointF(*(along / length)), colours)
        if self._marked is not None:
            x, y = self._camera.project(self._marked, size)[0][0]
            if np.isfinite([x, y]).all():
                place = place_text(self._frame.coordinates(self._marked))
                paint_marker(painter, QPointF(float(x), float(y)), place, colours)

    def _ask_and_save(self) -> None:
        """Ask for a place, and write the picture there."""
        name, _ = QFileDialog.getSaveFileName(self, tr("Save this picture"), "scene.png", tr("Pictures (*.png)"))
        if not name:
            return
        try:
            self.save_picture(Path(name).with_suffix(".png"))
        except InputError as error:
            self.notice.emit(text_of(error))


def _rgb(colour: ColourLike) -> Rgb:
    """Any way of saying a colour, as three numbers.

    Raises
    ------
    ValueError
        If there is no such colour.
    """
    shade = QColor(*colour) if isinstance(colour, tuple) else QColor(colour)
    if not shade.isValid():
        raise ValueError(f"{colour!r} is no colour")
    return shade.red(), shade.green(), shade.blue()


def _rgbs(colours: ColourLike | Sequence[ColourLike]) -> list[Rgb]:
    """One colour or several."""
    if isinstance(colours, str | QColor):
        return [_rgb(colours)]
    if isinstance(colours, tuple) and len(colours) == 3 and all(isinstance(c, int) for c in colours):
        return [_rgb(colours)]  # type: ignore[arg-type]
    return [_rgb(colour) for colour in colours]  # type: ignore[arg-type]
