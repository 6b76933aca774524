"""What the mouse and the keys do in the 3D view: turn and move it, pick a point, draw a region.

A tool gets the events of the overlay and tells the view through `ViewControl`; it paints what it is about to do.
"""

from __future__ import annotations

from typing import Protocol

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QKeyEvent, QMouseEvent, QPainter, QWheelEvent

from workbench.language import tr
from workbench.views.scene.overlay import OverlayColours, paint_outline

CLICK = 4.0
"""A press that moves less than so many pixels is a click."""

CLOSE_TO = 10.0
"""A click so near to the first corner closes a polygon."""

ARROWS = {Qt.Key.Key_Left: (-30, 0), Qt.Key.Key_Right: (30, 0), Qt.Key.Key_Up: (0, -30), Qt.Key.Key_Down: (0, 30)}
"""A press turns or moves as a drag of so many pixels."""


class ViewControl(Protocol):
    """Actions of a tool on the view."""

    def orbit(self, dx: float, dy: float) -> None:
        """Turn the view by a drag of (dx, dy) pixels."""

    def pan(self, dx: float, dy: float) -> None:
        """Move the view by a drag of (dx, dy) pixels."""

    def zoom(self, factor: float, at: QPointF | None = None) -> None:
        """Move nearer by `factor`, towards the screen point `at`, or, for None, the middle."""

    def grasp(self, at: QPointF) -> bool:
        """Hold the handle or callout at the screen point `at`; False if there is none."""

    def pull(self, dx: float, dy: float) -> None:
        """Move the handle or callout that is held by a drag of (dx, dy) pixels."""

    def drop(self) -> None:
        """Release the handle or callout that is held."""

    def point_at(self, at: QPointF) -> None:
        """Show by the cursor what is at the screen point `at`, while no button is down."""

    def choose(self, at: QPointF) -> None:
        """Choose the callout at the screen point `at`, if there is one."""

    def pick(self, at: QPointF) -> None:
        """Choose the point of the cloud at the screen point `at`."""

    def take(self) -> None:
        """Accept the point or proposal that was chosen last."""

    def centre_on(self, at: QPointF) -> None:
        """Turn the view from now on about the point of the cloud at the screen point `at`."""

    def choose_region(self, corners: list[QPointF]) -> None:
        """Choose the points of the cloud that are seen inside a drawn outline."""

    def repaint_tool(self) -> None:
        """Paint again what the tool draws over the scene."""


class Navigate:
    """Tool to move the view: left button turns; right, or left with Shift, moves; wheel and middle zoom.

    A handle or callout that is shown is dragged with the left button.
    """

    cursor = Qt.CursorShape.ArrowCursor
    hint = ""

    def __init__(self, view: ViewControl) -> None:
        self.view = view
        self._last: QPointF | None = None
        self._start = QPointF()
        self._button = Qt.MouseButton.NoButton
        self._dragged = self._pulls = False

    def press(self, event: QMouseEvent) -> None:
        """Handle the press of a mouse button."""
        self._last = self._start = event.position()
        self._button, self._dragged = event.button(), False
        self._pulls = event.button() == Qt.MouseButton.LeftButton and self.view.grasp(event.position())

    def move(self, event: QMouseEvent) -> None:
        """Handle a motion of the mouse: turn or move the view, or drag what is held."""
        at = event.position()
        if self._last is None:
            self.view.point_at(at)
            return
        if not self._dragged and (at - self._start).manhattanLength() < CLICK:
            return
        self._dragged = True
        step, self._last = at - self._last, at
        shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if self._pulls:
            self.view.pull(step.x(), step.y())
        elif self._button == Qt.MouseButton.RightButton or (self._button == Qt.MouseButton.LeftButton and shift):
            self.view.pan(step.x(), step.y())
        elif self._button == Qt.MouseButton.LeftButton:
            self.view.orbit(step.x(), step.y())
        else:
            self.view.zoom(1.01 ** -step.y(), self._start)

    def release(self, event: QMouseEvent) -> None:
        """Handle the release of a mouse button."""
        clicked = self._last is not None and not self._dragged and event.button() == Qt.MouseButton.LeftButton
        self._last = None
        if self._pulls and self._dragged:
            self.view.drop()
        if clicked:
            self.click(event.position())

    def click(self, at: QPointF) -> None:
        """Handle a left click without a drag: choose the callout there."""
        self.view.choose(at)

    def double_click(self, event: QMouseEvent) -> None:
        """Turn the view about the point under the cursor; a callout there goes back to its first place."""
        self.view.centre_on(event.position())

    def wheel(self, event: QWheelEvent) -> None:
        """Zoom the view towards the cursor."""
        self.view.zoom(1.0015 ** event.angleDelta().y(), event.position())

    def key(self, event: QKeyEvent) -> bool:
        """Handle a key; False if it has no meaning for the tool."""
        if event.key() in ARROWS:
            dx, dy = ARROWS[Qt.Key(event.key())]
            if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
                self.view.pan(dx, dy)
            else:
                self.view.orbit(dx, dy)
            return True
        if event.key() in (Qt.Key.Key_Plus, Qt.Key.Key_Equal, Qt.Key.Key_Minus):
            self.view.zoom(0.8 if event.key() == Qt.Key.Key_Minus else 1.25)
            return True
        return False

    def paint(self, painter: QPainter, colours: OverlayColours) -> None:
        """Paint over the scene what the tool draws."""


class Pick(Navigate):
    """Tool to choose a point by a click; else as `Navigate`."""

    cursor = Qt.CursorShape.CrossCursor

    def __init__(self, view: ViewControl) -> None:
        super().__init__(view)
        self.hint = tr("Click a point of the cloud. Drag to turn the view, Esc ends.")

    def click(self, at: QPointF) -> None:
        self.view.pick(at)

    def key(self, event: QKeyEvent) -> bool:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.view.take()
            return True
        return super().key(event)

    def double_click(self, event: QMouseEvent) -> None:
        """Do nothing, so that two clicks on a point choose it once."""


class Polygon(Navigate):
    """Tool to draw a region: each click is a corner; a double click, Enter, or the first corner closes it."""

    cursor = Qt.CursorShape.CrossCursor

    def __init__(self, view: ViewControl) -> None:
        super().__init__(view)
        self.hint = tr(
            "Click the corners of the region. Double click closes it, Backspace takes one back, Esc cancels."
        )
        self._corners: list[QPointF] = []
        self._cursor = QPointF()

    def press(self, event: QMouseEvent) -> None:
        if not self._corners and event.button() != Qt.MouseButton.LeftButton:
            super().press(event)  # the view can be turned until the first corner is there
            return
        if event.button() != Qt.MouseButton.LeftButton:
            return
        at = event.position()
        if len(self._corners) >= 3 and (at - self._corners[0]).manhattanLength() < CLOSE_TO:
            self._finish()
            return
        self._corners.append(at)
        self._cursor = at
        self.view.repaint_tool()

    def move(self, event: QMouseEvent) -> None:
        super().move(event)
        self._cursor = event.position()
        if self._corners:
            self.view.repaint_tool()

    def release(self, event: QMouseEvent) -> None:
        self._last = None

    def double_click(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._finish()

    def wheel(self, event: QWheelEvent) -> None:
        if not self._corners:
            super().wheel(event)

    def key(self, event: QKeyEvent) -> bool:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finish()
            return True
        if event.key() == Qt.Key.Key_Backspace:
            self._corners = self._corners[:-1]
            self.view.repaint_tool()
            return True
        return super().key(event) if not self._corners else False

    def paint(self, painter: QPainter, colours: OverlayColours) -> None:
        if self._corners:
            paint_outline(painter, [*self._corners, self._cursor], colours, closed=False)
            painter.setBrush(colours.accent)
            for corner in self._corners:
                painter.drawEllipse(corner, 3.5, 3.5)

    def _finish(self) -> None:
        corners, self._corners = self._corners, []
        if len(corners) >= 3:
            self.view.choose_region(corners)
        else:
            self.view.repaint_tool()


class Lasso(Polygon):
    """Tool to draw a region: its outline follows the mouse while the button is down."""

    def __init__(self, view: ViewControl) -> None:
        super().__init__(view)
        self.hint = tr("Draw round the region with the mouse button held down. Esc cancels.")

    def press(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._corners = [event.position()]
        elif not self._corners:
            super().press(event)

    def move(self, event: QMouseEvent) -> None:
        if not self._corners:
            super().move(event)
        elif (event.position() - self._corners[-1]).manhattanLength() >= 2:
            self._corners.append(event.position())
            self._cursor = event.position()
            self.view.repaint_tool()

    def release(self, event: QMouseEvent) -> None:
        self._last = None
        if event.button() == Qt.MouseButton.LeftButton:
            self._finish()

    def double_click(self, event: QMouseEvent) -> None:
        """Do nothing, as an outline is closed by releasing the button."""

    def paint(self, painter: QPainter, colours: OverlayColours) -> None:
        if self._corners:
            paint_outline(painter, self._corners, colours, closed=True)
