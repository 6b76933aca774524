"""Lists and tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget


@dataclass(frozen=True, eq=False, slots=True)
class ListRow:
    """A view, pose or frame: `text` is the value with its unit, `value` what it is sorted by and its bar is long."""

    name: str
    value: float | None = None
    text: str = ""
    used: bool = True
    reason: str = ""
    thumbnail: NDArray[np.uint8] | None = None
    title: str = ""


class ViewList(QWidget):
    """Views, poses or frames to include or leave out."""

    toggled = Signal(str, bool)
    toggled_together = Signal(object, bool)
    current_changed = Signal(str)

    def set_headers(self, what: str, value: str) -> None: ...
    def set_rows(self, rows: Sequence[ListRow]) -> None: ...
    def set_current(self, name: str) -> None: ...
    def current(self) -> str: ...


class DataTable(QWidget):
    """A table of texts; Ctrl+C copies what is chosen with tabs between the columns."""

    current_row_changed = Signal(int)

    def set_headers(self, headers: Sequence[tuple[str, str]]) -> None: ...
    def set_rows(self, rows: Sequence[Sequence[str]]) -> None: ...
