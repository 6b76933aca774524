"""Forms of settings: label, editor, one line of help each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QSizePolicy, QWidget

from workbench.theme import shades
from workbench.views.common import dress
from workbench.views.forms.editors import (
    CheckEditor,
    ChoiceEditor,
    Editor,
    MultilineEditor,
    NumberEditor,
    NumberRange,
    TextEditor,
)
from workbench.views.layouts import Sentence

_EDITOR_WIDTH = 132
"""Pixels of a field at least."""


class SettingsForm(QWidget):
    """Form of settings one below the other. `edited` tells key and value when an editor is left or Enter is pressed."""

    edited = Signal(str, object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._editors: dict[str, Editor] = {}
        self._helps: dict[str, tuple[QLabel, str]] = {}
        self._tips: dict[str, str] = {}
        self._complaints: dict[str, str] = {}
        self._questions: dict[str, str] = {}
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setHorizontalSpacing(10)
        self._grid.setVerticalSpacing(1)
        self._grid.setColumnStretch(0, 1)

    # ---- making it

    def add_section(self, title: str) -> None:
        """Add a heading above the settings that are added after it."""
        heading = QLabel(title)
        heading.setObjectName("heading")
        heading.setWordWrap(True)
        heading.setContentsMargins(0, 8 if self._editors else 0, 0, 2)
        self._grid.addWidget(heading, self._grid.rowCount(), 0, 1, 2)

    def add_number(self, key: str, label: str, within: NumberRange, help: str = "", *, tip: str = "") -> None:
        """Add a field for a number within a range; an int if the range has no decimals."""
        editor = NumberEditor(within)
        editor.setMinimumWidth(_EDITOR_WIDTH)
        self._add(key, label, editor, help, tip)

    def add_text(self, key: str, label: str, help: str = "", *, placeholder: str = "", tip: str = "") -> None:
        """Add a field for one line of text."""
        self._add(key, label, TextEditor(placeholder), help, tip, wide=True)

    def add_multiline(self, key: str, label: str, help: str = "") -> None:
        """Add a field for several lines of text."""
        self._add(key, label, MultilineEditor(), help, wide=True)

    def add_choice(self, key: str, label: str, choices: Sequence[tuple[object, str]], help: str = "") -> None:
        """Add a field to choose one of several values; `choices` are pairs (value, displayed text)."""
        editor = ChoiceEditor(list(choices))
        editor.setMinimumWidth(_EDITOR_WIDTH)
        self._add(key, label, editor, help)

    def add_check(self, key: str, label: str, help: str = "") -> None:
        """Add a check box."""
        self._add(key, "", CheckEditor(label), help, wide=True)

    # ---- using it

    def values(self) -> dict[str, object]:
        """Return the values of all fields, by key."""
        return {key: editor.content() for key, editor in self._editors.items()}

    def set_values(self, values: Mapping[str, object]) -> None:
        """Show values in the fields with these keys, without emitting; unknown keys are ignored.

        An editor in which the user is typing is left alone unless its value is to be another than it was.
        """
        for key, editor in self._editors.items():
            if key in values:
                editor.set_content(values[key])

    def set_editable(self, key: str, editable: bool, why: str = "") -> None:
        """Enable or disable the field with this key; `why` is the tooltip while it is disabled."""
        self._editors[key].setEnabled(editable)
        self._editors[key].setToolTip(self._tips[key] if editable or not why else why)

    def set_complaint(self, key: str, sentence: str) -> None:
        """Show under a field, instead of its help, what is wrong with its value; "" shows the help again."""
        if self._complaints.get(key, "") != sentence:
            self._complaints[key] = sentence
            self._show_help(key)

    def ask(self, key: str, sentence: str) -> None:
        """Show under a field, instead of its help, that its value is needed; "" shows the help again."""
        if self._questions.get(key, "") != sentence:
            self._questions[key] = sentence
            self._show_help(key)

    def editor(self, key: str) -> QWidget:
        """Return the editor of the field with this key.

        Raises
        ------
        KeyError
            If there is no such setting.
        """
        return self._editors[key]

    def editors(self) -> tuple[QWidget, ...]:
        """Return the editors of all fields, from top to bottom."""
        return tuple(self._editors.values())

    def help_of(self, key: str) -> str:
        """Return the text shown under a field: its help, a complaint, or what is asked for."""
        return self._complaints.get(key) or self._questions.get(key) or self._helps[key][1]

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            for key in self._helps:
                self._show_help(key)

    def _add(self, key: str, label: str, editor: Editor, help: str, tip: str = "", *, wide: bool = False) -> None:
        self._editors[key], self._tips[key] = editor, tip or help
        editor.setToolTip(tip or help)
        editor.setAccessibleDescription(help)
        editor.committed.connect(lambda: self.edited.emit(key, editor.content()))
        row = self._grid.rowCount()
        if label:
            name = QLabel(label)
            name.setBuddy(editor)
            name.setToolTip(tip or help)
            name.setWordWrap(True)
            editor.setAccessibleName(label)
            self._grid.addWidget(name, row, 0, 1, 2 if wide else 1)
        if wide:
            self._grid.addWidget(editor, row + 1, 0, 1, 2)
        else:
            editor.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
            self._grid.addWidget(editor, row, 1)
        said = Sentence()
        said.setContentsMargins(0, 0, 0, 7)
        said.setAlignment(Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft)
        self._grid.addWidget(said, row + 2, 0, 1, 2)
        self._helps[key] = said, help
        self._show_help(key)

    def _show_help(self, key: str) -> None:
        label, s = self._helps[key][0], shades()
        label.setText(self.help_of(key))
        colour = s.bad if self._complaints.get(key) else s.warn if self._questions.get(key) else s.muted
        dress(label, f"font-size: 11px; color: {colour};")
