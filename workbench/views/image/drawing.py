"""Drawing a region on a picture: by clicks at its corners or one stroke round it, by mouse or by keys."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from workbench.views.colours import REGION
from workbench.views.image.overlays import Layer, Points
from workbench.views.image.picture import PictureBox
from workbench.views.image.symbols import RIM

FEWEST_CORNERS = 3
"""Of a region."""

ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}
"""Right and down, by key."""

_LASSO_STEP, _SAME_PLACE = 3.0, 2.0
"""Screen pixels between points of a stroke, and within which two clicks are one corner: what a hand trembles."""

_STEP, _LEAP = 1, 20
"""Picture pixels that an arrow key moves the pencil by, and with Shift."""


@dataclass(slots=True)
class Draft:
    """Region being drawn; places are (u, v)."""

    name: str
    kind: Literal["polygon", "lasso"]
    corners: list[tuple[float, float]] = field(default_factory=list)
    pencil: tuple[float, float] | None = None

    def add(self, u: float, v: float, pixel: float) -> None:
        """Add (u, v) as a corner or the stroke's next point, unless it repeats; `pixel` is a screen pixel's width."""
        step = (_LASSO_STEP if self.kind == "lasso" else _SAME_PLACE) * pixel
        if not self.corners or np.hypot(self.corners[-1][0] - u, self.corners[-1][1] - v) > step:
            self.corners.append((u, v))

    def outline(self) -> Points:
        """Return the corners (N, 2) of the region drawn so far, in picture pixels."""
        return np.array(self.corners, dtype=np.float64).reshape(-1, 2)


class DraftLayer(Layer):
    """Layer with the unfinished region, and the line to the pencil."""

    draft: Draft | None = None

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        if self.draft is None:
            return
        transform = painter.worldTransform()
        painter.resetTransform()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        colour = QColor(REGION)
        corners = [transform.map(QPointF(u, v)) for u, v in self.draft.corners]
        pencil = None if self.draft.pencil is None else transform.map(QPointF(*self.draft.pencil))
        path = [*corners, pencil] if pencil is not None and self.draft.kind == "polygon" else corners
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for pen in (QPen(RIM, 3.4), QPen(colour, 1.6)):
            painter.setPen(pen)
            painter.drawPolyline(QPolygonF(path))
        if len(path) >= FEWEST_CORNERS:
            painter.setPen(QPen(colour, 1.0, Qt.PenStyle.DashLine))
            painter.drawLine(path[-1], path[0])
        if self.draft.kind == "polygon":
            painter.setPen(QPen(RIM, 1.0))
            painter.setBrush(colour)
            for corner in corners:
                painter.drawEllipse(corner, 4.0, 4.0)
        if pencil is not None:
            painter.setPen(QPen(colour, 1.2))
            painter.drawLine(pencil + QPointF(-9, 0), pencil + QPointF(9, 0))
            painter.drawLine(pencil + QPointF(0, -9), pencil + QPointF(0, 9))


class DrawingTool(QObject):
    """Pencil for drawing regions. While `active`, the view hands it what mouse and keys do."""

    drawn = Signal(str, object)
    cancelled = Signal(str)
    active_changed = Signal(bool)

    def __init__(self, box: PictureBox, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._box, self._layer = box, DraftLayer()
        box.addItem(self._layer, ignoreBounds=True)
        self._layer.setZValue(1e6)

    @property
    def draft(self) -> Draft | None:
        """Region being drawn; None if none is."""
        return self._layer.draft

    @property
    def lasso(self) -> bool:
        """Whether the region is drawn as one stroke, instead of by clicked corners."""
        return self.draft is not None and self.draft.kind == "lasso"

    def start(self, name: str, kind: Literal["polygon", "lasso"]) -> None:
        """Start drawing a region called `name`; a region being drawn is cancelled."""
        self.stop()
        self._layer.draft = Draft(name, kind)
        self.active_changed.emit(True)

    def stop(self) -> None:
        """End drawing without a region."""
        if (draft := self._end()) is not None:
            self.cancelled.emit(draft.name)

    def finish(self) -> None:
        """Close the region if it has at least FEWEST_CORNERS corners; a shorter stroke is begun again."""
        if self.draft is None:
            return
        if len(self.draft.corners) >= FEWEST_CORNERS:
            draft = self._end()
            assert draft is not None
            self.drawn.emit(draft.name, draft.outline())
        elif self.lasso:
            self.draft.corners.clear()
            self._layer.update()

    def add(self, place: QPointF) -> None:
        """Add a corner, or the next point of the stroke, at `place` in picture pixels."""
        if self.draft is not None:
            self.draft.add(place.x(), place.y(), self._box.pixel)
            self._layer.update()

    def take_back(self) -> None:
        """Remove the last corner of the region being drawn."""
        if self.draft is not None and self.draft.corners:
            self.draft.corners.pop()
            self._layer.update()

    def hover(self, place: QPointF | None) -> None:
        """Move the pencil to `place` in picture pixels; None hides it."""
        if self.draft is not None:
            self.draft.pencil = None if place is None else (place.x(), place.y())
            self._layer.update()

    def key(self, event: QKeyEvent) -> bool:
        """Handle a key while drawing; False if it has no meaning. Arrows move the pencil, Space sets a corner."""
        if self.draft is None:
            return False
        key = Qt.Key(event.key())
        if key == Qt.Key.Key_Escape:
            self.stop()
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.finish()
        elif key == Qt.Key.Key_Backspace:
            self.take_back()
        elif key in ARROWS:
            self._step(*ARROWS[key], _LEAP if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else _STEP)
        elif key == Qt.Key.Key_Space:
            if self.draft.pencil is not None:
                self.add(QPointF(*self.draft.pencil))
        else:
            return False
        return True

    def _step(self, right: int, down: int, pixels: int) -> None:
        assert self.draft is not None
        middle = self._box.viewRect().center()
        u, v = self.draft.pencil or (middle.x(), middle.y())
        step = pixels * max(self._box.pixel, 1.0)
        self.hover(QPointF(u + right * step, v + down * step))

    def _end(self) -> Draft | None:
        draft, self._layer.draft = self._layer.draft, None
        if draft is not None:
            self._layer.update()
            self.active_changed.emit(False)
        return draft
