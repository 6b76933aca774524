"""A sentence over a picture with a button that does what it offers."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QWidget

from workbench.views.layouts import in_row

_SHARE = 0.9  # of the picture's width that it takes at most


class Offer(QFrame):
    """Offer over the top of the picture: nothing moves as it appears and disappears. It can be read from the rig."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._picture = parent
        self._do: Callable[[], None] | None = None
        self.label, self.button = QLabel(), QPushButton()
        self.label.setWordWrap(True)
        self.label.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.label.setStyleSheet("color: #F4F6F8; font-size: 20px;")
        self.button.setProperty("primary", True)
        self.button.clicked.connect(lambda: self._take())
        in_row((self.label, 1), self.button, on=self, margins=(14, 10, 14, 10), spacing=14)
        self.setObjectName("offer")
        self.setStyleSheet("#offer { background: rgba(12, 16, 20, 215); border-radius: 6px; }")
        self.hide()

    def set_offer(self, sentence: str, button: str = "", do: Callable[[], None] | None = None) -> None:
        """Show a sentence and a button that calls `do`; "" hides the offer."""
        self._do = do
        self.setVisible(bool(sentence))
        if (sentence, button) != (self.label.text(), self.button.text()):
            self.label.setText(sentence)
            self.button.setText(button)
            self.place()

    def place(self) -> None:
        """Move the offer to the top of the picture, in its middle."""
        width = self._picture.width()
        words = self.label.fontMetrics().horizontalAdvance(self.label.text())
        self.setFixedWidth(min(round(_SHARE * width), words + self.button.sizeHint().width() + 60))
        self.adjustSize()
        self.move((width - self.width()) // 2, 12)

    def _take(self) -> None:
        if self._do is not None:
            self._do()
