"""What all plots share: the looks of the theme, axes with their unit, hover tips, an empty state, a menu to copy."""

from __future__ import annotations

import re
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPointF, QSize, Qt
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QCursor,
    QFont,
    QGuiApplication,
    QPainter,
    QPaintEvent,
    QPen,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QMenu, QSizePolicy, QToolTip, QWidget

from workbench.language import number, numeral, tr
from workbench.theme import shades
from workbench.views.common import copy_picture, save_picture
from workbench.views.empty_state import EmptyState
from workbench.views.layouts import in_column

LEAST_HEIGHT = 96
"""Pixels that a plot is high at least."""
_USUAL_SIZE, _LEAST_SIZE = QSize(640, 480), QSize(68, 68)
"""What a plot asks for, whether it has something to show or not: nothing moves when it comes."""
_TICK_PIXELS = 11
"""Size in pixels of the letters at the axes."""


_NUMBER = re.compile(r"[−-]?\d+((?P<point>[.,])(?P<decimals>\d+))?")


class Axis(pg.AxisItem):  # type: ignore[misc]
    """Axis with numbers in the window's language."""

    def tickStrings(self, values: Any, scale: float, spacing: float) -> list[str]:
        return [numeral(text) for text in super().tickStrings(values, scale, spacing)]

    def generateDrawSpecs(self, painter: QPainter) -> Any:
        """Prepare the axis for drawing, all its numbers with equal decimals (called by pyqtgraph)."""
        specs = super().generateDrawSpecs(painter)
        if specs is None:
            return None
        axis, lines, texts = specs
        numbers = [_NUMBER.fullmatch(text) for _, _, text in texts]
        if not all(numbers):
            return specs
        most = max((len(found["decimals"] or "") for found in numbers if found), default=0)
        point = next((found["point"] for found in numbers if found and found["point"]), "")
        return axis, lines, [(*at, _padded(text, point, most)) for *at, text in texts]


def _padded(text: str, point: str, decimals: int) -> str:
    """A number with so many decimals."""
    whole, _, part = text.partition(point) if point else (text, "", "")
    return f"{whole}{point}{part.ljust(decimals, '0')}"


class Canvas(pg.PlotWidget):  # type: ignore[misc]
    """Plot widget that leaves the wheel to the panel it is in."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()


class _Field(QWidget):
    """Where a plot is drawn, in the colour of its ground; what stands there while there is nothing to draw fills it."""

    def __init__(self, least_height: int) -> None:
        super().__init__()
        self.setMinimumHeight(least_height)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.empty = EmptyState(self)

    def sizeHint(self) -> QSize:
        return _USUAL_SIZE

    def minimumSizeHint(self) -> QSize:
        return _LEAST_SIZE

    def paintEvent(self, event: QPaintEvent) -> None:
        QPainter(self).fillRect(self.rect(), QColor(shades().panel))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        for child in self.findChildren(QWidget, options=Qt.FindChildOption.FindDirectChildrenOnly):
            child.setGeometry(self.rect())


class Plot(QWidget):
    """Plot with an empty state. A subclass keeps what it was given, and draws it in `_draw` with the colours of the
    theme.

    What it is drawn on takes as long to make as all else of a panel together, and most plots have nothing to show
    yet: it is made when there is something.
    """

    def __init__(self, parent: QWidget | None = None, *, least_height: int = LEAST_HEIGHT) -> None:
        super().__init__(parent)
        self._canvas: Canvas | None = None
        self._field = _Field(least_height)
        self._empty = self._field.empty
        self._column = in_column((self._field, 1), on=self, spacing=2)
        self._labels: dict[str, str] = {}
        self.clear()

    def clear(self, message: str = "") -> None:
        """Remove what is plotted, and show a sentence instead."""
        if self._canvas is not None:
            self._item.clear()
            self._show_axes(False)
        self._empty.set_text(message)
        self._empty.show()

    @property
    def empty_state(self) -> EmptyState:
        """Widget with the sentence that is shown while there is no plot."""
        return self._empty

    @property
    def canvas(self) -> QWidget:
        """Widget on which the plot is drawn, and which takes the mouse."""
        return self._field if self._canvas is None else self._canvas.viewport()

    def to_screen(self, x: float, y: float) -> QPointF:
        """Convert a place (x, y) of the plot to a point of the widget `canvas`."""
        place: QPointF = self._box.mapViewToScene(QPointF(x, y))
        return place

    def axis_text(self, side: str) -> str:
        """Return the text of the axis at a side, "left" or "bottom"."""
        return self._labels.get(side, "")

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self._canvas is not None:
            self._dress()
            self._redraw()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        menu = QMenu(self)
        menu.addAction(tr("Copy picture"), lambda: copy_picture(self._field))
        menu.addAction(tr("Save picture …"), lambda: save_picture(self._field, tr("Save picture"), "plot.png"))
        menu.exec(event.globalPos())
        menu.deleteLater()

    # ---- for subclasses

    def _prepare(self) -> None:
        """Add what stays on what it is drawn on, which has just been made."""

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
            if self._canvas is None:
                self._make_canvas()
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
        axis.setTicks([])
        axis.setStyle(showValues=False)
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

    def _make_canvas(self) -> None:
        axes = {side: Axis(side) for side in ("left", "bottom")}
        self._canvas = canvas = Canvas(self._field, background=None, axisItems=axes, enableMenu=False)
        canvas.setAntialiasing(True)
        canvas.setMouseEnabled(x=False, y=False)
        canvas.hideButtons()
        canvas.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        canvas.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._item: Any = canvas.getPlotItem()
        self._box: Any = self._item.getViewBox()
        menu = self._item.ctrlMenu  # never shown, but it holds the plot's switches; without a parent Python deletes it
        menu.setParent(canvas, menu.windowFlags())
        self._item.setContentsMargins(4, 6, 10, 2)
        canvas.scene().sigMouseMoved.connect(self._moved)
        canvas.setGeometry(self._field.rect())  # at once: what is drawn next may go by its size
        canvas.show()
        self._empty.raise_()
        self._dress()
        self._prepare()

    def _dress(self) -> None:
        s = shades()
        self._item.getViewWidget().setBackground(s.panel)
        for side in ("left", "bottom"):
            axis = self._item.getAxis(side)
            axis.autoSIPrefix, axis.autoSIPrefixScale = False, 1.0  # enableAutoSIPrefix(False) scales once more
            axis.setPen(self._pen(s.line, 1))
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


def small_font() -> QFont:
    """Make the font for numbers and words in plots."""
    font = QFont(QGuiApplication.font())
    font.setPixelSize(_TICK_PIXELS)
    return font


def tinted(colour: str, alpha: int) -> QColor:
    """Return a colour, given by name or hex text, with the opacity `alpha`, 0 … 255."""
    tint = QColor(colour)
    tint.setAlpha(alpha)
    return tint


def written(value: float, step: float) -> str:
    """Write a value with as many decimals as numbers `step` apart need, and a true minus sign."""
    decimals = 0
    while decimals < 9 and step < 0.999 * 10.0**-decimals:
        decimals += 1
    return number(value, f".{decimals}f")
