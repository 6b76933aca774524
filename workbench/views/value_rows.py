"""Results in two columns, and the verdict."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from PySide6.QtWidgets import QFrame, QWidget

from workbench.views.colours import Level


class ValueRows(QWidget):
    """Label and value with unit, two columns."""

    def set_rows(self, rows: Sequence[tuple[str, str, str, Level]]) -> None:
        """(label, text with unit, tip, level) each."""


class Verdict(QFrame):
    """Whether the part conforms, in one banner."""

    def set_verdict(
        self, kind: Literal["", "conforming", "not conforming", "not proven"], detail: str = ""
    ) -> None: ...
