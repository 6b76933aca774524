"""A picture with layers of points, lines and regions over it: zoom and pan, readout, buttons, legend, drawing."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pyqtgraph as pg
from numpy.typing import ArrayLike
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QCursor, QFocusEvent, QKeyEvent, QPaintEvent
from PySide6.QtWidgets import QLabel, QMenu, QToolTip, QWidget

from workbench.language import number, tr
from workbench.theme import is_dark
from workbench.views.colours import COVERED, REGION, RESIDUAL, ColourLike, Symbol
from workbench.views.common import copy_picture, draw_focus, save_picture
from workbench.views.empty_state import EmptyState
from workbench.views.image.announcement import Announcement
from workbench.views.image.drawing import ARROWS, DrawingTool
from workbench.views.image.layers import LayersMenu, LayerStack, Legend
from workbench.views.image.offer import Offer
from workbench.views.image.overlays import (
    CellsLayer,
    Grip,
    LinesLayer,
    PointsLayer,
    PolygonLayer,
    VectorsLayer,
)
from workbench.views.image.picture import ZOOM_STEP, PictureBox, PictureItem
from workbench.views.image.tools import ToneMenu, ToolStrip
from workbench.views.layouts import in_column

GROUND = {True: "#12151A", False: "#DDE1E6"}
"""Round the picture, in the dark and in the light theme."""

LEGEND_SHARE = 0.25
"""The legend takes no more than this share of the picture's place."""

LEGEND_PX = 8
"""From the edges to the legend."""
_PAN_PX = 60
"""One press of an arrow key moves the picture by so much."""

_KEYS = {Qt.Key.Key_F, Qt.Key.Key_1, Qt.Key.Key_Plus, Qt.Key.Key_Minus, Qt.Key.Key_Equal, *ARROWS}


class ImageView(QWidget):
    """View of one picture; layers lie over it by name, in the coordinates of the full-resolution picture.

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
        self._picture, self._box = PictureItem(), PictureBox()
        self._canvas = pg.GraphicsView(background=None)
        self._canvas.setCentralItem(self._box)
        self._canvas.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._canvas.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        self._box.addItem(self._picture, ignoreBounds=True)
        self._layers, self._drawing = LayerStack(self._box, self), DrawingTool(self._box, self)
        self._legend = Legend(self._canvas)
        self._corner = 0
        self._hint = QLabel(self._canvas)
        self._hint.setStyleSheet(
            "background: rgba(12, 16, 20, 200); color: #F4F6F8; border-radius: 4px; padding: 5px 9px;"
        )
        self._hint.hide()
        self._announcement, self.offered = Announcement(self._canvas), Offer(self._canvas)
        self._empty = EmptyState(self._canvas)
        self._strip, self._tone = ToolStrip(), ToneMenu(self)
        self._layers_menu = LayersMenu(self._layers, self)
        self._grip: tuple[str, Grip] | None = None
        self._fitted = True
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(tr("Picture"))
        in_column((self._canvas, 1), self._strip, on=self, margins=(1, 1, 1, 1), spacing=0)
        self._connect()
        self._dress()
        self.clear()

    # ---- the picture

    def set_picture(
        self,
        picture: ArrayLike,
        *,
        keep_view: bool = True,
        scale: float = 1.0,
        levels: tuple[float, float] | None = None,
    ) -> None:
        """Show a picture: (rows, columns) of uint8, uint16, float or bool, or (rows, columns, 3) of uint8.

        `scale` is how many full-resolution pixels one pixel of a reduced picture is wide. `levels` are the values of
        black and white; by default those of the type, of the camera's bits, or of the values of a float picture. The
        view is kept unless the picture is of another size.

        Raises
        ------
        ValueError
            If it is no picture by its shape.
        """
        self._picture.set_picture(np.asarray(picture), scale, levels)
        if self._picture.rect != self._box.extent or not keep_view:
            self._box.extent = self._picture.rect
            self.fit()
        if not self._empty.isHidden():
            self._empty.hide()
            self._strip.setEnabled(True)
            self._arrange()

    def clear(
        self, message: str = "", button: str = "", on_button: Callable[[], None] | None = None, why_not: str = ""
    ) -> None:
        """Remove picture and layers, and show a sentence instead, with a button if `button` is its text."""
        self._drawing.stop()
        self._layers.clear()
        self._picture.set_picture(None, 1.0, None)
        self._box.extent = QRectF()
        self._fitted = True
        self._strip.readout.clear()
        self._strip.zoom.clear()
        self._strip.setEnabled(False)
        self._empty.set_text(message, button, on_button, why_not)
        self._empty.show()
        self._arrange()

    def announce(self, sentence: str) -> None:
        """Show a sentence large over the picture, for two seconds at least; "" shows none, nor beside an offer."""
        self._announcement.set_text(sentence if self.offered.isHidden() else "")

    def offer(self, sentence: str, button: str = "", do: Callable[[], None] | None = None) -> None:
        """Show a sentence over the picture with a button that calls `do`; "" hides it."""
        self.offered.set_offer(sentence, button, do)

    @property
    def announced(self) -> str:
        """Sentence that is shown in large letters over the picture; "" if none is."""
        return "" if self._announcement.isHidden() else self._announcement.text()

    @property
    def has_picture(self) -> bool:
        """Whether a picture is shown, not the sentence in its place."""
        return self._picture.picture is not None

    @property
    def empty_state(self) -> EmptyState:
        """Widget with the sentence and button that are shown without a picture."""
        return self._empty

    # ---- the view

    def fit(self) -> None:
        """Zoom so that the whole picture is shown, also after the view is resized."""
        self._fitted = True
        self._box.fit()

    def one_to_one(self) -> None:
        """Zoom so that one pixel of the picture covers one pixel of the screen."""
        self._fitted = False
        self._box.show_at_zoom(1.0 / self.devicePixelRatioF())

    def centre_on(self, u: float, v: float) -> None:
        """Move the view so that the place (u, v) is in its middle."""
        self._fitted = False
        self._box.show_at_zoom(1.0 / self._box.pixel, QPointF(u, v))

    @property
    def fitted(self) -> bool:
        """Whether the view is zoomed so that the whole picture is shown."""
        return self._fitted

    @property
    def zoom(self) -> float:
        """Width of one pixel of the picture in pixels of the screen."""
        return self.devicePixelRatioF() / self._box.pixel

    def to_screen(self, u: float, v: float) -> QPoint:
        """Convert a place (u, v) of the picture to a point of the widget `canvas`."""
        place = self._box.mapViewToScene(QPointF(u, v))
        return QPoint(round(place.x()), round(place.y()))

    @property
    def canvas(self) -> QWidget:
        """Widget on which the picture is drawn, which takes the mouse."""
        viewport: QWidget = self._canvas.viewport()
        return viewport

    @property
    def readout(self) -> str:
        """Text on place and value of the pixel under the mouse."""
        return self._strip.readout.text()

    def add_tool(self, widget: QWidget) -> None:
        """Add a widget of the page to the strip under the picture."""
        self._strip.add_tool(widget)

    def set_legend_visible(self, visible: bool) -> None:
        """Show or hide the legend of colours and symbols."""
        self._layers_menu.legend_shown = visible
        self._show_legend()

    @property
    def legend_titles(self) -> list[str]:
        """Titles of the legend's entries; [] while the legend is hidden."""
        return [] if self._legend.isHidden() else self._legend.titles

    def set_tone(self, gain: float, gamma: float) -> None:
        """Set how grey levels are shown: grey · gain, then to the power 1/gamma."""
        self._picture.set_tone(gain, gamma)

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
        """Show the layer `name` of points (N, 2) in px; `colour` is one for all, or (N, 3 or 4) uint8."""
        self._layers.put(name, PointsLayer(uv, colour, symbol, size, tips, title))

    def set_lines(
        self,
        name: str,
        lines: Sequence[ArrayLike],
        *,
        colour: ColourLike | list[ColourLike] = REGION,
        values: Sequence[ArrayLike] | None = None,
        limits: tuple[float, float] = (0.0, 1.0),
        width: float = 1.5,
        labels: Sequence[str] | None = None,
        title: str = "",
    ) -> None:
        """Show the layer `name` of polylines (N, 2) in px, coloured alike, one by one, or by `values` at the points.

        `values` are coloured as σ between `limits`; above them and NaN are grey. NaN in a line leaves a gap. `labels`
        stand at the start of each line.
        """
        each = colour if isinstance(colour, list) else [colour] * len(lines)
        self._layers.put(name, LinesLayer(lines, each, values, limits, width, labels, title))

    def set_vectors(
        self,
        name: str,
        uv: ArrayLike,
        d_uv: ArrayLike,
        *,
        factor: float,
        title: str = "",
    ) -> None:
        """Show the layer `name` of arrows from `uv` (N, 2) to `uv` + `factor` · `d_uv`, in px."""
        self._layers.put(name, VectorsLayer(uv, d_uv, factor, RESIDUAL, title))

    def set_cells(self, name: str, grid: ArrayLike, colour: ColourLike = COVERED, *, title: str = "") -> None:
        """Show the layer `name` of a grid (rows, columns) over the whole picture, tinted where it is True."""
        self._layers.put(name, CellsLayer(grid, colour, lambda: self._box.extent, title))

    def set_polygon(
        self,
        name: str,
        uv: ArrayLike,
        *,
        editable: bool = False,
        colour: ColourLike = REGION,
        title: str = "",
        label: str = "",
    ) -> None:
        """Show the layer `name` of a closed region (N, 2) in px, whose corners can be dragged if `editable`.

        One with a `label`, which stands below it, is dashed: it is offered, and not what counts.
        """
        self._layers.put(name, PolygonLayer(uv, colour, editable, title, label))

    def remove_layer(self, name: str) -> None:
        """Remove the layer called `name`, if there is one."""
        self._layers.remove(name)

    def clear_layers(self) -> None:
        """Remove all layers over the picture."""
        self._layers.clear()

    def layer_names(self) -> tuple[str, ...]:
        """List the names of the layers, from the lowest to the topmost."""
        return tuple(self._layers)

    # ---- drawing

    def start_polygon(self, name: str) -> None:
        """Start drawing a region called `name` by clicks at its corners; double click or Enter closes it.

        By keys alone: arrows move the pencil (with Shift in leaps), Space sets a corner.
        """
        self._drawing.start(name, "polygon")
        self.setFocus()

    def start_lasso(self, name: str) -> None:
        """Start drawing a region called `name` by one stroke round it, the mouse button held down."""
        self._drawing.start(name, "lasso")
        self.setFocus()

    def stop_drawing(self) -> None:
        """End drawing without a region, if one is being drawn."""
        self._drawing.stop()

    # ---- events

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if self._drawing.key(event):
            return
        key = Qt.Key(event.key())
        if not self.has_picture:
            super().keyPressEvent(event)
        elif key == Qt.Key.Key_F:
            self.fit()
        elif key == Qt.Key.Key_1:
            self.one_to_one()
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal):
            self._box.zoom_by(ZOOM_STEP)
        elif key == Qt.Key.Key_Minus:
            self._box.zoom_by(1 / ZOOM_STEP)
        elif key in ARROWS:
            self._box.pan_by(*(_PAN_PX * step for step in ARROWS[key]))
        else:
            super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.ShortcutOverride:
            plain = event.modifiers() in (Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.KeypadModifier)
            drawing = self._drawing.draft is not None and event.key() in (
                Qt.Key.Key_Escape,
                Qt.Key.Key_Return,
                Qt.Key.Key_Enter,
                Qt.Key.Key_Backspace,
                Qt.Key.Key_Space,
            )
            if drawing or (plain and self.has_picture and event.key() in _KEYS):
                event.accept()
        return super().event(event)

    def focusInEvent(self, event: QFocusEvent) -> None:
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        draw_focus(self)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._dress()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        if not self.has_picture or self._drawing.draft is not None:
            return
        menu = QMenu(self)
        menu.addAction(tr("Whole picture"), self.fit)
        menu.addAction(tr("Pixel on pixel"), self.one_to_one)
        menu.addSeparator()
        menu.addAction(tr("Copy what is shown"), lambda: copy_picture(self._canvas))
        title = tr("Save what is shown")
        menu.addAction(f"{title} …", lambda: save_picture(self._canvas, title, "picture.png"))
        menu.exec(event.globalPos())
        menu.deleteLater()

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
        grey = tr("grey {value}", value=value) if value else ""
        self._strip.readout.setText(f"u {number(u, '.1f')}  v {number(v, '.1f')}  {grey}".rstrip())
        tip = "" if self._drawing.draft is not None else self._layers.tip_at(u, v)
        if tip:
            QToolTip.showText(QCursor.pos() + QPoint(12, 8), tip, self._canvas)
        elif QToolTip.isVisible():
            QToolTip.hideText()
        if self._drawing.draft is None:
            held = self._layers.grip_at(u, v) is not None
            self.canvas.setCursor(Qt.CursorShape.SizeAllCursor if held else Qt.CursorShape.ArrowCursor)

    # ---- inside

    def _connect(self) -> None:
        self._box.zoomed.connect(self._unfit)
        self._box.claim_drag = self._claims_drag
        self._box.clicked.connect(self._clicked)
        self._box.double_clicked.connect(self._double_clicked)
        self._box.dragged.connect(self._dragged)
        self._box.hovered.connect(self._hovered)
        self._drawing.drawn.connect(self.polygon_drawn)
        self._drawing.cancelled.connect(self.drawing_cancelled)
        self._box.sigResized.connect(self._resized)
        self._box.sigRangeChanged.connect(self._say_zoom)
        self._layers.changed.connect(self._show_legend)
        self._drawing.active_changed.connect(self._show_hint)
        self._tone.changed.connect(self.set_tone)
        self._strip.fit.clicked.connect(self.fit)
        self._strip.one.clicked.connect(self.one_to_one)
        self._strip.tone.setMenu(self._tone)
        self._strip.layers.setMenu(self._layers_menu)
        self._layers_menu.legend_wanted.connect(self.set_legend_visible)

    def _unfit(self) -> None:
        self._fitted = False

    def _resized(self) -> None:
        if self._fitted:
            self._box.fit()
        self._arrange()

    def _say_zoom(self) -> None:
        if self.has_picture:
            self._strip.zoom.setText(f"{100 * self.zoom:.0f} %")

    def _arrange(self) -> None:
        size = self._canvas.size()
        if not self._empty.isHidden():
            self._empty.setGeometry(0, 0, size.width(), size.height())
        self._place_legend()
        self._announcement.place()
        self.offered.place()
        self._hint.adjustSize()
        self._hint.move((size.width() - self._hint.width()) // 2, size.height() - self._hint.height() - 10)

    def _show_legend(self) -> None:
        entries = self._layers.legend()
        self._legend.set_entries(entries)
        self._place_legend()

    def _place_legend(self) -> None:
        """Where it would cover too much of the picture, the layers menu has its signs and the menu's tip its words."""
        wanted, room = self._legend.sizeHint(), self._canvas.size()
        covered = wanted.width() * wanted.height() / max(room.width() * room.height(), 1)
        fits = covered <= LEGEND_SHARE and wanted.height() < room.height()
        self._legend.setVisible(fits and bool(self._legend.titles) and self._layers_menu.legend_shown)
        self._strip.set_layers_tip(() if fits else self._legend.titles)
        self._legend.setGeometry(self._corner_for(wanted))

    def _corner_for(self, wanted: QSize) -> QRect:
        """Where the legend covers fewest points; it stays where it is unless it covered twice as many there."""
        room = self._canvas.rect().adjusted(LEGEND_PX, LEGEND_PX, -LEGEND_PX, -LEGEND_PX)
        right, lower = room.right() - wanted.width() + 1, room.bottom() - wanted.height() + 1
        corners = [QRect(QPoint(x, y), wanted) for x in (room.left(), right) for y in (room.top(), lower)]
        origin, unit = (self._box.mapViewToScene(QPointF(at, at)) for at in (0.0, 1.0))
        spots = self._layers.points() * [unit.x() - origin.x(), unit.y() - origin.y()] + [origin.x(), origin.y()]
        covered = [
            int(((spots >= [one.left(), one.top()]) & (spots <= [one.right(), one.bottom()])).all(axis=1).sum())
            for one in corners
        ]
        if covered[self._corner] > 2 * min(covered):
            self._corner = covered.index(min(covered))
        return corners[self._corner]

    def _show_hint(self, drawing: bool) -> None:
        if drawing:
            self._hint.setText(
                tr("Draw round the region with the button held down. Esc cancels.")
                if self._drawing.lasso
                else tr("Click the corners. Double-click or Enter closes, Backspace takes one back, Esc cancels.")
            )
        self._hint.setVisible(drawing)
        self._canvas.viewport().setCursor(Qt.CursorShape.CrossCursor if drawing else Qt.CursorShape.ArrowCursor)
        self._arrange()

    def _dress(self) -> None:
        self._canvas.setBackground(GROUND[is_dark()])
