"""The panel of picked points and distances."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QPushButton, QVBoxLayout, QWidget

from workbench.pages.inspect import words
from workbench.pages.inspect.picks import Mode, Pick
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.step_page import muted
from workbench.theme import icon


class PicksPanel(QWidget):
    """Tools to pick points and distances, and the list of them as soon as there are some."""

    pick = Signal(str)
    """Points ("point") or distances ("distance") are to be picked; "": no more."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._names: list[str] = []
        self.tools: dict[Mode, QPushButton] = {"point": QPushButton(), "distance": QPushButton()}
        self.tools["point"].setText(self.tr("Pick points"))
        self.tools["distance"].setText(self.tr("Measure distance"))
        self.list, self.remove, self.clear = QListWidget(), QPushButton(), QPushButton()
        self.list.setAccessibleName(self.tr("Picked points and distances"))
        self.list.setWordWrap(True)
        self.list.setFixedHeight(120)
        self.remove.setText(self.tr("Remove"))
        self.clear.setText(self.tr("Remove all"))
        above, below = QHBoxLayout(), QHBoxLayout()
        for mode, button in self.tools.items():
            button.setCheckable(True)
            button.clicked.connect(lambda on, mode=mode: self.pick.emit(mode if on else ""))
            above.addWidget(button, 1)
        below.addWidget(self.remove, 1)
        below.addWidget(self.clear, 1)
        self.help = muted(
            self.tr(
                "± of a point is the standard uncertainty (sd) of its depth, u of a distance the two points' share. "
                "The calibrations' share is not in them. Points and distances are not kept with the project."
            )
        )
        self.help.setObjectName("help")
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(above)
        column.addWidget(self.list)
        column.addLayout(below)
        column.addWidget(self.help)
        self.remove.clicked.connect(self._remove)
        self.clear.clicked.connect(lambda: presenter.picks.clear())
        self.list.currentRowChanged.connect(lambda _: self._show_buttons())
        self._dress()

    def refresh(self) -> None:
        """Show what the presenter says now."""
        self._dress()
        picks, ready = self._presenter.picks, self._presenter.scan.view is not None
        tips: dict[Mode, str] = {
            "point": self.tr("Click points in 3D: x, y, z in mm in the camera's frame, with frame and pixel"),
            "distance": self.tr("Click two points in 3D: their distance in mm with its standard uncertainty"),
        }
        for mode, button in self.tools.items():
            button.setChecked(picks.mode == mode)
            button.setEnabled(ready)
            button.setToolTip(tips[mode] if ready else self.tr("There is no surface to pick on yet."))
        names = [item.name for item in picks.items]
        if names != self._names:
            self._names = names
            self.list.clear()
            for item in picks.items:
                lines = words.pick_lines(item) if isinstance(item, Pick) else words.span_lines(item)
                self.list.addItem(QListWidgetItem("\n".join(lines)))
            self.list.setCurrentRow(len(names) - 1)
        self._show_buttons()

    def _show_buttons(self) -> None:
        for widget in (self.list, self.remove, self.clear):
            widget.setVisible(bool(self._names))
        chosen = 0 <= self.list.currentRow() < len(self._names)
        for button, possible, tip in (
            (self.remove, chosen, self.tr("Take the chosen one off the list")),
            (self.clear, bool(self._names), self.tr("Take all points and distances off the list")),
        ):
            button.setEnabled(possible)
            button.setToolTip(tip if possible else self.tr("Nothing is picked yet."))

    def _remove(self) -> None:
        row = self.list.currentRow()
        if 0 <= row < len(self._names):
            self._presenter.picks.remove(self._names[row])

    def _dress(self) -> None:
        for button, symbol in (
            (self.tools["point"], "mdi6.crosshairs-gps"),
            (self.tools["distance"], "mdi6.ruler"),
            (self.remove, "mdi6.playlist-remove"),
            (self.clear, "mdi6.close"),
        ):
            button.setIcon(icon(symbol))
