"""What stands where there is nothing to show yet: one sentence, and a button when something can be done about it."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from workbench.views.layouts import enable, set_text

_WIDEST, _MARGIN = 440, 12
"""Pixels: the widest that the sentence gets, and what is left free beside it at least."""


class EmptyState(QWidget):
    """Sentence in the middle, with an optional button."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._on_button: Callable[[], None] | None = None
        self._label = QLabel()
        self._label.setObjectName("muted")
        self._label.setWordWrap(True)
        self._label.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.button = QPushButton()
        self.button.clicked.connect(self._pressed)
        self._column = column = QVBoxLayout(self)
        column.setSpacing(12)
        column.addStretch(1)
        column.addWidget(self._label)
        column.addWidget(self.button, 0, Qt.AlignmentFlag.AlignHCenter)
        column.addStretch(1)

    def set_text(
        self, message: str, button: str = "", on_button: Callable[[], None] | None = None, why_not: str = ""
    ) -> None:
        """Show a sentence, and a button if `button` is its text; the reason `why_not` disables the button."""
        self._label.setText(message)
        set_text(self.button, button)
        enable(self.button, why_not, "")
        self._on_button = on_button

    @property
    def message(self) -> str:
        """Sentence that is shown where there is nothing else to show."""
        return self._label.text()

    def resizeEvent(self, event: QResizeEvent) -> None:
        side = max(_MARGIN, (event.size().width() - _WIDEST) // 2)
        self._column.setContentsMargins(side, 8, side, 8)
        super().resizeEvent(event)

    def minimumSizeHint(self) -> QSize:
        """Return the least size, without the margins, which shrink with the width."""
        hint, margins = super().minimumSizeHint(), self._column.contentsMargins()
        return QSize(hint.width() - margins.left() - margins.right() + 2 * _MARGIN, hint.height())

    def _pressed(self) -> None:
        if self._on_button is not None:
            self._on_button()
