"""The editors of a form: each tells its value once it is meant, not at every key, and leaves the wheel alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

from PySide6.QtCore import QEvent, Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QHideEvent, QKeyEvent, QKeySequence, QValidator
from PySide6.QtWidgets import QCheckBox, QLineEdit, QPlainTextEdit

from workbench.views.common import Choice, SpinBox

WIDEST_CHOICE = 22
"""Letters of a choice that a field has room for at least; longer ones only where there is more."""
_STEPPING_MS = 400
"""How long in ms after the last step of its arrows or the wheel a number is told: one edit, not one a step."""


def _is_for_the_window(event: QEvent, typing: bool) -> bool:
    """Whether this is Undo or Redo in an editor in which nothing is half typed: then the project's are meant.

    Editors of Qt take these keys for themselves, whether they have anything to undo or not.
    """
    if typing or event.type() != QEvent.Type.ShortcutOverride or not isinstance(event, QKeyEvent):
        return False
    if not (event.matches(QKeySequence.StandardKey.Undo) or event.matches(QKeySequence.StandardKey.Redo)):
        return False
    event.ignore()
    return True


@dataclass(frozen=True, slots=True)
class NumberRange:
    """Range of numbers that may be entered: `decimals`, the `step` of the arrow keys, the `unit` behind.

    With `none_text` the field may be left empty, which reads as that text and gives None; stepping away from it goes
    to `first`, or to the smallest number.
    """

    minimum: float
    maximum: float
    decimals: int = 0
    step: float = 1.0
    unit: str = ""
    none_text: str | None = None
    first: float | None = None


class NumberEditor(SpinBox):
    """Editor of a number of a range, with its unit; an int if the range has no decimals."""

    committed = Signal()

    _none_text: str | None = None  # asked for as soon as Qt makes the widget

    def __init__(self, within: NumberRange) -> None:
        super().__init__()
        self._none_text, self._least = within.none_text, within.minimum
        self._first = within.minimum if within.first is None else within.first
        self._whole = within.decimals == 0
        self._told: float | None = None
        self.setDecimals(within.decimals)
        # the value below the smallest stands for none
        below = 0.0 if within.none_text is None else max(within.step, 10.0**-within.decimals)
        self.setRange(within.minimum - below, within.maximum)
        self.setSingleStep(within.step)
        self.setSuffix(within.unit if within.unit in ("", "°") else f" {within.unit}")
        if within.none_text is not None:
            self.setSpecialValueText(within.none_text)
        self.setKeyboardTracking(False)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self._stepping = QTimer(self)
        self._stepping.setSingleShot(True)
        self._stepping.setInterval(_STEPPING_MS)
        self._stepping.timeout.connect(self._tell)
        self.editingFinished.connect(self._tell)
        self._told = self.content()

    def content(self) -> float | int | None:
        """Return the number entered; None if the field is empty."""
        if self._none_text is not None and self.value() < self._least - 1e-12 * max(1.0, abs(self._least)):
            return None
        return round(self.value()) if self._whole else self.value()

    def set_content(self, value: object) -> None:
        """Show a number, or none for None, without emitting a signal."""
        if value == self._told and (self.hasFocus() or self._stepping.isActive()):
            return  # it may be half typed
        self._stepping.stop()
        number = self.minimum() if value is None else float(value)  # type: ignore[arg-type]
        self.setValue(self.minimum() if math.isnan(number) else number)
        self._told = self.content()

    def event(self, event: QEvent) -> bool:
        return _is_for_the_window(event, self._half_typed()) or super().event(event)

    def stepBy(self, steps: int) -> None:
        if self.content() is None and steps > 0:
            self.setValue(self._first)
        else:
            super().stepBy(steps)
        self._stepping.start()

    def validate(self, text: str, position: int) -> tuple[QValidator.State, str, int]:
        if self._none_text is not None and self._typed(text) in ("", self._none_text):
            return QValidator.State.Acceptable, text, position
        return super().validate(text, position)

    def valueFromText(self, text: str) -> float:
        if self._none_text is not None and self._typed(text) in ("", self._none_text):
            return self.minimum()
        return super().valueFromText(text)

    def hideEvent(self, event: QHideEvent) -> None:
        if self._stepping.isActive():
            self._tell()
        super().hideEvent(event)

    def _half_typed(self) -> bool:
        """Whether the text says something else than the value."""
        none = bool(self.specialValueText()) and self.value() == self.minimum()
        shown = self.specialValueText() if none else self.textFromValue(self.value()) + self.suffix()
        return self.lineEdit().text() != shown

    def _typed(self, text: str) -> str:
        return text.removesuffix(self.suffix()).strip()

    def _tell(self) -> None:
        self._stepping.stop()
        if self.content() != self._told:
            self._told = self.content()
            self.committed.emit()


class TextEditor(QLineEdit):
    """Editor of one line of text."""

    committed = Signal()

    def __init__(self, placeholder: str = "") -> None:
        super().__init__()
        self._told = ""
        self.setPlaceholderText(placeholder)
        self.editingFinished.connect(self._tell)

    def content(self) -> str:
        """Return the text entered."""
        return self.text()

    def set_content(self, value: object) -> None:
        """Show a text from its beginning, without emitting a signal."""
        if value == self._told and self.hasFocus():
            return  # it may be half typed
        self._told = str(value)
        if self.text() != self._told:
            self.setText(self._told)
            self.setCursorPosition(0)

    def event(self, event: QEvent) -> bool:
        return _is_for_the_window(event, self.text() != self._told) or super().event(event)

    def _tell(self) -> None:
        if self.text() != self._told:
            self._told = self.text()
            self.committed.emit()


_LINES = 4  # of a text of several, without scrolling


class MultilineEditor(QPlainTextEdit):
    """Editor of several lines of text; it emits when the focus leaves. Tab goes on to the next editor."""

    committed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._told = ""
        self.setTabChangesFocus(True)
        margins = (
            self.contentsMargins().top() + self.contentsMargins().bottom() + 2 * int(self.document().documentMargin())
        )
        self.setFixedHeight(_LINES * self.fontMetrics().lineSpacing() + margins + 8)

    def content(self) -> str:
        """Return the text entered."""
        return self.toPlainText()

    def set_content(self, value: object) -> None:
        """Show a text of several lines, without emitting a signal."""
        if value == self._told and self.hasFocus():
            return  # it may be half typed
        self._told = str(value)
        if self.toPlainText() != self._told:
            self.setPlainText(self._told)

    def event(self, event: QEvent) -> bool:
        return _is_for_the_window(event, self.toPlainText() != self._told) or super().event(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() != Qt.FocusReason.PopupFocusReason:
            self.emit_if_changed()

    def emit_if_changed(self) -> None:
        """Emit the text if it differs from the one emitted or set last."""
        if self.toPlainText() != self._told:
            self._told = self.toPlainText()
            self.committed.emit()


class ChoiceEditor(Choice):
    """Editor of one of several values."""

    committed = Signal()

    def __init__(self, choices: list[tuple[object, str]]) -> None:
        super().__init__()
        self._values = [value for value, _ in choices]
        self.addItems([text for _, text in choices])
        self.setSizeAdjustPolicy(Choice.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(min(max(len(text) for _, text in choices), WIDEST_CHOICE) if choices else 0)
        self.activated.connect(lambda _: self._tell())
        self._told: object = self.content()

    def content(self) -> object:
        """Return the value of the choice that is selected."""
        return self._values[self.currentIndex()] if self._values else None

    def set_content(self, value: object) -> None:
        """Select the choice with this value, without emitting a signal; another value changes nothing."""
        if value in self._values:
            self.setCurrentIndex(self._values.index(value))
        self._told = self.content()

    def _tell(self) -> None:
        if self.content() != self._told:
            self._told = self.content()
            self.committed.emit()


class CheckEditor(QCheckBox):
    """Editor of yes or no."""

    committed = Signal()

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.clicked.connect(lambda _: self.committed.emit())

    def content(self) -> bool:
        """Return whether the box is checked."""
        return self.isChecked()

    def set_content(self, value: object) -> None:
        """Check or uncheck the box, without emitting a signal."""
        self.setChecked(bool(value))


Editor = NumberEditor | TextEditor | MultilineEditor | ChoiceEditor | CheckEditor
