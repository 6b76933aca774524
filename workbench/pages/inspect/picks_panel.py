"""The panel of picked points and distances."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QPushButton, QWidget

from core.inspect.shown.view_frame import FRAME_NAMES, ViewFrame
from workbench.language import tr
from workbench.pages.inspect import words
from workbench.pages.inspect.buttons import PicksFacts, picks_buttons
from workbench.pages.inspect.picks import Mode, Pick
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.theme import icon
from workbench.views.layouts import enable, in_column, muted


class PicksPanel(QWidget):
    """Tools to pick points and distances, and the list of them as soon as there are some."""

    pick = Signal(str)
    """Points ("point") or distances ("distance") are to be picked; "": no more."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._names: list[str] = []
        self._frame: ViewFrame | None = None
        self.tools: dict[Mode, QPushButton] = {
            "point": QPushButton(icon("mdi6.crosshairs-gps"), tr("Pick points")),
            "distance": QPushButton(icon("mdi6.ruler"), tr("Measure distance")),
        }
        self.list = QListWidget()
        self.remove = QPushButton(icon("mdi6.playlist-remove"), tr("Remove"))
        self.clear = QPushButton(icon("mdi6.close"), tr("Remove all"))
        self.list.setAccessibleName(tr("Picked points and distances"))
        self.list.setWordWrap(True)
        self.list.setFixedHeight(120)
        above, below = QHBoxLayout(), QHBoxLayout()
        for mode, button in self.tools.items():
            button.setCheckable(True)
            button.clicked.connect(lambda on, mode=mode: self.pick.emit(mode if on else ""))
            above.addWidget(button, 1)
        below.addWidget(self.remove, 1)
        below.addWidget(self.clear, 1)
        self.frame = muted()
        self.help = muted(
            tr(
                "± of a point is the standard uncertainty (sd) of its depth, u of a distance the two points' share. "
                "The calibrations' share is not in them. Points and distances are not kept with the project."
            )
        )
        self.help.setObjectName("help")
        in_column(above, self.frame, self.list, below, self.help, on=self)
        self.remove.clicked.connect(self._remove)
        self.clear.clicked.connect(lambda: presenter.picks.clear())
        self.list.currentRowChanged.connect(lambda _: self._show_buttons())

    def refresh(self) -> None:
        """Show what the presenter says now."""
        picks = self._presenter.picks
        for mode, button in self.tools.items():
            button.setChecked(picks.mode == mode)
        names = [item.name for item in picks.items]
        frame, row = self._presenter.frame, self.list.currentRow()
        if names != self._names or self._frame is None or not frame.same_as(self._frame):
            row = row if names == self._names else len(names) - 1
            self._names, self._frame = names, frame
            self.frame.setText(tr("x, y, z: {frame}", frame=tr(FRAME_NAMES[frame.kind])))
            self.list.clear()
            for item in picks.items:
                lines = words.pick_lines(item, frame) if isinstance(item, Pick) else words.span_lines(item, frame)
                self.list.addItem(QListWidgetItem("\n".join(lines)))
            self.list.setCurrentRow(row)
        self._show_buttons()

    def _show_buttons(self) -> None:
        for widget in (self.frame, self.list, self.remove, self.clear):
            widget.setVisible(bool(self._names))
        chosen = 0 <= self.list.currentRow() < len(self._names)
        can = picks_buttons(PicksFacts(self._presenter.scan.buttons.use, bool(self._names), chosen))
        tips: dict[Mode, str] = {
            "point": tr("Click points in 3D: x, y, z in mm in the frame of the view, with picture and pixel"),
            "distance": tr("Click two points in 3D: their distance in mm with its standard uncertainty"),
        }
        for mode, button in self.tools.items():
            enable(button, can.pick, tips[mode])
        enable(self.remove, can.remove, tr("Take the chosen one off the list"))
        enable(self.clear, can.clear, tr("Take all points and distances off the list"))

    def _remove(self) -> None:
        row = self.list.currentRow()
        if 0 <= row < len(self._names):
            self._presenter.picks.remove(self._names[row])
