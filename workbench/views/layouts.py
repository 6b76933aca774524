"""How widgets are put together: rows and columns, titles, explaining sentences, buttons that say why they are grey."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, TypeVar

from PySide6.QtCore import QEvent, QObject, QRect, QSize, Qt, Signal
from PySide6.QtGui import QAction, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractButton,
    QBoxLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLayout,
    QScrollArea,
    QScrollBar,
    QStyle,
    QTabBar,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)
from superqt import QElidingLabel

from core.findings.table import gravest_first, is_grave
from core.messages import Message, unparted
from workbench.language import text_of

NO_MARGINS = (0, 0, 0, 0)
"""Pixels left, above, right and below."""
STRETCH: Final = None
"""A part that is nothing but room."""

Box = TypeVar("Box", bound=QBoxLayout)
Part = QWidget | QLayout | tuple[QWidget | QLayout, int] | None
"""What stands in a row or column; with a number, it takes that share of the room that is left."""


def in_column(
    *parts: Part,
    on: QWidget | None = None,
    margins: tuple[int, int, int, int] = NO_MARGINS,
    spacing: int | None = None,
) -> QVBoxLayout:
    """Lay out widgets, layouts and gaps one below the other, on the widget `on` if given; return the layout."""
    return _filled(QVBoxLayout(on) if on is not None else QVBoxLayout(), parts, margins, spacing)


def in_row(
    *parts: Part,
    on: QWidget | None = None,
    margins: tuple[int, int, int, int] = NO_MARGINS,
    spacing: int | None = None,
) -> QHBoxLayout:
    """Lay out widgets, layouts and gaps side by side, on the widget `on` if given; return the layout."""
    return _filled(QHBoxLayout(on) if on is not None else QHBoxLayout(), parts, margins, spacing)


def holding(layout: QLayout) -> QWidget:
    """Make a widget that has this layout."""
    widget = QWidget()
    widget.setLayout(layout)
    return widget


class _QuietBar(QScrollBar):
    """Where there is nothing to scroll, nothing is seen of it but its room."""

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Vertical)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent, False)

    def paintEvent(self, event: QPaintEvent) -> None:
        if self.maximum() > self.minimum():
            super().paintEvent(event)


class UpAndDown(QScrollArea):
    """Scroll area for up and down only: it is never narrower than its content, which would be cut off.

    With `steady` its bar has room even where there is nothing to scroll: as there is, no sentence is wrapped anew.
    """

    fitted = Signal()
    """It has another size, or what is in it wants another one."""

    def __init__(self, widget: QWidget, least_width: int = 0, *, steady: bool = False) -> None:
        super().__init__()
        if steady:
            self.setVerticalScrollBar(_QuietBar())
            self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOn)
        self._least_width = least_width
        self.setWidget(widget)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFrameShape(QFrame.Shape.NoFrame)

    def minimumSizeHint(self) -> QSize:
        hint, inside = super().minimumSizeHint(), self.widget()
        assert inside is not None
        needed = inside.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width()
        return QSize(max(self._least_width, needed), hint.height())

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.LayoutRequest and watched is self.widget():
            self.updateGeometry()
            self.fitted.emit()
        return super().eventFilter(watched, event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.fitted.emit()

    def lacking(self) -> int:
        """Return by how many px the content is higher than the area; negative: how many px are free."""
        inside = self.widget()
        layout = inside.layout() if inside is not None else None
        if inside is None or layout is None:
            return 0
        width = max(self.viewport().width(), inside.minimumSizeHint().width())
        height = layout.totalHeightForWidth(width) if layout.hasHeightForWidth() else inside.minimumSizeHint().height()
        return height - self.viewport().height()


class Folding(QWidget):
    """Parts side by side; one below the other where they have no room for that, as in a language of long words.

    The first one takes `share` times as much of the room that is left as each of the others.
    """

    def __init__(self, *parts: QLayout, spacing: int, share: int = 1) -> None:
        super().__init__()
        self._parts = tuple(holding(part) for part in parts)
        self._box = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        self._box.setContentsMargins(*NO_MARGINS)
        self._box.setSpacing(spacing)
        for part in self._parts:
            self._box.addWidget(part, 1 if self._box.count() else share)

    def part(self, number: int) -> QWidget:
        """Return the widget that holds part `number`, so that it can be hidden."""
        return self._parts[number]

    def minimumSizeHint(self) -> QSize:
        """Return the least size: the width of the widest part."""
        return QSize(max(self._widths()), super().minimumSizeHint().height())

    def event(self, event: QEvent) -> bool:
        if event.type() == QEvent.Type.LayoutRequest:  # what is in it wants more room, or less
            self._fold()
        return super().event(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fold()

    def _fold(self) -> None:
        side_by_side = sum(self._widths()) + self._box.spacing() * (len(self._parts) - 1)
        folded = side_by_side > self.width()
        direction = QBoxLayout.Direction.TopToBottom if folded else QBoxLayout.Direction.LeftToRight
        if self._box.direction() != direction:
            self._box.setDirection(direction)

    def _widths(self) -> list[int]:
        return [part.minimumSizeHint().width() for part in self._parts if not part.isHidden()]


def resize_on_screen(window: QWidget, width: int, height: int) -> None:
    """Resize a window to a width and height in px, or to what its screen has room for."""
    window.resize(QSize(width, height).boundedTo(window.screen().availableSize()))


class Elided(QElidingLabel):
    """Label cut with an ellipsis where there is no room: it widens no window. Their tip tells them whole."""

    def setText(self, text: str) -> None:
        super().setText(text)
        self.setToolTip(text)


class Tabs(QTabWidget):
    """Tabs that all stay in sight: where there is no room, their titles are cut, and their tips tell more."""

    def __init__(self) -> None:
        super().__init__()
        self.setTabBar(_TabBar())  # before anything is set that it is to keep
        self.setUsesScrollButtons(False)
        self.setElideMode(Qt.TextElideMode.ElideRight)

    def add(self, tab: QWidget, title: str, tip: str = "") -> None:
        """Add a tab with a title and a tooltip after the other tabs."""
        self.setTabToolTip(self.addTab(tab, title), tip or title)


class _TabBar(QTabBar):
    """Titles of tabs, whole ones: what Fusion lowers those in the background by, it cuts off the feet of their "g"."""

    def __init__(self) -> None:
        super().__init__()
        self.setDrawBase(False)  # as a tab widget's own

    def tabSizeHint(self, index: int) -> QSize:
        lowered = self.style().pixelMetric(QStyle.PixelMetric.PM_TabBarTabShiftVertical, None, self)
        return super().tabSizeHint(index) + QSize(0, lowered)


def heading(text: str) -> QLabel:
    """Make a label for a small heading within a panel."""
    label = QLabel(text)
    label.setObjectName("heading")
    return label


class Sentence(QLabel):
    """Label with wrapped words, with no break between a number and its unit."""

    def __init__(self, text: str = "") -> None:
        super().__init__()
        self.setWordWrap(True)
        self.setText(text)

    def setText(self, text: str) -> None:
        super().setText(unparted(text))


class RoomySentence(Sentence):
    """Label as high as the highest of the texts to come: what is below it stays in place."""

    def __init__(self, to_come: Iterable[str] = ()) -> None:
        super().__init__()
        self.to_come = tuple(to_come)

    def heightForWidth(self, width: int) -> int:
        room = QRect(0, 0, width, 10_000)
        heights = (
            self.fontMetrics().boundingRect(room, Qt.TextFlag.TextWordWrap, unparted(text)).height()
            for text in self.to_come
        )
        return max(super().heightForWidth(width), *heights, 0)


class FewLines(Sentence):
    """Label with room for so many lines, however short the sentence: what is below it stays in place.

    One that is longer takes more room; a `steady` one is cut instead, and its tip tells it whole.
    """

    def __init__(self, lines: int = 2, *, steady: bool = False) -> None:
        self._said, self._steady, self._lines = "", steady, lines
        super().__init__()
        self.setObjectName("muted")

    def set_text(self, text: str, *, steady: bool) -> None:
        """Show a text in the label; `steady`: a text that is too long is cut instead of taking more lines."""
        self._steady = steady
        self.setText(text)

    def text(self) -> str:
        """Return the text of the label in full, also if it is shown cut."""
        return self._said

    def setText(self, text: str) -> None:
        self._said = text
        self._show()

    def heightForWidth(self, width: int) -> int:
        least = self._least()
        return least if self._steady else max(least, super().heightForWidth(width))

    def sizeHint(self) -> QSize:
        return QSize(super().sizeHint().width(), self.heightForWidth(self.width()))

    def minimumSizeHint(self) -> QSize:
        return QSize(super().minimumSizeHint().width(), self._least())

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._show()

    def _least(self) -> int:
        return self._lines * self.fontMetrics().lineSpacing()

    def _show(self) -> None:
        shown = self._cut() if self._steady else self._said
        if unparted(shown) != super().text():
            super().setText(shown)
        self.setToolTip("" if shown == self._said else self._said)

    def _cut(self) -> str:
        lines = QElidingLabel.wrapText(unparted(self._said), self.width(), self.font())
        if len(lines) <= self._lines:
            return self._said
        whole, rest = "".join(lines[: self._lines - 1]), "".join(lines[self._lines - 1 :])
        return whole + self.fontMetrics().elidedText(rest, Qt.TextElideMode.ElideRight, self.width() - 2)


def muted(text: str = "") -> Sentence:
    """Make a label for an explaining sentence, in the theme's muted colour."""
    label = Sentence(text)
    label.setObjectName("muted")
    return label


def alarm() -> Sentence:
    """Make a label for a sentence in red; it takes no room while it is empty."""
    label = Sentence()
    label.setObjectName("alarm")
    label.hide()
    return label


def set_notes(notes: Iterable[Message], grave: QLabel, others: QLabel) -> None:
    """Show notes in two labels, grave ones in `grave`, the rest in `others`."""
    told = gravest_first(notes)
    for label, wanted in ((grave, True), (others, False)):
        set_text(label, "\n".join(text_of(note) for note in told if is_grave(note) is wanted))


def set_text(label: QLabel | QAbstractButton, text: str) -> None:
    """Show a text in a label or button, which is hidden while the text is ""."""
    label.setText(text)
    label.setVisible(bool(text))


def enable(button: QAbstractButton | QAction, why_not: str, tip: str) -> None:
    """Enable a button if `why_not` is ""; else disable it with that reason as its tooltip instead of `tip`.

    Greyed while it has the focus, it leaves the focus where it was: on what it stands on.
    """
    if why_not and isinstance(button, QWidget) and button.window().focusWidget() is button:
        _focus_below(button)
    button.setEnabled(not why_not)
    button.setToolTip(why_not or tip)


def mark_primary(button: QAbstractButton, primary: bool) -> None:
    """Style a button as the page's primary one, or as an ordinary one."""
    if button.property("primary") != primary:
        button.setProperty("primary", primary)
        button.style().unpolish(button)
        button.style().polish(button)


def rename(button: QAbstractButton, text: str) -> None:
    """Change the text of a button; a focused button gives up the focus, so that Space does not press the new one.

    Else the focus would lie on Stop as long as something runs that was started by that button.
    """
    if button.text() not in ("", text) and button.window().focusWidget() is button:
        _focus_below(button)
    button.setText(text)


def keep_focus(window: QWidget) -> bool:
    """Move the focus from a disabled or hidden widget to a widget that contains it; True if it was moved.

    Qt gives it to the next widget, where the next Space would press a button that nobody chose.
    """
    lost = window.focusWidget()
    if lost is None or (lost.isVisible() and lost.isEnabled()):
        return False
    _focus_below(lost)
    return True


def _focus_below(widget: QWidget) -> None:
    """Give the focus to the nearest widget around this one that can have it."""
    below = widget.parentWidget()
    while below is not None and not (below.isVisible() and below.isEnabled() and below.focusProxy() is None):
        below = below.parentWidget()
    if below is not None:
        below.setFocus()


def _filled(box: Box, parts: tuple[Part, ...], margins: tuple[int, int, int, int], spacing: int | None) -> Box:
    box.setContentsMargins(*margins)
    if spacing is not None:
        box.setSpacing(spacing)
    for part in parts:
        what, share = part if isinstance(part, tuple) else (part, 0)
        if what is None:
            box.addStretch(1)
        elif isinstance(what, QWidget):
            box.addWidget(what, share)
        else:
            box.addLayout(what, share)
    return box
