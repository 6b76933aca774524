"""One instruction across the window, which waits until it is followed; it can be left at any time."""

from __future__ import annotations

from collections.abc import Iterable

from PySide6.QtCore import QEvent, Signal
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QToolButton, QWidget

from workbench.language import tr
from workbench.views.common import IconLabel, dress_edged
from workbench.views.layouts import RoomySentence, in_row


class InstructionBar(QFrame):
    """Bar with an instruction, its number, a button that shows where, and one that ends them.

    It has room for the longest of `texts`: the page below it stays where it is as one follows the other.
    """

    show_me = Signal()
    left = Signal()

    def __init__(self, texts: Iterable[str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._symbol, self._place, self.words = IconLabel(18), QLabel(), RoomySentence(texts)
        self._place.setObjectName("heading")
        self.show_button = QPushButton(tr("Show me"))
        self.show_button.setToolTip(tr("Go to the page, and to the button that is meant"))
        self.show_button.clicked.connect(self.show_me)
        room = self.show_button.sizePolicy()
        room.setRetainSizeWhenHidden(True)
        self.show_button.setSizePolicy(room)
        self.leave_button = QToolButton()
        self.leave_button.setText("✕")
        self.leave_button.setAutoRaise(True)
        self.leave_button.setAccessibleName(tr("Leave the first measurement"))
        self.leave_button.setToolTip(tr("Leave the first measurement; Help has it again"))
        self.leave_button.clicked.connect(self.left)
        parts = (self._symbol, self._place, (self.words, 1), self.show_button, self.leave_button)
        in_row(*parts, on=self, margins=(10, 5, 6, 5), spacing=8)
        self.hide()

    def show_instruction(self, number: int, count: int, text: str, *, can_show: bool) -> None:
        """Show instruction `number` of `count`; `can_show` adds the button that shows where to press."""
        self._place.setText(tr("{number} of {count}", number=number, count=count))
        self.words.setText(text)
        self.show_button.setVisible(can_show)
        self._dress()
        self.show()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and not self.isHidden():
            self._dress()

    def _dress(self) -> None:
        dress_edged(self, "accent")
        self._symbol.show_icon("mdi6.school-outline", "accent")
