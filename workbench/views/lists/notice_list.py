"""The messages panel, and the banner that shows the newest one."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import (
    QFrame,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPlainTextEdit,
    QPushButton,
    QSplitter,
    QToolButton,
    QWidget,
)

from workbench.language import tr
from workbench.theme import icon
from workbench.views.common import IconLabel, dress_edged
from workbench.views.layouts import STRETCH, in_column, in_row

SYMBOLS = {
    "info": ("mdi6.information-outline", "accent"),
    "warning": ("mdi6.alert-outline", "warn"),
    "error": ("mdi6.alert-octagon-outline", "bad"),
}


class NoticeList(QWidget):
    """All messages of the session with their details; copies to the clipboard."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._list = QListWidget()
        self._list.setAccessibleName(tr("Messages"))
        self._list.setWordWrap(True)
        self._details = QPlainTextEdit()
        self._details.setReadOnly(True)
        self._details.setPlaceholderText(tr("Details of the chosen message"))
        copy = QPushButton(tr("Copy"))
        copy.setToolTip(tr("Copy the chosen message and its details"))
        copy.clicked.connect(self._copy)
        clear = QPushButton(tr("Clear"))
        clear.setToolTip(tr("Empty this list; the log file keeps everything"))
        clear.clicked.connect(self._clear)
        buttons = in_column(copy, clear, STRETCH)
        split = QSplitter(Qt.Orientation.Horizontal)
        split.addWidget(self._list)
        split.addWidget(self._details)
        split.setSizes([600, 300])
        in_row((split, 1), buttons, on=self, margins=(6, 4, 6, 4))
        self._list.currentItemChanged.connect(lambda item, _: self._show(item))

    def add(self, level: str, text: str, details: str, when: str) -> None:
        """Append a message and show it."""
        symbol, colour = SYMBOLS[level]
        item = QListWidgetItem(icon(symbol, colour=colour), f"{when}   {text}")
        item.setData(Qt.ItemDataRole.UserRole, (text, details))
        self._list.addItem(item)
        self._list.scrollToItem(item)
        self._list.setCurrentItem(item)

    def count(self) -> int:
        """How many messages are listed."""
        return self._list.count()

    def _show(self, item: QListWidgetItem | None) -> None:
        self._details.setPlainText(item.data(Qt.ItemDataRole.UserRole)[1] if item else "")

    def _copy(self) -> None:
        item = self._list.currentItem()
        if item is not None:
            QGuiApplication.clipboard().setText("\n".join(part for part in item.data(Qt.ItemDataRole.UserRole) if part))

    def _clear(self) -> None:
        self._list.clear()
        self._details.clear()


class Banner(QFrame):
    """One line across the page for what must not be overlooked; it stays until closed or replaced."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._level, self._text, self._more = "info", "", ""
        self._symbol = IconLabel(18)
        self._label = QLabel()
        self._label.setWordWrap(True)
        self._label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._copy = QPushButton(tr("Copy details"))
        self._copy.clicked.connect(lambda: QGuiApplication.clipboard().setText(f"{self._text}\n{self._more}".strip()))
        close = QToolButton()
        close.setText("✕")
        close.setAutoRaise(True)
        close.setToolTip(tr("Close this message; it stays in the messages panel"))
        close.clicked.connect(self.hide)
        in_row(self._symbol, (self._label, 1), self._copy, close, on=self, margins=(10, 5, 6, 5))
        self.hide()

    def show_notice(self, level: str, text: str, details: str) -> None:
        """Show a message."""
        self._level, self._text, self._more = level, text, details
        self._label.setText(text)
        self._copy.setVisible(bool(details))
        self._dress()
        self.show()

    def text(self) -> str:
        """The message shown."""
        return self._text if not self.isHidden() else ""

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self._text:
            self._dress()

    def _dress(self) -> None:
        symbol, colour = SYMBOLS[self._level]
        dress_edged(self, colour)
        self._symbol.show_icon(symbol, colour)
