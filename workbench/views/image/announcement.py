"""A sentence in large letters over a picture, to be read from the rig."""

from __future__ import annotations

import time

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QLabel, QWidget

STAYS_MS = 2000
"""A sentence stands for so long, and longer while it is said again."""

_SHARE = 0.8  # of the picture's width that it takes at most


class Announcement(QLabel):
    """Sentence at the top of the picture; one that comes while another is shown waits, and only the last of them."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._picture = parent
        self._waiting = ""
        self._since = 0.0
        self._clock = QTimer(self)
        self._clock.setSingleShot(True)
        self._clock.timeout.connect(self._next)
        self.setWordWrap(True)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setStyleSheet(
            "background: rgba(12, 16, 20, 215); color: #F4F6F8; border-radius: 6px; padding: 10px; font-size: 26px;"
        )
        self.hide()

    def set_text(self, sentence: str) -> None:
        """Show a sentence for a while, after the one shown now; "" shows none."""
        stood_ms = 1000 * (time.monotonic() - self._since)
        if sentence == self.text() and not self.isHidden():
            self._waiting = ""
            self._clock.start(STAYS_MS)
        elif self.isHidden() or stood_ms >= STAYS_MS:
            self._show(sentence)
        else:
            self._waiting = sentence
            self._clock.start(round(STAYS_MS - stood_ms))

    def place(self) -> None:
        """Move the announcement to the top of the picture, in its middle."""
        width = self._picture.width()
        self.setFixedWidth(min(round(_SHARE * width), self.fontMetrics().horizontalAdvance(self.text()) + 48))
        self.adjustSize()
        self.move((width - self.width()) // 2, 12)

    def _next(self) -> None:
        sentence, self._waiting = self._waiting, ""
        self._show(sentence)

    def _show(self, sentence: str) -> None:
        self.setText(sentence)
        self.setVisible(bool(sentence))
        if sentence:
            self._since = time.monotonic()
            self._clock.start(STAYS_MS)
            self.place()
