"""Gauges and hints for work in progress."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtWidgets import QFrame, QWidget

from workbench.views.colours import Level


class Meter(QWidget):
    """A horizontal gauge with zones and a needle."""

    def __init__(
        self,
        title: str,
        zones: Sequence[tuple[float, Level]],
        *,
        minimum: float = 0.0,
        logarithmic: bool = False,
        parent: QWidget | None = None,
    ) -> None:
        """`zones`: (upper end, level), rising; the last upper end is the end of the scale."""
        super().__init__(parent)

    def set_value(self, value: float | None, text: str = "") -> None:
        """Place the needle; `text` is the value with its unit; None: unknown."""


class HintBar(QFrame):
    """What to do now, calmly: a sentence stays for at least a second."""

    def set_hints(self, hints: Sequence[str]) -> None: ...
