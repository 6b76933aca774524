"""The small tool bar of the 3D view: standard views, fit, projection, grid, save."""

from __future__ import annotations

from typing import Literal

import qtawesome
from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAction,
    QColor,
    QGuiApplication,
    QIcon,
    QKeySequence,
    QPainter,
    QPalette,
    QPen,
    QPixmap,
    QPolygonF,
)
from PySide6.QtWidgets import QToolBar, QToolButton, QWidget

from workbench.language import tr

ViewName = Literal["front", "back", "left", "right", "top", "bottom", "iso", "camera"]

ICON_PX = 20
"""Side of an icon in logical pixels; the cube below is drawn in these."""

_HEX = [
    QPointF(10, 1.8),
    QPointF(17.2, 5.9),
    QPointF(17.2, 14.1),
    QPointF(10, 18.2),
    QPointF(2.8, 14.1),
    QPointF(2.8, 5.9),
]
_MIDDLE, _HIDDEN = QPointF(10, 10), QPointF(10, 10)

_FACES: dict[str, tuple[list[QPointF], bool]] = {
    "top": ([_HEX[0], _HEX[1], _MIDDLE, _HEX[5]], False),
    "front": ([_HEX[5], _MIDDLE, _HEX[3], _HEX[4]], False),
    "right": ([_MIDDLE, _HEX[1], _HEX[2], _HEX[3]], False),
    "bottom": ([_HEX[4], _HIDDEN, _HEX[2], _HEX[3]], True),
    "back": ([_HEX[0], _HEX[1], _HEX[2], _HIDDEN], True),
    "left": ([_HEX[5], _HEX[0], _HIDDEN, _HEX[4]], True),
}
"""Faces of a cube seen from the upper right front; the last three are seen through it."""


class SceneButtons(QToolBar):
    """Tool bar of buttons with keys; the keys work while the 3D view has the focus."""

    view_asked = Signal(str)
    fit_asked = Signal()
    parallel_asked = Signal(bool)
    grid_asked = Signal(bool)
    save_asked = Signal()

    def __init__(self, owner: QWidget) -> None:
        super().__init__(owner)
        self.setObjectName("sceneButtons")
        self.setIconSize(QSize(ICON_PX, ICON_PX))
        self.setMovable(False)
        self._owner = owner
        names = {
            "front": (tr("Front view"), "1"),
            "back": (tr("Back view"), "2"),
            "left": (tr("View from the left"), "3"),
            "right": (tr("View from the right"), "4"),
            "top": (tr("View from above"), "5"),
            "bottom": (tr("View from below"), "6"),
            "iso": (tr("View from a corner"), "7"),
            "camera": (tr("What the camera sees"), "8"),
        }
        self._actions: dict[str, QAction] = {}
        self._tools_end: QAction | None = None
        self._symbols = {
            "iso": "mdi6.cube-outline",
            "camera": "mdi6.camera-outline",
            "fit": "mdi6.fit-to-screen-outline",
            "parallel": "mdi6.rectangle-outline",
            "grid": "mdi6.grid",
            "save": "mdi6.content-save-outline",
        }
        for view, (text, key) in names.items():
            self._add(view, text, key).triggered.connect(lambda _=False, view=view: self.view_asked.emit(view))
        self.addSeparator()
        self._add("fit", tr("Show everything"), "R").triggered.connect(self.fit_asked)
        self.parallel = self._add("parallel", tr("Parallel projection: equal lengths look equal"), "P", checkable=True)
        self.parallel.toggled.connect(self.parallel_asked)
        self.grid = self._add("grid", tr("Millimetre grid"), "G", checkable=True)
        self.grid.toggled.connect(self.grid_asked)
        self.addSeparator()
        self._add("save", tr("Save this picture"), "Ctrl+Shift+S").triggered.connect(self.save_asked)
        self.dress()

    def action(self, name: str) -> QAction:
        """Return the action of the button called `name`: of a standard view, "fit", "parallel", "grid" or "save"."""
        return self._actions[name]

    def add_tool(self, text: str, key: str, symbol: str) -> QAction:
        """Add a checkable button, with a key and an icon, before the other buttons; return its action."""
        if self._tools_end is None:
            self._tools_end = self.insertSeparator(self._actions["front"])
        action = self._add(symbol, text, key, checkable=True)
        self.insertAction(self._tools_end, action)
        self._symbols[symbol] = symbol
        self.dress()
        return action

    def dress(self) -> None:
        """Draw the icons of all buttons in the colours of the theme."""
        role = QPalette.ColorRole
        palette = QGuiApplication.palette()  # the bar's own is told of a new theme after the view it belongs to
        text, accent = palette.color(role.WindowText), palette.color(role.Highlight)
        for name, action in self._actions.items():
            if name in _FACES:
                action.setIcon(_cube_icon(name, text, accent, self.devicePixelRatioF()))
            else:
                action.setIcon(qtawesome.icon(self._symbols[name], color=text, color_on=accent))

        more = self.findChild(QToolButton, "qt_toolbar_ext_button")
        if more is not None:  # what there is no room for is behind it; the style draws it black on any theme
            more.setIcon(qtawesome.icon("mdi6.chevron-double-right", color=text))
            more.setToolTip(tr("More buttons"))

    def _add(self, name: str, text: str, key: str, *, checkable: bool = False) -> QAction:
        action = QAction(text, self)
        action.setCheckable(checkable)
        action.setShortcut(QKeySequence(key))
        action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        shown = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
        action.setToolTip(tr("{what} ({key})", what=text, key=shown))
        self.addAction(action)
        self._owner.addAction(action)  # its keys work anywhere in the view
        self._actions[name] = action
        return action


def _cube_icon(face: str, line: QColor, accent: QColor, ratio: float) -> QIcon:
    """A cube with one face filled."""
    pixmap = QPixmap(round(ICON_PX * ratio), round(ICON_PX * ratio))
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    corners, behind = _FACES[face]
    filled = QColor(accent)
    filled.setAlpha(150 if behind else 230)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(filled)
    painter.drawPolygon(QPolygonF(corners))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(line, 1.1, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap, Qt.PenJoinStyle.RoundJoin))
    painter.drawPolygon(QPolygonF(_HEX))
    spokes = (_HEX[0], _HEX[2], _HEX[4]) if behind else (_HEX[1], _HEX[3], _HEX[5])
    for spoke in spokes:
        painter.drawLine(_MIDDLE, spoke)
    painter.end()
    return QIcon(pixmap)
