"""What was looked at before a scan, with ticks and crosses."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QWidget

from core.scan.preview.preflight import Check, Name, State
from core.states import CONDITIONS
from workbench.language import text_of, tr
from workbench.views.common import IconLabel

_SIGNS: dict[State, tuple[str, str]] = {
    "ok": ("mdi6.check-circle-outline", "good"),
    "failed": ("mdi6.close-circle-outline", "bad"),
    "unknown": ("mdi6.help-circle-outline", "muted"),
}


class ChecksCard(QFrame):
    """Card with one row a check: a tick, a cross or a question mark, its name, and a sentence.

    Hidden while there are no checks.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("card")
        self._checks: tuple[Check, ...] = ()
        self._rows: list[tuple[IconLabel, QLabel, QLabel]] = []
        title = QLabel(tr("Before the scan"))
        title.setObjectName("heading")
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(10, 8, 10, 8)
        self._grid.setHorizontalSpacing(8)
        self._grid.setVerticalSpacing(3)
        self._grid.setColumnStretch(2, 1)
        self._grid.addWidget(title, 0, 0, 1, 3)
        self.hide()

    def show_checks(self, checks: Sequence[Check]) -> None:
        """Show a row for each check: its mark, name and sentence."""
        if tuple(checks) != self._checks:
            self._checks = tuple(checks)
            self._show()
        self.setVisible(bool(checks))

    @property
    def sentences(self) -> tuple[str, ...]:
        """Sentence of each check that is shown."""
        return tuple(said.text() for _, _, said in self._rows[: len(self._checks)])

    def _show(self) -> None:
        titles = self._titles()
        while len(self._rows) < len(self._checks):
            self._add_row()
        for place, row in enumerate(self._rows):
            for label in row:
                label.setVisible(place < len(self._checks))
        for check, (sign, name, said) in zip(self._checks, self._rows, strict=False):
            symbol, colour = _SIGNS[check.state]
            sign.show_icon(symbol, colour)
            sign.setAccessibleName(tr(CONDITIONS[check.state]))
            sign.setToolTip(tr(CONDITIONS[check.state]))
            name.setText(titles[check.name])
            said.setText(text_of(check.message))

    def _add_row(self) -> None:
        sign, name, said = IconLabel(16), QLabel(), QLabel()
        said.setObjectName("muted")
        said.setWordWrap(True)
        place = len(self._rows) + 1
        for column, label in enumerate((sign, name, said)):
            self._grid.addWidget(label, place, column, Qt.AlignmentFlag.AlignTop if column < 2 else Qt.AlignmentFlag(0))
        self._rows.append((sign, name, said))

    def _titles(self) -> dict[Name, str]:
        return {
            "reference": tr("Reference"),
            "lines": tr("Lines"),
            "exposure": tr("Exposure"),
            "focus": tr("Focus"),
            "calibration": tr("Calibration"),
            "check": tr("Check"),
            "boards": tr("Boards"),
        }
