"""Results in two columns, and the verdict in one banner."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from PySide6.QtCore import QEvent, QSize, Qt
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QToolButton, QWidget

from core.messages import capital
from core.states import DECISIONS
from workbench.language import tr
from workbench.theme import shades
from workbench.views.colours import Level
from workbench.views.common import IconLabel, dress, dress_edged, grade_words
from workbench.views.layouts import Sentence, in_column, in_row, set_text

LEVEL_ICONS: dict[Level, tuple[str, str]] = {
    "good": ("mdi6.check-circle-outline", "good"),
    "warn": ("mdi6.alert-outline", "warn"),
    "bad": ("mdi6.close-octagon-outline", "bad"),
}
"""Icon and colour of each level; the shapes differ as well."""

VerdictKind = Literal["", "conforming", "not conforming", "not proven"]

VERDICT_ICONS: dict[str, tuple[str, str]] = {
    "": ("mdi6.minus-circle-outline", "muted"),
    "conforming": ("mdi6.check-decagram", "good"),
    "not conforming": ("mdi6.close-octagon", "bad"),
    "not proven": ("mdi6.help-rhombus-outline", "warn"),
}

NAME_PX = 96
"""Least width of the labels: beside a long value a short one stays in one line."""
VALUE_PX = 210
"""A value that is wider goes on in a further line: beside a label it would make the column at the side wider."""

ValueRow = tuple[str, str, str, Level]
"""Label, text with unit, tip, level."""


class ValueRows(QWidget):
    """Rows with label at the left, value with unit at the right, and an icon where a value is good or not.

    It is at least `least_width` pixels wide, and never narrower than its values, of which long ones take several lines.
    Further rows are folded.
    """

    def __init__(self, parent: QWidget | None = None, *, least_width: int = 0) -> None:
        super().__init__(parent)
        self._least_width = least_width
        self._rows: tuple[ValueRow, ...] = ()
        self._in_sight = 0
        self._labels: list[tuple[QLabel, QLabel, IconLabel]] = []
        self.more = QToolButton()
        self.more.setCheckable(True)
        self.more.setAutoRaise(True)
        self.more.toggled.connect(self._fold)
        self._grid = QGridLayout()
        self._grid.setHorizontalSpacing(8)
        self._grid.setVerticalSpacing(3)
        self._grid.setColumnStretch(0, 1)
        self._grid.setColumnMinimumWidth(0, NAME_PX)
        column = in_column(on=self, spacing=3)
        column.addLayout(self._grid)
        column.addWidget(self.more, 0, Qt.AlignmentFlag.AlignLeft)
        self._fold()

    def set_rows(self, rows: Sequence[ValueRow], more: Sequence[ValueRow] = ()) -> None:
        """Set rows of (label, text with unit, tooltip, level); the rows `more` are folded below them."""
        self._rows, self._in_sight = (*rows, *more), len(rows)
        while len(self._labels) < len(self._rows):
            self._add_row()
        self._fold()
        self._show()

    def _fold(self) -> None:
        """Show the further rows where they are asked for."""
        shown = len(self._rows) if self.more.isChecked() else self._in_sight
        for place, labels in enumerate(self._labels):
            for label in labels:
                label.setVisible(place < shown)
        self.more.setVisible(len(self._rows) > self._in_sight)
        self.more.setText(tr("Less") if self.more.isChecked() else tr("More"))
        self.more.setToolTip(tr("What an auditor and a metrologist want to know of it as well"))

    def text_of(self, label: str) -> str:
        """Return the text beside a label; "" if there is no such row."""
        return next((text for name, text, _, _ in self._rows if name == label), "")

    def minimumSizeHint(self) -> QSize:
        hint = super().minimumSizeHint()
        return QSize(max(self._least_width, hint.width()), hint.height())

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show()

    def _add_row(self) -> None:
        name, value, sign = QLabel(), _Value(), IconLabel(15)
        name.setObjectName("muted")
        name.setWordWrap(True)
        value.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        value.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        place = len(self._labels)
        for column, label in enumerate((name, value, sign)):
            self._grid.addWidget(label, place, column)
        self._labels.append((name, value, sign))

    def _show(self) -> None:
        words = grade_words()
        for (label, text, tip, level), (name, value, sign) in zip(self._rows, self._labels, strict=False):
            value.setWordWrap(value.fontMetrics().horizontalAdvance(text) > VALUE_PX)
            for shown, wanted in ((name, label), (value, text)):
                if shown.text() != wanted:
                    shown.setText(wanted)
            said = ": ".join(part for part in (words[level], tip) if part)
            for part in (name, value, sign):
                part.setToolTip(said)
            value.setAccessibleName(label)
            value.setAccessibleDescription(said)
            if level:
                symbol, colour = LEVEL_ICONS[level]
                sign.show_icon(symbol, colour)
                dress(value, f"color: {getattr(shades(), colour)}; font-weight: 600;")
            else:
                sign.show_icon("")
                dress(value, "")


class _Value(QLabel):
    """One line where there is room for it, even where it may wrap."""

    def sizeHint(self) -> QSize:
        hint = super().sizeHint()
        return QSize(self.fontMetrics().horizontalAdvance(self.text()) + 2, hint.height()) if self.wordWrap() else hint

    def minimumSizeHint(self) -> QSize:
        hint = super().minimumSizeHint()
        if not self.wordWrap():
            return hint
        longest = max(map(self.fontMetrics().horizontalAdvance, self.text().split()), default=0)
        return QSize(max(VALUE_PX, longest + 2), hint.height())  # a name of a file has no blank to break at


class Verdict(QFrame):
    """Verdict on the part: an icon, one word, one sentence."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._kind: VerdictKind = ""
        self._sign, self._word, self._detail = IconLabel(28), QLabel(), Sentence()
        self._detail.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        words = in_column(self._word, self._detail, spacing=1)
        row = in_row(on=self, margins=(12, 8, 12, 8), spacing=10)
        row.addWidget(self._sign, 0, Qt.AlignmentFlag.AlignTop)
        row.addLayout(words, 1)
        self.set_verdict("")

    def set_verdict(self, kind: VerdictKind, detail: str = "") -> None:
        """Show a verdict with a sentence; "" shows that there is none: no tolerance, or not measured."""
        self._kind = kind
        set_text(self._detail, detail)
        self._show()

    @property
    def text(self) -> str:
        """Word of the verdict that is shown."""
        return self._word.text()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show()

    def _show(self) -> None:
        symbol, colour = VERDICT_ICONS[self._kind]
        word = capital(tr(DECISIONS[self._kind]))
        self._sign.show_icon(symbol, colour)
        self._word.setText(word)
        dress(self._word, f"color: {getattr(shades(), colour)}; font-size: 16px; font-weight: 600;")
        self.setAccessibleName(word)
        dress_edged(self, colour)
