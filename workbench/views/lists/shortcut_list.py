"""The list of keys shown under ?."""

from __future__ import annotations

import re
from collections.abc import Sequence

from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QGridLayout, QLabel, QWidget

from workbench.language import tr
from workbench.views.layouts import in_column

MEANING_WIDTH = 245
"""Pixels of what a key does; longer words are wrapped, so that both columns fit a small screen."""


class ShortcutList(QDialog):
    """List of all keys and what they do."""

    def __init__(self, keys: Sequence[tuple[str, str]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr("Keys"))
        grid = QGridLayout()
        grid.setHorizontalSpacing(24)
        half = (len(keys) + 1) // 2
        for place, (key, meaning) in enumerate(keys):
            row, column = place % half, 2 * (place // half)
            name = QLabel(native(key))
            name.setObjectName("heading")
            grid.addWidget(name, row, column)
            what = QLabel(meaning)
            what.setWordWrap(True)
            what.setMinimumWidth(MEANING_WIDTH)
            grid.addWidget(what, row, column + 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        in_column(grid, buttons, on=self, margins=(18, 16, 18, 12))


def native(keys: str) -> str:
    """Write keys as this system and the window's language name them: "Left, Ctrl+M" is "Links, Strg+M"."""
    return re.sub(r"[^\s,…]+", lambda key: QKeySequence(key[0]).toString(QKeySequence.SequenceFormat.NativeText), keys)
