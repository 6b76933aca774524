"""Two or more views side by side, each under its title; any of them can have all the room."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QMouseEvent, QResizeEvent
from PySide6.QtWidgets import QLabel, QSplitter, QToolButton, QWidget

from workbench.language import tr
from workbench.theme import icon
from workbench.views.layouts import STRETCH, in_column, in_row

NARROWEST = 160
"""No view is made narrower than so many pixels."""


INSET = 300
"""Pixels of the others beside the main view; more on a wide page, where a picture does not fill the rest."""


GAP = 4
"""Pixels between a view and the line that parts it from the next."""


class PaneTitle(QWidget):
    """Line over a view: its title, the page's widgets, and the button that maximises it."""

    wanted = Signal()
    """All the room is wanted, or given back: the button, or a double click."""

    def __init__(self, title: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.label, self.button = QLabel(title), QToolButton()
        self.label.setObjectName("heading")
        self.button.setAutoRaise(True)
        self.button.setIconSize(QSize(16, 16))
        self.button.clicked.connect(self.wanted)
        self._row = in_row(self.label, STRETCH, self.button, on=self, margins=(2, 0, 0, 0), spacing=6)
        self.show_maximised(maximised=False)

    def add(self, widget: QWidget) -> None:
        """Add a widget of the page to the title line, beside the button."""
        self._row.insertWidget(self._row.count() - 1, widget)

    def show_maximised(self, *, maximised: bool) -> None:
        """Set the text of the button: to maximise the view, or to show all views again."""
        tip = (
            tr("Show both views again (or double-click the title)")
            if maximised
            else tr("Give this view all the room (or double-click the title)")
        )
        self.button.setToolTip(tip)
        self.button.setAccessibleName(f"{self.label.text()}: {tip}")
        self.button.setIcon(icon("mdi6.arrow-collapse" if maximised else "mdi6.arrow-expand"))

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self.wanted.emit()


class SideBySide(QSplitter):
    """Views with titles in a row; a double click on a title, or its button, shows that one alone, or all again."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self.setChildrenCollapsible(False)
        self._panes: list[tuple[PaneTitle, QWidget]] = []
        self._alone: int | None = None
        self._main: int | None = None

    def add_view(self, title: str, view: QWidget) -> PaneTitle:
        """Add a view with a title at the right end, and return its title line."""
        head, pane = PaneTitle(title), QWidget()
        in_column(head, (view, 1), on=pane, margins=(0 if not self._panes else GAP, 0, GAP, 0), spacing=3)
        place = len(self._panes)
        self._panes.append((head, pane))
        self.addWidget(pane)
        self.setStretchFactor(place, 1)
        pane.setMinimumWidth(NARROWEST)
        self.setSizes([10_000] * len(self._panes))  # alike
        head.wanted.connect(lambda: self.show_alone(None if self._alone == place else place))
        return head

    @property
    def alone(self) -> int | None:
        """Index of the view that is shown alone; None if all are shown."""
        return self._alone

    def show_alone(self, place: int | None) -> None:
        """Show only the view with the index `place`; None shows all views."""
        self._alone = place
        for index, (head, pane) in enumerate(self._panes):
            pane.setVisible(place is None or index == place)
            head.show_maximised(maximised=index == place)

    def show_main(self, place: int | None) -> None:
        """Give most of the width to the view with the index `place`; None gives all views the same."""
        self._main = place
        self._share_out()

    def show_next(self) -> None:
        """Give most of the width to the view after the one that has it now."""
        if self._main is not None:
            self.show_main((self._main + 1) % len(self._panes))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if self._main is not None:
            self._share_out()

    def _share_out(self) -> None:
        sizes = [10_000 if self._main is None else INSET] * len(self._panes)
        if self._main is not None:
            sizes[self._main] = max(self.width() - INSET * (len(self._panes) - 1), INSET)
        self.setSizes(sizes)
