"""The rail of steps at the left: where one is, and how far each step is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtWidgets import QButtonGroup, QFrame, QToolButton, QWidget

from workbench.theme import icon
from workbench.views.common import IconLabel
from workbench.views.layouts import in_column, in_row

BADGES = {
    "todo": ("mdi6.circle-outline", "line"),
    "ready": ("mdi6.circle-half-full", "accent"),
    "done": ("mdi6.check-circle", "good"),
    "outdated": ("mdi6.alert-circle-outline", "warn"),
    "not needed": ("mdi6.minus-circle-outline", "muted"),
}
"""Icon and colour of each state; the shapes differ as well."""


class StepRail(QFrame):
    """Column of buttons, one a step, each with a badge for its state."""

    chosen = Signal(str)

    def __init__(self, steps: Sequence[tuple[str, str, str]], parent: QWidget | None = None) -> None:
        """`steps`: name, title and icon of each."""
        super().__init__(parent)
        self._states: dict[str, str] = dict.fromkeys((name for name, _, _ in steps), "todo")
        self._buttons: dict[str, QToolButton] = {}
        self._badges: dict[str, IconLabel] = {}
        group = QButtonGroup(self)
        layout = in_column(on=self, margins=(6, 10, 6, 10), spacing=4)
        for number, (name, title, symbol) in enumerate(steps, start=1):
            button = QToolButton()
            button.setText(f"{number}  {title}")
            button.setIcon(icon(symbol))
            button.setCheckable(True)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
            button.setIconSize(QSize(20, 20))
            button.setAccessibleName(title)
            button.clicked.connect(lambda _=False, step=name: self.chosen.emit(step))
            button.setMinimumHeight(36)
            group.addButton(button)
            badge = IconLabel(16)
            layout.addLayout(in_row((button, 1), badge, spacing=4))
            self._buttons[name], self._badges[name] = button, badge
        layout.addStretch(1)
        self._titles = {name: title for name, title, _ in steps}
        self._narrow = True
        self.set_narrow(False)
        self._show_badges(self._badges)

    def set_narrow(self, narrow: bool) -> None:
        """Show the steps' icons only, with the titles as tooltips, or, with False, icons and titles."""
        if narrow == self._narrow:
            return
        self._narrow = narrow
        style = Qt.ToolButtonStyle.ToolButtonIconOnly if narrow else Qt.ToolButtonStyle.ToolButtonTextBesideIcon
        for button in self._buttons.values():
            button.setToolButtonStyle(style)
            button.setMinimumWidth(40 if narrow else 150)
        self._set_tips()
        # A window that is being resized lays itself out with the width the rail had before.
        QTimer.singleShot(0, self, self.updateGeometry)

    def set_current(self, name: str) -> None:
        """Mark the step called `name` as the one whose page is shown."""
        self._buttons[name].setChecked(True)

    def set_states(self, states: Mapping[str, tuple[str, str]]) -> None:
        """Set the state of each step, a key of BADGES, and the sentence on it, by the step's name.

        What is not needed is not shown; the others are numbered without it.
        """
        others = [name for name, (state, _) in states.items() if state != self._states[name]]
        for name, (state, sentence) in states.items():
            self._states[name] = state
            self._badges[name].setToolTip(sentence)
            self._buttons[name].setAccessibleDescription(sentence)
        needed = [name for name in self._buttons if self._states[name] != "not needed"]
        for name, button in self._buttons.items():
            button.setVisible(name in needed)
            self._badges[name].setVisible(name in needed)
        for number, name in enumerate(needed, start=1):
            self._buttons[name].setText(f"{number}  {self._titles[name]}")
        self._set_tips()
        self._show_badges(others)

    def state_of(self, name: str) -> str:
        """Return the state that is shown for the step called `name`."""
        return self._states[name]

    def _set_tips(self) -> None:
        for name, button in self._buttons.items():
            sentence = button.accessibleDescription()
            button.setToolTip(f"{self._titles[name]}\n{sentence}".strip() if self._narrow else sentence)

    def _show_badges(self, names: Iterable[str]) -> None:
        for name in names:
            symbol, colour = BADGES[self._states[name]]
            self._badges[name].show_icon(symbol, colour)
