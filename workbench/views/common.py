"""Small things that many views need: style sheets by theme, the frame of the focus, pictures of widgets, paths."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QLocale, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QGuiApplication, QPainter, QPaintEvent, QPen, QValidator, QWheelEvent
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QFileDialog, QLabel, QSlider, QWidget

from core.messages import MINUS
from workbench.language import number, tr
from workbench.theme import icon, shades
from workbench.views.colours import Level


def dress(widget: QWidget, sheet: str) -> None:
    """Set the style sheet of a widget, unless it has this sheet already."""
    if widget.styleSheet() != sheet:
        widget.setStyleSheet(sheet)


def dress_edged(widget: QWidget, colour: str) -> None:
    """Style a widget as a panel with a coloured left edge; `colour` is a field of the theme's colours."""
    s = shades()
    dress(
        widget,
        f"{type(widget).__name__} {{ background: {s.panel}; border: 1px solid {s.line};"
        f" border-left: 4px solid {getattr(s, colour)}; border-radius: 4px; }}",
    )


def grade_words() -> dict[Level, str]:
    """Return the displayed word for each level of a grade, as "good"."""
    return {"": "", "good": tr("good"), "warn": tr("fair"), "bad": tr("poor")}


class IconLabel(QLabel):
    """Label with an icon of so many pixels that follows the theme."""

    def __init__(self, side: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._side = side
        self.shown = ("", "")
        """Name and colour of the icon, as `theme.icon` takes them; "" for none."""
        self.setFixedWidth(side)

    def show_icon(self, name: str, colour: str = "") -> None:
        """Show the icon called `name`; "" shows none, and the label takes no height."""
        if (name, colour) != self.shown:
            self.shown = name, colour
            self.updateGeometry()
            self.update()

    def sizeHint(self) -> QSize:
        return QSize(self._side, self._side if self.shown[0] else 0)

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def paintEvent(self, event: QPaintEvent) -> None:
        name, colour = self.shown
        if name:
            place = QRect(0, (self.height() - self._side) // 2, self._side, self._side)
            painter = QPainter(self)
            icon(name, colour=colour).paint(painter, place)
            painter.end()


def inner_edge(widget: QWidget) -> QRectF:
    """Return the rectangle for a frame of one pixel within a widget, half a pixel inside its edge."""
    return QRectF(widget.rect()).adjusted(0.5, 0.5, -0.5, -0.5)


def draw_focus(widget: QWidget) -> None:
    """Draw the focus frame of a widget if it has the focus; call it while the widget is painted."""
    if widget.hasFocus():
        painter = QPainter(widget)
        painter.setPen(QPen(QColor(shades().muted), 1.0, Qt.PenStyle.DashLine))  # the accent is for what is chosen
        painter.drawRect(inner_edge(widget))
        painter.end()


def copy_picture(widget: QWidget) -> None:
    """Copy a picture of the widget to the clipboard."""
    QGuiApplication.clipboard().setPixmap(widget.grab())


def save_picture(widget: QWidget, title: str, name: str) -> None:
    """Ask for a file and write a picture of the widget to it; `name` is the file name proposed."""
    kinds = tr("Picture (*.png)")
    path, _ = QFileDialog.getSaveFileName(widget, title, name, kinds)
    if path:
        widget.grab().save(path)


def breakable(path: str) -> str:
    """Return a path as text that can be wrapped after each separator."""
    return path.replace("/", "/\u200b").replace("\\", "\\\u200b")


class WheelIfFocused:
    """Field that the wheel changes only while it has the focus; else the wheel scrolls what is around it."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        field: Any = self
        field.setFocusPolicy(Qt.FocusPolicy.StrongFocus)  # the wheel does not choose it

    def wheelEvent(self, event: QWheelEvent) -> None:
        field: Any = self
        if field.hasFocus():
            super().wheelEvent(event)  # type: ignore[misc]
        else:
            event.ignore()


class Choice(WheelIfFocused, QComboBox):
    """Choice of one of several."""


class Slider(WheelIfFocused, QSlider):
    """Slider between two ends."""


class SpinBox(WheelIfFocused, QDoubleSpinBox):
    """Number in the window's language; it can be typed with either decimal sign and either minus."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setLocale(QLocale.c())  # which texts are numbers, once their signs are Qt's

    def textFromValue(self, value: float) -> str:
        return number(value, f".{self.decimals()}f")

    def validate(self, text: str, position: int) -> tuple[QValidator.State, str, int]:
        state, _, _ = super().validate(_as_qt_reads(text), position)
        return state, text, position

    def valueFromText(self, text: str) -> float:
        return super().valueFromText(_as_qt_reads(text))

    def fixup(self, text: str) -> str:
        return super().fixup(_as_qt_reads(text))


def _as_qt_reads(text: str) -> str:
    return text.replace(",", ".").replace(MINUS, "-")
