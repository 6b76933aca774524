"""A picture with layers of points, lines and regions over it."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike
from PySide6.QtCore import QPoint, QPointF, Qt, Signal
from PySide6.QtGui import QCursor
from PySide6.QtWidgets import QToolTip, QWidget

from workbench.views.colours import COVERED, REGION, RESIDUAL, ColourLike, Symbol
from workbench.views.image_frame import ImageFrame
from workbench.views.labels import TEXT
from workbench.views.overlay_areas import CellsLayer, Grip, PolygonLayer, TextLayer
from workbench.views.overlay_lines import LinesLayer, VectorsLayer
from workbench.views.overlays import PointsLayer


class ImageView(ImageFrame):
    """Shows one picture; layers lie over it by name, in the coordinates of the full-resolution picture.

    The centre of the first pixel is (0, 0). Setting a layer replaces the one of that name; `title` puts it into the
    legend and the layers menu. Wheel: zoom about the cursor; drag or arrows: pan; F: fit; 1: pixel on pixel; +, −.
    """

    polygon_drawn = Signal(str, object)
    """Name, corners (N, 2) in pixels; of a lasso as well."""

    polygon_edited = Signal(str, object)
    """Name, corners (N, 2) in pixels, when a corner or the whole has been dragged."""

    drawing_cancelled = Signal(str)
    """Name of what was not drawn: Esc, or `stop_drawing`."""

    point_clicked = Signal(str, int)
    """Layer and index of the point."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._grip: tuple[str, Grip] | None = None
        self._box.claim_drag = self._claims_drag
        self._box.clicked.connect(self._clicked)
        self._box.double_clicked.connect(self._double_clicked)
        self._box.dragged.connect(self._dragged)
        self._box.hovered.connect(self._hovered)
        self._drawing.drawn.connect(self.polygon_drawn)
        self._drawing.cancelled.connect(self.drawing_cancelled)

    # ---- layers

    def set_points(
        self,
        name: str,
        uv: ArrayLike,
        *,
        colour: ColourLike | ArrayLike,
        symbol: Symbol = "o",
        size: float = 8,
        tips: Sequence[str] | None = None,
        title: str = "",
    ) -> None:
        """Points (N, 2); `colour` for all or (N, 3 or 4) uint8; `size` in screen pixels; `tips` show on hover."""
        self._layers.put(name, PointsLayer(uv, colour, symbol, size, tips, title))

    def set_lines(
        self,
        name: str,
        lines: Sequence[ArrayLike],
        *,
        colour: ColourLike = REGION,
        colours: Sequence[ColourLike] | None = None,
        values: Sequence[ArrayLike] | None = None,
        limits: tuple[float, float] = (0.0, 1.0),
        width: float = 1.5,
        labels: Sequence[str] | None = None,
        title: str = "",
    ) -> None:
        """Lines, each (N, 2): one colour for all, one each, or by a value at each point.

        `values` are coloured as σ between `limits`; above them and NaN are grey. NaN in a line leaves a gap. `labels`
        stand at the start of each line.
        """
        each = [colour] * len(lines) if colours is None else colours
        self._layers.put(name, LinesLayer(lines, each, values, limits, width, labels, title))

    def set_vectors(
        self,
        name: str,
        uv: ArrayLike,
        d_uv: ArrayLike,
        *,
        factor: float,
        colour: ColourLike = RESIDUAL,
        title: str = "",
    ) -> None:
        """Arrows from uv (N, 2) to uv + factor · d_uv."""
        self._layers.put(name, VectorsLayer(uv, d_uv, factor, colour, title))

    def set_cells(self, name: str, grid: ArrayLike, colour: ColourLike = COVERED, *, title: str = "") -> None:
        """Tint the cells of a grid (rows, columns) over the whole picture where it is True."""
        self._layers.put(name, CellsLayer(grid, colour, lambda: self._box.extent, title))

    def set_text(self, name: str, texts: Sequence[tuple[float, float, str]], *, colour: ColourLike = TEXT) -> None:
        """Texts (u, v, text), centred there."""
        self._layers.put(name, TextLayer(texts, colour))

    def set_polygon(
        self, name: str, uv: ArrayLike, *, editable: bool = False, colour: ColourLike = REGION, title: str = ""
    ) -> None:
        """A closed region (N, 2); with `editable` its corners, and all of it by its middle, can be dragged."""
        self._layers.put(name, PolygonLayer(uv, colour, editable, title))

    def remove_layer(self, name: str) -> None:
        """Take a layer away; none of that name is no error."""
        self._layers.remove(name)

    def set_layer_visible(self, name: str, visible: bool) -> None:
        """Show or hide a layer; remembered for the name, also while there is no such layer."""
        self._layers.set_visible(name, visible)

    def is_layer_visible(self, name: str) -> bool:
        """Whether a layer of that name is to be shown."""
        return self._layers.is_visible(name)

    def clear_layers(self) -> None:
        """Take all layers away."""
        self._layers.clear()

    def layer_names(self) -> tuple[str, ...]:
        """The layers there are, from the lowest to the topmost."""
        return tuple(self._layers)

    # ---- drawing

    def start_polygon(self, name: str) -> None:
        """Let the user draw: click corners; double-click or Enter closes, Backspace takes one back, Esc cancels.

        By keys alone: arrows move the pencil (with Shift in leaps), Space sets a corner.
        """
        self._drawing.start(name, "polygon")
        self.setFocus()

    def start_lasso(self, name: str) -> None:
        """Let the user draw round a region with the button held down."""
        self._drawing.start(name, "lasso")
        self.setFocus()

    def stop_drawing(self) -> None:
        """End drawing without a result; nothing being drawn is no error."""
        self._drawing.stop()

    # ---- the mouse

    def _clicked(self, place: QPointF, button: Qt.MouseButton) -> None:
        drawing = self._drawing.draft is not None
        if drawing and button == Qt.MouseButton.RightButton:
            self._drawing.take_back()
        elif drawing and not self._drawing.lasso and button == Qt.MouseButton.LeftButton:
            self._drawing.add(place)
        elif not drawing and button == Qt.MouseButton.LeftButton:
            met = self._layers.point_at(place.x(), place.y())
            if met is not None:
                self.point_clicked.emit(*met)

    def _double_clicked(self, place: QPointF) -> None:
        if self._drawing.draft is not None and not self._drawing.lasso:
            self._drawing.add(place)
            self._drawing.finish()

    def _claims_drag(self, place: QPointF) -> bool:
        self._grip = None if self._drawing.draft is not None else self._layers.grip_at(place.x(), place.y())
        return self._grip is not None or self._drawing.lasso

    def _dragged(self, place: QPointF, by: QPointF, phase: str) -> None:
        if self._drawing.lasso:
            self._drawing.add(place)
            if phase == "end":
                self._drawing.finish()
        elif self._grip is not None:
            name, grip = self._grip
            layer = self._layers[name]
            assert isinstance(layer, PolygonLayer)
            layer.drag(grip, by.x(), by.y())
            if phase == "end":
                self._grip = None
                self.polygon_edited.emit(name, layer.uv.copy())

    def _hovered(self, place: QPointF | None) -> None:
        self._drawing.hover(place)
        if place is None or not self.has_picture:
            self._strip.readout.clear()
            return
        u, v = place.x(), place.y()
        value = self._picture.value_at(u, v)
        text = self.tr("u {u:.1f}  v {v:.1f}  grey {grey}") if value else self.tr("u {u:.1f}  v {v:.1f}")
        self._strip.readout.setText(text.format(u=u, v=v, grey=value))
        tip = "" if self._drawing.draft is not None else self._layers.tip_at(u, v)
        if tip:
            QToolTip.showText(QCursor.pos() + QPoint(12, 8), tip, self._canvas)
        elif QToolTip.isVisible():
            QToolTip.hideText()
        if self._drawing.draft is None:
            held = self._layers.grip_at(u, v) is not None
            self.canvas.setCursor(Qt.CursorShape.SizeAllCursor if held else Qt.CursorShape.ArrowCursor)
