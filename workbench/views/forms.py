"""Forms of settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget


class SettingsForm(QWidget):
    """Settings with label, editor, and one line of help each."""

    edited = Signal(str, object)

    def add_section(self, title: str) -> None: ...
    def add_number(
        self,
        key: str,
        label: str,
        unit: str = "",
        help: str = "",
        *,
        minimum: float,
        maximum: float,
        decimals: int = 0,
        step: float = 1.0,
        none_text: str | None = None,
        tip: str = "",
    ) -> None: ...
    def add_text(self, key: str, label: str, help: str = "", *, placeholder: str = "", tip: str = "") -> None: ...
    def add_multiline(self, key: str, label: str, help: str = "", *, lines: int = 4, tip: str = "") -> None: ...
    def add_choice(
        self, key: str, label: str, choices: Sequence[tuple[object, str]], help: str = "", *, tip: str = ""
    ) -> None: ...
    def add_check(self, key: str, label: str, help: str = "", *, tip: str = "") -> None: ...
    def values(self) -> dict[str, object]:
        return {}

    def set_values(self, values: Mapping[str, object]) -> None: ...
    def set_editable(self, key: str, editable: bool, why: str = "") -> None: ...
    def set_complaint(self, key: str, sentence: str) -> None: ...
    def editor(self, key: str) -> QWidget:
        raise KeyError(key)
