"""What the 3D view shows: the part of its interface that takes clouds, meshes, planes, lines and texts."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QWidget

from core.model.arrays import Array
from workbench.views.scene_view_backing import Backing
from workbench.views.scene_view_buttons import SceneButtons
from workbench.views.scene_view_chooser import Chooser
from workbench.views.scene_view_cloud import SceneCloud
from workbench.views.scene_view_colours import PLAIN, Colouring, Rgb, as_colours
from workbench.views.scene_view_contents import Labels, Lines, Marks, Measure, Patches, Scene, as_mesh, as_points, each
from workbench.views.scene_view_grid import camera_pyramid
from workbench.views.scene_view_navigator import Navigator

ColourLike = str | tuple[int, int, int] | QColor
ColourMap = Literal["viridis", "plasma", "deviation"]

PYRAMID = "#pyramid"
"""Name of the lines that show the camera."""

HIGHLIGHT_WIDER = 1.5
"""Highlighted points are wider than the cloud's by so many pixels."""


class SceneShown(QWidget):
    """Takes what is to be shown, checks it, and puts it into the scene; `SceneView` does the rest."""

    _scene: Scene
    _navigator: Navigator
    _chooser: Chooser
    _backing: Backing
    _buttons: SceneButtons
    _pyramid: Array | None
    _point_size: float
    _message: str
    _axes: bool

    @abstractmethod
    def _changed(self, *, afresh: bool = False) -> None:
        """Something else is to be seen; `afresh`: fit it."""

    @abstractmethod
    def repaint_tool(self) -> None:
        """Paint what lies over the scene again."""

    @abstractmethod
    def stop_drawing(self) -> None:
        """End picking or drawing without a result."""

    def set_cloud(
        self,
        points: ArrayLike,
        *,
        values: ArrayLike | None = None,
        value_name: str = "",
        unit: str = "",
        limits: tuple[float, float] | None = None,
        colour_map: ColourMap = "viridis",
        colours: ArrayLike | ColourLike | None = None,
        keep_camera: bool = True,
    ) -> None:
        """Show a cloud instead of the one before.

        Parameters
        ----------
        points
            (N, 3) in mm; may be empty, to grow by `add_points`. Points that are not finite are not drawn.
        values, value_name, unit
            (N,) one number a point, coloured by the colour map; name and unit stand over the colour bar. NaN is grey.
        limits
            Values at the ends of the colour bar; without them 1 % and 99 % of the values.
        colour_map
            "viridis" and "plasma" run from low to high, "deviation" is blue below, red above the middle.
        colours
            Instead of values: (N, 3) uint8, or one colour for all.
        keep_camera
            Leave the view as it is, except when nothing was shown before.

        Raises
        ------
        ValueError
            If the shapes do not match.
        """
        colouring = Colouring(value_name, unit, limits, colour_map)
        if colours is not None and values is None:
            count = len(np.asarray(points).reshape(-1, 3))
            one = isinstance(colours, str | tuple | QColor)
            colouring = (
                Colouring(plain_colour=_rgb(colours))  # type: ignore[arg-type]
                if one
                else Colouring(colours=as_colours(colours, count))  # type: ignore[arg-type]
            )
        self._chooser.stop()
        self._chooser.marked = None
        self._scene.cloud = SceneCloud(points, values, colouring)
        self._changed(afresh=not keep_camera)

    def add_points(self, points: ArrayLike, values: ArrayLike | None = None) -> None:
        """Let the cloud grow by `points` (M, 3) in mm with `values` (M,) if it has values.

        Cheap: only new points are sent to the graphics card, at most ten times a second. `set_cloud` with empty
        arrays before says how the values are called and coloured.
        """
        if self._scene.cloud is None:
            self.set_cloud(points, values=values)
            return
        first = self._scene.empty
        self._scene.cloud.add(points, values)
        if not self._scene.cloud_shown or self._scene.cloud.drawn == 0:
            return
        if self._navigator.follow() or first or self._backing.pace is None:
            self._changed()
        else:
            self._backing.pace.grown()

    def set_mesh(
        self,
        points: ArrayLike,
        triangles: ArrayLike,
        *,
        values: ArrayLike | None = None,
        value_name: str = "",
        unit: str = "",
        limits: tuple[float, float] | None = None,
        colour_map: ColourMap = "viridis",
        colour: ColourLike | None = None,
        keep_camera: bool = True,
    ) -> None:
        """Show a surface: vertices (V, 3) in mm, triangles (T, 3) of vertex numbers, values (V,) as in `set_cloud`.

        Raises
        ------
        ValueError
            If the shapes do not match or a triangle names a vertex that is not there.
        """
        plain = _rgb(colour) if colour is not None else PLAIN
        colouring = Colouring(value_name, unit, limits, colour_map, plain_colour=plain)
        self._scene.mesh = as_mesh(points, triangles, values, colouring) if len(np.asarray(triangles)) else None
        self._changed(afresh=not keep_camera)

    def show_cloud(self, shown: bool) -> None:
        """Show or hide the cloud."""
        self._scene.cloud_shown = shown
        self._changed()

    def show_mesh(self, shown: bool) -> None:
        """Show or hide the mesh."""
        self._scene.mesh_shown = shown
        self._changed()

    def set_highlight(self, name: str, points: ArrayLike, colour: ColourLike) -> None:
        """Mark points (N, 3) in one colour, drawn larger than the cloud's."""
        self._put(name, Marks(as_points(points), _rgb(colour), self._point_size + HIGHLIGHT_WIDER))

    def remove_highlight(self, name: str) -> None:
        """Take a highlight away; none of that name is no error."""
        self._scene.remove(name, Marks)
        self._changed()

    def set_planes(
        self,
        name: str,
        corners: Sequence[ArrayLike],
        colours: Sequence[ColourLike] | ColourLike,
        opacity: float = 0.25,
    ) -> None:
        """Show transparent four-cornered patches, each (4, 3) in mm; those that are not finite are left out."""
        patches = [as_points(patch, "corners") for patch in corners]
        shades = each(_rgbs(colours), len(patches))
        kept = [k for k, patch in enumerate(patches) if np.isfinite(patch).all()]
        self._put(name, Patches(tuple(patches[k] for k in kept), tuple(shades[k] for k in kept), opacity))

    def set_polylines(
        self, name: str, lines: Sequence[ArrayLike], colour: ColourLike | Sequence[ColourLike], width: float = 2.0
    ) -> None:
        """Show lines, each (N, 3) in mm; one colour for all or one each; `width` in pixels."""
        given = [as_points(line, "lines") for line in lines]
        self._put(name, Lines(tuple(given), each(_rgbs(colour), len(given)), width))

    def set_camera_frustum(self, corners: ArrayLike | None) -> None:
        """Show where the camera is: (5, 3), its centre and the four corners of its picture; None takes it away.

        See `scene_shapes.frustum`. The view "camera" then shows what the camera sees.
        """
        self._scene.remove(PYRAMID)
        self._pyramid = None if corners is None else as_points(corners, "corners")
        if self._pyramid is not None:
            for item in camera_pyramid(self._pyramid, self.tr("camera")):
                self._scene.put(PYRAMID, item)
        self._changed()

    def set_labels(self, name: str, labels: Sequence[tuple[ArrayLike, str]], colour: ColourLike | None = None) -> None:
        """Write texts at places (3,) in mm."""
        places = as_points([np.asarray(place, dtype=np.float64) for place, _ in labels], "places")
        self._put(name, Labels(places, tuple(text for _, text in labels), None if colour is None else _rgb(colour)))

    def set_measure(self, name: str, a: ArrayLike, b: ArrayLike, text: str) -> None:
        """Draw a dimension line from `a` to `b`, both (3,) in mm, with a text, computed by the caller."""
        ends = as_points([np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)], "ends")
        self._put(name, Measure(ends, text))

    def set_axes(self, shown: bool) -> None:
        """Show or hide the axes' triad and the scale bar."""
        self._axes = shown
        self.repaint_tool()

    def set_grid(self, shown: bool) -> None:
        """Show or hide a millimetre grid under the scene."""
        self._buttons.grid.setChecked(shown)

    def set_point_size(self, pixels: float) -> None:
        """Diameter of the cloud's points on the screen."""
        self._point_size = self._backing.point_size = pixels
        self._backing.dress()

    def set_orientation(self, up: ArrayLike, north: ArrayLike) -> None:
        """Say which way is up and which is away from the viewer of the front view, both (3,).

        Until then up is towards the camera and north is up in the camera's picture.

        Raises
        ------
        ValueError
            If they are parallel or not finite.
        """
        self._navigator.set_orientation(up, north)
        self._changed()

    def remove(self, name: str) -> None:
        """Take away planes, lines, labels, measures or highlights of that name; none is no error."""
        self._scene.remove(name)
        self._changed()

    def clear(self, message: str = "") -> None:
        """Take everything away; a message stands in the empty view."""
        self.stop_drawing()
        self._chooser.stop()
        self._chooser.marked = None
        self._scene.clear()
        self._pyramid = None
        self._message = message
        self._navigator.forget()
        self._changed()

    def _put(self, name: str, item: Marks | Patches | Lines | Labels | Measure) -> None:
        self._scene.put(name, item)
        self._changed()


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
