"""The calibrations that were accepted; any can be restored."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QPushButton, QWidget

from core.report.facts.table import FactTable
from workbench.language import tr
from workbench.pages.words import show_table
from workbench.theme import icon
from workbench.views.layouts import enable, in_column, in_row, muted
from workbench.views.lists.data_table import DataTable


class HistoryTab(QWidget):
    """Tab with the list of stored calibrations, a text on the chosen one, and the button that restores it."""

    def __init__(self, presenter: Any, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.table, self.words = DataTable(), muted()
        self.restore = QPushButton(icon("mdi6.backup-restore"), tr("Restore"))
        self.restore.clicked.connect(lambda: presenter.history.restore())
        self.table.current_row_changed.connect(self._chosen)
        row = self.row = in_row((self.words, 1), self.restore)
        self.column = in_column((self.table, 1), row, on=self, margins=(6, 6, 6, 6))
        self._shown: FactTable | None = None

    @abstractmethod
    def _listed(self, entries: Sequence[Any], in_use: str) -> FactTable:
        """A row for each of the kept calibrations, `in_use` being the id of one of them or ""."""

    @abstractmethod
    def _tip(self) -> str:
        """What the button does."""

    def _sentence(self) -> str:
        """What is said where the chosen one can be restored."""
        return ""

    def refresh(self) -> None:
        """Show the list of stored calibrations, the text on the chosen one, and its button."""
        history = self._presenter.history
        listed = self._listed(history.entries, history.accepted)
        if listed != self._shown:
            self._shown = listed
            ids = [entry.id for entry in history.entries]
            with QSignalBlocker(self.table):
                show_table(self.table, listed)
                self.table.set_current_row(ids.index(history.chosen) if history.chosen in ids else -1)
        why = history.why_not_restore()
        self.words.setText(why or self._sentence())
        enable(self.restore, why, self._tip())

    def _chosen(self, row: int) -> None:
        entries = self._presenter.history.entries
        if 0 <= row < len(entries):
            self._presenter.history.choose(entries[row].id)
