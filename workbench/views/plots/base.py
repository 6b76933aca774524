"""What all plots share: the looks of the theme, axes with their unit, hover tips, an empty state, a menu to copy."""

from __future__ import annotations

from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QColor, QContextMenuEvent, QCursor, QFont, QGuiApplication, QPen, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QMenu, QToolTip, QWidget

from workbench.language import number, numeral, tr
from workbench.theme import shades
from workbench.views.common import copy_picture, save_picture
from workbench.views.empty_state import EmptyState
from workbench.views.layouts import in_column

LEAST_HEIGHT = 96
"""Pixels that a plot is high at least."""
_TICK_PIXELS = 11
"""Size in pixels of the letters at the axes."""


class Axis(pg.AxisItem):  # type: ignore[misc]
    """An axis whose numbers are those of the window's language."""

    def tickStrings(self, values: Any, scale: float, spacing: float) -> list[str]:
        return [numeral(text) for text in super().tickStrings(values, scale, spacing)]


class Canvas(pg.PlotWidget):  # type: ignore[misc]
    """A plot that leaves the wheel to the panel it stands in."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()


class Plot(QWidget):
    """A plot. A subclass keeps what it was given, and draws it in `_draw` with the colours of the theme."""

    def __init__(self, parent: QWidget | None = None, *, least_height: int = LEAST_HEIGHT) -> None:
        super().__init__(parent)
        self._canvas = Canvas(background=None, axisItems={side: Axis(side) for side in ("left", "bottom")})
        self._canvas.setAntialiasing(True)
        self._canvas.setMenuEnabled(False)
        self._canvas.setMouseEnabled(x=False, y=False)
        self._canvas.hideButtons()
        self._canvas.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        self._canvas.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._canvas.setMinimumHeight(least_height)
        self._item: Any = self._canvas.getPlotItem()
        self._box: Any = self._item.getViewBox()
        self._item.setContentsMargins(4, 6, 10, 2)
        self._empty = EmptyState(self._canvas)
        self._column = in_column((self._canvas, 1), on=self, spacing=2)
        self._labels: dict[str, str] = {}
        self._canvas.scene().sigMouseMoved.connect(self._moved)
        self._canvas.sigDeviceRangeChanged.connect(self._resized)
        self._dress()
        self.clear()

    def clear(self, message: str = "") -> None:
        """Show nothing but a sentence."""
        self._item.clear()
        self._show_axes(False)
        self._empty.say(message)
        self._empty.show()
        self._resized()

    @property
    def empty_state(self) -> EmptyState:
        """What stands there while there is nothing to show."""
        return self._empty

    @property
    def canvas(self) -> QWidget:
        """The widget it is drawn on, which takes the mouse."""
        viewport: QWidget = self._canvas.viewport()
        return viewport

    def to_screen(self, x: float, y: float) -> QPointF:
        """Where a place of the plot is in `canvas`."""
        place: QPointF = self._box.mapViewToScene(QPointF(x, y))
        return place

    def axis_text(self, side: str) -> str:
        """What stands at an axis: "left", "bottom"."""
        return self._labels.get(side, "")

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._dress()
            self._redraw()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._resized()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        menu = QMenu(self)
        menu.addAction(tr("Copy picture"), lambda: copy_picture(self._canvas))
        menu.addAction(tr("Save picture …"), lambda: save_picture(self._canvas, tr("Save picture"), "plot.png"))
        menu.exec(event.globalPos())
        menu.deleteLater()

    # ---- for subclasses

    def _draw(self) -> None:
        """Draw what was given; the plot is empty."""

    def _tip(self, x: float, y: float) -> str:
        """What hovering over a place says."""
        return ""

    def _has_data(self) -> bool:
        """Whether there is something to draw."""
        return False

    def _redraw(self) -> None:
        """Draw anew, after new data or in another theme."""
        if self._has_data():
            self._item.clear()
            self._empty.hide()
            self._show_axes(True)
            self._draw()

    def _show_axes(self, shown: bool) -> None:
        for side in ("left", "bottom"):
            self._item.getAxis(side).setVisible(shown)

    def _set_axis(self, side: str, label: str, unit: str = "") -> None:
        """Name an axis and its unit; values stand as they are given, without prefixes."""
        text = f"{label} [{unit}]" if unit else label
        self._labels[side] = text
        style = {"color": shades().muted, "font-size": f"{_TICK_PIXELS}px"}
        self._item.getAxis(side).setLabel(text, **style)

    def _hide_ticks(self) -> None:
        """Leave the axis below without numbers."""
        axis = self._item.getAxis("bottom")
        axis.setStyle(tickLength=0, showValues=False)
        axis.setHeight(8)

    def _pen(self, colour: str | QColor, width: float, style: Qt.PenStyle = Qt.PenStyle.SolidLine) -> QPen:
        """A pen of so many pixels, whatever the axes; finer screens have smaller pixels."""
        pen: QPen = pg.mkPen(colour, width=width * self.devicePixelRatioF(), style=style)
        return pen

    def _words(self, text: str, colour: str = "", anchor: tuple[float, float] = (0.0, 1.0)) -> Any:
        """A text to be placed in the plot."""
        s = shades()
        words = pg.TextItem(text, color=QColor(colour or s.muted), anchor=anchor, fill=tinted(s.panel, 190))
        words.setFont(small_font())
        return words

    # ---- inside

    def _dress(self) -> None:
        s = shades()
        self._canvas.setBackground(s.panel)
        for side in ("left", "bottom"):
            axis = self._item.getAxis(side)
            axis.autoSIPrefix, axis.autoSIPrefixScale = False, 1.0  # enableAutoSIPrefix(False) scales once more
            axis.setPen(pg.mkPen(s.line, width=1))
            axis.setTextPen(pg.mkPen(s.muted))
            axis.setTickFont(small_font())
            axis.setStyle(tickLength=-4, tickTextOffset=4)
            if side in self._labels:
                axis.setLabel(self._labels[side], color=s.muted, **{"font-size": f"{_TICK_PIXELS}px"})

    def _moved(self, scene_place: QPointF) -> None:
        if not self._has_data():
            return
        place = self._box.mapSceneToView(scene_place)
        tip = self._tip(place.x(), place.y()) if self._box.sceneBoundingRect().contains(scene_place) else ""
        if tip:
            QToolTip.showText(QCursor.pos(), tip, self._canvas)
        elif QToolTip.isVisible():
            QToolTip.hideText()

    def _resized(self, *_: object) -> None:
        if not self._empty.isHidden():
            self._empty.setGeometry(0, 0, self._canvas.width(), self._canvas.height())


def small_font() -> QFont:
    """The font of ticks and words in plots."""
    font = QFont(QGuiApplication.font())
    font.setPixelSize(_TICK_PIXELS)
    return font


def tinted(colour: str, alpha: int) -> QColor:
    """A colour made transparent, 0 … 255."""
    tint = QColor(colour)
    tint.setAlpha(alpha)
    return tint


def written(value: float, step: float) -> str:
    """A value with as many decimals as a step of this size needs, and a true minus."""
    decimals = 0
    while decimals < 9 and step < 0.999 * 10.0**-decimals:
        decimals += 1
    return number(value, f".{decimals}f")
