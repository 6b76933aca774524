"""The layers over a picture by name: their order, which are shown, their legend and their menu."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from PySide6.QtCore import QObject, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QLinearGradient, QPainter, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import QMenu, QWidget

from workbench.language import tr
from workbench.views.colours import ColourLike, KeySign, sigma_table, to_colour, to_rgba
from workbench.views.image.overlays import GROUND, TEXT, Grip, Layer, Points, PointsLayer, PolygonLayer
from workbench.views.image.picture import PictureBox
from workbench.views.image.symbols import symbol_pixmap


class LayerStack(QObject):
    """Layers in the order they first came; a layer set anew replaces the one of its name."""

    changed = Signal()

    def __init__(self, box: PictureBox, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._box = box
        self._layers: dict[str, Layer] = {}
        self._order: dict[str, int] = {}
        self._hidden: set[str] = set()

    def __getitem__(self, name: str) -> Layer:
        return self._layers[name]

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._layers, key=self._order.__getitem__))

    def put(self, name: str, layer: Layer) -> None:
        """Add a layer called `name`, in place of an earlier one of that name."""
        if (old := self._layers.pop(name, None)) is not None:
            self._box.removeItem(old)
        self._layers[name] = layer
        self._box.addItem(layer, ignoreBounds=True)
        layer.setZValue(10 + self._order.setdefault(name, len(self._order)))
        layer.setVisible(name not in self._hidden)
        self.changed.emit()

    def remove(self, name: str) -> None:
        """Remove the layer called `name`, if there is one."""
        if (layer := self._layers.pop(name, None)) is not None:
            self._box.removeItem(layer)
            self.changed.emit()

    def clear(self) -> None:
        """Remove all layers; which names are hidden is remembered."""
        for layer in self._layers.values():
            self._box.removeItem(layer)
        self._layers = {}
        self.changed.emit()

    def set_visible(self, name: str, visible: bool) -> None:
        """Show or hide the layer called `name`, also when it is put again later."""
        (self._hidden.discard if visible else self._hidden.add)(name)
        if name in self._layers:
            self._layers[name].setVisible(visible)
        self.changed.emit()

    def is_visible(self, name: str) -> bool:
        """Whether the layer called `name` is to be shown."""
        return name not in self._hidden

    def legend(self) -> list[tuple[str, KeySign, ColourLike]]:
        """Return title, sign and colour of each layer that is shown and has a title."""
        shown = (self._layers[name] for name in self if self.is_visible(name))
        return [(layer.title, *layer.key) for layer in shown if layer.title]

    def points(self) -> Points:
        """Return the points (N, 2), in picture pixels, of all point layers that are shown."""
        shown = (self._layers[name] for name in self if self.is_visible(name))
        return np.concatenate([np.zeros((0, 2)), *(layer.uv for layer in shown if isinstance(layer, PointsLayer))])

    def point_at(self, u: float, v: float) -> tuple[str, int] | None:
        """Find the topmost layer with a point at (u, v); return its name and the point's index, or None."""
        for name in reversed(list(self)):
            if self.is_visible(name):
                index = self._layers[name].point_at(u, v, self._box.pixel)
                if index is not None:
                    return name, index
        return None

    def tip_at(self, u: float, v: float) -> str:
        """Return the tooltip of the topmost point at (u, v) that has one; "" if there is none."""
        for name in reversed(list(self)):
            layer = self._layers[name]
            index = layer.point_at(u, v, self._box.pixel) if self.is_visible(name) else None
            if index is not None and (tip := layer.tip(index)):
                return tip
        return ""

    def grip_at(self, u: float, v: float) -> tuple[str, Grip] | None:
        """Find the editable region that can be dragged at (u, v); return its name and the part, or None."""
        for name in reversed(list(self)):
            layer = self._layers[name]
            if isinstance(layer, PolygonLayer) and self.is_visible(name):
                grip = layer.grip_at(u, v, self._box.pixel)
                if grip is not None:
                    return name, grip
        return None


Rgba = tuple[int, int, int, int]

KEY_WIDTH, KEY_HEIGHT = 18, 14
"""Of a sign, in logical pixels."""

MARGIN, GAP, ROUND = 8, 6, 4
"""At the sides, between sign and title, radius of the corners; in logical pixels."""


class Legend(QWidget):
    """Key of symbols and colours over a corner of the picture; the mouse goes through it.

    Painted, not laid out from labels: it changes with almost every frame of a scan.
    """

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._entries: list[tuple[str, KeySign, Rgba]] = []
        self.hide()

    def set_entries(self, entries: Sequence[tuple[str, KeySign, ColourLike]]) -> None:
        """Set the legend's entries: title, sign and colour of each."""
        wanted = [(title, sign, to_rgba(colour)) for title, sign, colour in entries]
        if wanted != self._entries:
            self._entries = wanted
            self.setAccessibleDescription(", ".join(self.titles))
            self.resize(self.sizeHint())
            self.update()

    @property
    def titles(self) -> list[str]:
        """Titles of the legend's entries."""
        return [title for title, _, _ in self._entries]

    def sizeHint(self) -> QSize:
        words = self.fontMetrics()
        widest = max((words.horizontalAdvance(title) for title in self.titles), default=0)
        return QSize(2 * MARGIN + KEY_WIDTH + GAP + widest, 2 * GAP + self._row * len(self._entries))

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(GROUND)
        painter.drawRoundedRect(self.rect(), ROUND, ROUND)
        painter.setPen(TEXT)
        row, ratio = self._row, self.devicePixelRatioF()
        for place, (title, sign, rgba) in enumerate(self._entries):
            top = GAP + place * row
            painter.drawPixmap(MARGIN, top + (row - KEY_HEIGHT) // 2, key_pixmap(sign, rgba, ratio))
            left = MARGIN + KEY_WIDTH + GAP
            painter.drawText(left, top, self.width() - left, row, Qt.AlignmentFlag.AlignVCenter, title)
        painter.end()

    @property
    def _row(self) -> int:
        return max(self.fontMetrics().height(), KEY_HEIGHT) + 1


@lru_cache(maxsize=256)
def key_pixmap(sign: KeySign, rgba: Rgba, ratio: float) -> QPixmap:
    """Draw the sign of a legend's entry as a pixmap."""
    pixmap = QPixmap(round(KEY_WIDTH * ratio), round(KEY_HEIGHT * ratio))
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    if sign == "line":
        painter.setPen(QPen(to_colour(rgba), 2.4))
        painter.drawLine(1, 7, 17, 7)
    elif sign == "scale":
        scale = QLinearGradient(1, 0, 17, 0)
        for place, shade in zip(np.linspace(0, 1, 6), sigma_table()[::51], strict=True):
            scale.setColorAt(place, QColor(int(shade[0]), int(shade[1]), int(shade[2])))
        painter.fillRect(QRectF(1, 5.5, 16, 3), scale)
    else:
        symbol = QPixmap(symbol_pixmap(sign, rgba, 9, ratio))
        symbol.setDevicePixelRatio(ratio)
        side = symbol.width() / ratio
        painter.drawPixmap(round(9 - side / 2), round(7 - side / 2), symbol)
    painter.end()
    return pixmap


class LayersMenu(QMenu):
    """Menu with one entry a layer with a title, checked while it is shown, and one for the legend."""

    legend_wanted = Signal(bool)

    def __init__(self, layers: LayerStack, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._layers, self.legend_shown = layers, True
        self.aboutToShow.connect(self.fill)

    def fill(self) -> None:
        """Fill the menu with the layers that have a title."""
        self.clear()
        for name in self._layers:
            if not self._layers[name].title:
                continue
            action = self.addAction(self._layers[name].title)
            action.setCheckable(True)
            action.setChecked(self._layers.is_visible(name))
            action.toggled.connect(lambda on, name=name: self._layers.set_visible(name, on))
        self.addSeparator()
        legend = self.addAction(tr("Legend"))
        legend.setCheckable(True)
        legend.setChecked(self.legend_shown)
        legend.toggled.connect(self.legend_wanted)
