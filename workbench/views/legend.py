"""What the layers of a picture mean: the key over a corner of it, and the menu that shows and hides them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QColor, QLinearGradient, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QMenu, QWidget

from workbench.views.colours import ColourLike, KeySign, sigma_table, to_colour, to_rgba
from workbench.views.layer_stack import LayerStack
from workbench.views.symbols import symbol_pixmap


class Legend(QFrame):
    """A key of symbols and colours over a corner of the picture; the mouse goes through it."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setStyleSheet(
            "Legend { background: rgba(12, 16, 20, 175); border-radius: 4px; } QLabel { color: #F4F6F8; }"
        )
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(8, 5, 10, 5)
        self._grid.setHorizontalSpacing(6)
        self._grid.setVerticalSpacing(1)
        self._entries: list[tuple[str, KeySign, tuple[int, int, int, int]]] = []
        self.hide()

    def set_entries(self, entries: Sequence[tuple[str, KeySign, ColourLike]]) -> None:
        """Title, sign and colour of each; nothing is rebuilt when nothing has changed."""
        wanted = [(title, sign, to_rgba(colour)) for title, sign, colour in entries]
        if wanted == self._entries:
            return
        self._entries = wanted
        while (item := self._grid.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for row, (title, sign, rgba) in enumerate(wanted):
            key = QLabel()
            key.setPixmap(key_pixmap(sign, rgba, self.devicePixelRatioF()))
            for column, label in enumerate((key, QLabel(title))):
                self._grid.addWidget(label, row, column)
                label.show()  # else it has no size before the next round of events
        self._grid.activate()
        self.adjustSize()

    @property
    def titles(self) -> list[str]:
        """What it lists."""
        return [title for title, _, _ in self._entries]


def key_pixmap(sign: KeySign, colour: ColourLike, ratio: float) -> QPixmap:
    """A sign for a legend."""
    rgba = to_rgba(colour)
    pixmap = QPixmap(round(18 * ratio), round(14 * ratio))
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
    """One entry a layer with a title, checked while it is shown, and one for the legend."""

    legend_wanted = Signal(bool)

    def __init__(self, layers: LayerStack, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._layers, self.legend_shown = layers, True
        self.aboutToShow.connect(self.fill)

    def fill(self) -> None:
        """List the layers that have a title."""
        self.clear()
        for name in self._layers:
            if not self._layers[name].title:
                continue
            action = self.addAction(self._layers[name].title)
            action.setCheckable(True)
            action.setChecked(self._layers.is_visible(name))
            action.toggled.connect(lambda on, name=name: self._layers.set_visible(name, on))
        self.addSeparator()
        legend = self.addAction(self.tr("Legend"))
        legend.setCheckable(True)
        legend.setChecked(self.legend_shown)
        legend.toggled.connect(self.legend_wanted)
