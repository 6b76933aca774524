"""The messages panel, and the banner that shows the newest one."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QModelIndex, QObject, Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import (
    QFrame,
    QLabel,
    QListView,
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
from workbench.views.lists.tree_model import Cell, TreeModel, TreeRow

SYMBOLS = {
    "info": ("mdi6.information-outline", "accent"),
    "warning": ("mdi6.alert-outline", "warn"),
    "error": ("mdi6.alert-octagon-outline", "bad"),
}


class NoticeList(QWidget):
    """List of all messages of the session with their details; it copies to the clipboard."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._notices: list[tuple[TreeRow, str, str]] = []
        self._list = QListView()
        self._model = TreeModel(self)
        self._list.setModel(self._model)
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
        self._list.selectionModel().currentChanged.connect(self._show)

    def add(self, level: str, text: str, details: str, when: str) -> None:
        """Append a message to the list and scroll to it."""
        symbol, colour = SYMBOLS[level]
        row = TreeRow(str(len(self._notices)), (Cell(f"{when}   {text}", icon=icon(symbol, colour=colour)),))
        self._notices.append((row, text, details))
        self._model.set_rows([row for row, _, _ in self._notices])
        self._list.setCurrentIndex(self._model.index_of(row.key))

    def count(self) -> int:
        """Return how many messages the list has."""
        return len(self._notices)

    def _show(self, index: QModelIndex) -> None:
        self._details.setPlainText(self._notices[index.row()][2] if index.isValid() else "")

    def _copy(self) -> None:
        index = self._list.currentIndex()
        if index.isValid():
            _, text, details = self._notices[index.row()]
            QGuiApplication.clipboard().setText("\n".join(part for part in (text, details) if part))

    def _clear(self) -> None:
        self._model.set_rows(())
        self._notices = []


class Banner(QFrame):
    """Banner of an important message across the top of `page` and over it: nothing moves as it appears.

    It stays until closed or replaced. Of `head`, the line of the page's title, it covers all, however short it is.
    """

    def __init__(self, page: QWidget, head: QWidget | None = None) -> None:
        super().__init__(page)
        self._page, self._head = page, head
        for widget in filter(None, (page, head)):
            widget.installEventFilter(self)
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
        """Show a message across the top of the page, in place of an earlier one."""
        self._level, self._text, self._more = level, text, details
        self._label.setText(text)
        self._copy.setVisible(bool(details))
        self._dress()
        self.show()
        self._place()

    def text(self) -> str:
        """Return the message that the banner shows."""
        return self._text if not self.isHidden() else ""

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Resize and watched in (self._page, self._head):
            self._place()
        return super().eventFilter(watched, event)

    def event(self, event: QEvent) -> bool:
        if event.type() == QEvent.Type.LayoutRequest:  # its words, or their font, are others
            self._place()
        return super().event(event)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self._text:
            self._dress()

    def _place(self) -> None:
        if not self.isHidden():
            width, head = self._page.width(), self._head
            of_head = head.geometry().bottom() + 1 if head is not None and not head.isHidden() else 0
            self.setGeometry(0, 0, width, max(self.heightForWidth(width), self.minimumSizeHint().height(), of_head))
            self.raise_()

    def _dress(self) -> None:
        symbol, colour = SYMBOLS[self._level]
        dress_edged(self, colour)
        self._symbol.show_icon(symbol, colour)
