"""The 3D view: a point cloud, a mesh, planes and marks in millimetres, to look at, turn, measure on and choose from.

Everything a page needs of 3D is a method or a signal of `SceneView`; pages know nothing of VTK.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PySide6.QtCore import Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QWidget

ViewName = Literal["front", "back", "left", "right", "top", "bottom", "iso", "camera"]
ColourLike = str | tuple[int, int, int] | QColor
ColourMap = Literal["viridis", "plasma", "deviation"]


def warm_up() -> None:
    """Import the 3D libraries in the background; call it when the program is idle. Returns at once."""


class SceneView(QWidget):
    """A 3D scene with its tool bar, colour bar, axes and scale.

    All coordinates are in mm, in the camera's frame unless `set_orientation` says which way is up.
    """

    notice = Signal(str)
    """One sentence, once, when the embedded 3D view is not available and pictures are shown instead."""

    point_picked = Signal(int, object)
    """Index into the cloud's points as given, and their coordinates (3,) in mm."""

    region_selected = Signal(object)
    """Which points of the cloud as given lie in the drawn region: (N,) bool."""

    drawing_cancelled = Signal()
    """Picking or drawing was ended by Esc or by `stop_drawing`, without a result."""

    def __init__(self, parent: QWidget | None = None, *, tools: bool = True) -> None:
        super().__init__(parent)

    # ---- what is shown

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
            (N, 3) in mm; may be empty, to grow by `add_points`.
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
        """

    def add_points(self, points: ArrayLike, values: ArrayLike | None = None) -> None:
        """Let the cloud grow by `points` (M, 3); cheap, shown at most ten times a second."""

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
        """Show a surface: vertices (V, 3) in mm, triangles (T, 3) of vertex numbers, values (V,)."""

    def show_cloud(self, shown: bool) -> None:
        """Show or hide the cloud."""

    def show_mesh(self, shown: bool) -> None:
        """Show or hide the mesh."""

    def set_highlight(self, name: str, points: ArrayLike, colour: ColourLike) -> None:
        """Mark points (N, 3) in one colour, drawn larger than the cloud's."""

    def remove_highlight(self, name: str) -> None:
        """Take a highlight away; none of that name is no error."""

    def set_planes(
        self,
        name: str,
        corners: Sequence[ArrayLike],
        colours: Sequence[ColourLike] | ColourLike,
        opacity: float = 0.25,
    ) -> None:
        """Show transparent four-cornered patches, each (4, 3) in mm."""

    def set_polylines(
        self, name: str, lines: Sequence[ArrayLike], colour: ColourLike | Sequence[ColourLike], width: float = 2.0
    ) -> None:
        """Show lines, each (N, 3) in mm; one colour for all or one each; `width` in pixels."""

    def set_camera_frustum(self, corners: ArrayLike | None) -> None:
        """Show where the camera is: (5, 3), its centre and the four corners of its picture; None takes it away."""

    def set_labels(self, name: str, labels: Sequence[tuple[ArrayLike, str]], colour: ColourLike | None = None) -> None:
        """Write texts at places in mm."""

    def set_measure(self, name: str, a: ArrayLike, b: ArrayLike, text: str) -> None:
        """Draw a dimension line from `a` to `b` with a text, computed by the caller."""

    def set_axes(self, shown: bool) -> None:
        """Show or hide the axes' triad and the scale bar."""

    def set_grid(self, shown: bool) -> None:
        """Show or hide a millimetre grid under the scene."""

    def set_point_size(self, pixels: float) -> None:
        """Diameter of the cloud's points on the screen."""

    def set_orientation(self, up: ArrayLike, north: ArrayLike) -> None:
        """Say which way is up and which is away from the viewer in the front view, both (3,).

        Until then up is towards the camera and north is up in the camera's picture.
        """

    def remove(self, name: str) -> None:
        """Take away planes, lines, labels, measures or highlights of that name; none is no error."""

    def clear(self, message: str = "") -> None:
        """Take everything away; a message stands in the empty view."""

    # ---- from where it is seen

    def view(self, name: ViewName) -> None:
        """Look from a standard direction and fit."""

    def fit(self) -> None:
        """Keep the direction, show everything."""

    def set_parallel(self, parallel: bool) -> None:
        """Parallel projection, in which lengths can be compared, or perspective."""

    # ---- choosing

    def start_picking(self) -> None:
        """Every click on the cloud gives `point_picked` until Esc or `stop_drawing`; dragging still turns the view."""

    def start_polygon(self) -> None:
        """Let the user click the corners of a region; a double click or Enter closes it, Esc cancels."""

    def start_lasso(self) -> None:
        """Let the user draw round a region with the button held down; Esc cancels."""

    def stop_drawing(self) -> None:
        """End picking or drawing without a result."""

    # ---- pictures

    def picture(self) -> NDArray[np.uint8]:
        """What is shown, whole, with colour bar and labels: (h, w, 3)."""
        return np.zeros((self.height(), self.width(), 3), dtype=np.uint8)

    def state(self) -> dict[str, Any]:
        """How the scene is drawn, for messages and tests: kind of view, points in all, points drawn while moving."""
        return {}
