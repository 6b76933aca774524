"""At the 3D view: where the plane is that is laid through the surface, and the profile in it."""

from __future__ import annotations

from functools import cached_property

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QBoxLayout, QLabel, QPushButton, QWidget

from core.inspect.shown.cut_plane import AXES
from workbench.language import tr
from workbench.pages.inspect.cut import InspectCut
from workbench.pages.step_page import ANY_HEIGHT
from workbench.theme import icon
from workbench.views.colours import PROPOSED
from workbench.views.common import Choice, SpinBox
from workbench.views.layouts import STRETCH, Folding, enable, in_column, in_row
from workbench.views.plots.lines import LineChart

SIDES = (0, 1, -1)
"""What is hidden, in the order in which it is offered."""
CHART_PX = 150
"""Height of the profile below the surface, which keeps most of the room."""
MOST_DEG = 90.0
"""A plane is turned and tilted by so much to either side: every direction is one of these."""
SHARES = 3, 2
"""Of the width: the surface's and the profile's, side by side."""


class CutPanel(QWidget):
    """Panel with direction and place of the plane in numbers; its profile is at the view of the surface, in `views`.

    It stands below the surface, or beside it where both would be too low (`put_beside`).
    """

    def __init__(self, cut: InspectCut, surface: QWidget, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._cut = cut
        self.views = QBoxLayout(QBoxLayout.Direction.TopToBottom)
        self.views.setSpacing(4)
        self.views.addWidget(surface, SHARES[0])
        self._names = ("", "")
        self.axis, self.at, self.turned, self.tilted = Choice(), SpinBox(), SpinBox(), SpinBox()
        self.keep = QPushButton(icon("mdi6.plus"), tr("Add as a section"))
        for name in AXES:
            self.axis.addItem(tr("square to {axis}", axis=name))
        self.axis.setAccessibleName(tr("What the cut is square to"))
        self.at.setAccessibleName(tr("Where the cut is"))
        self.at.setToolTip(tr("Where the cut is, in the frame of the view; or drag the ring in the 3D view"))
        self.side = Choice()
        for side, word in zip(SIDES, _hiding(AXES[0]), strict=True):  # Qt keeps the least width of its first words
            self.side.addItem(word, side)
        self.side.setAccessibleName(tr("What the cut hides"))
        self.side.setToolTip(tr("Hide the surface to one side of the plane: what is measured stays the same"))
        self.at.setSuffix(" mm")
        self.at.setDecimals(2)
        self.at.setKeyboardTracking(False)
        for angle, name, tip in (
            (self.turned, tr("How far the cut is turned"), tr("Turn the plane to a side; its middle stays")),
            (self.tilted, tr("How far the cut is tilted"), tr("Lean the plane over: then it is to look at only")),
        ):
            angle.setAccessibleName(name)
            angle.setToolTip(tip)
            angle.setRange(-MOST_DEG, MOST_DEG)
            angle.setDecimals(1)
            angle.setSingleStep(5.0)
            angle.setSuffix(" °")
            angle.setKeyboardTracking(False)
            angle.valueChanged.connect(lambda _: cut.turn_to(self.turned.value(), self.tilted.value()))
        where = in_row(QLabel(tr("Cut")), self.axis, self.at, self.side, STRETCH, spacing=6)
        how = in_row(QLabel(tr("turned")), self.turned, QLabel(tr("tilted")), self.tilted, STRETCH, spacing=6)
        row = Folding(where, how, in_row(STRETCH, self.keep), spacing=6, share=0)
        in_column(row, on=self)
        self.axis.currentIndexChanged.connect(cut.square_to)
        self.at.valueChanged.connect(cut.move_to)
        self.side.activated.connect(lambda place: cut.hide(SIDES[place]))
        self.keep.clicked.connect(cut.keep)

    @cached_property
    def chart(self) -> LineChart:
        """Chart of the profile in the cutting plane; made when it is first used."""
        chart = LineChart()
        self.views.addWidget(chart, SHARES[1])
        self._limit(chart)
        return chart

    def show_all(self, shown: bool) -> None:
        """Show or hide this panel and the chart of the profile."""
        self.setVisible(shown)
        if "chart" in self.__dict__:
            self.chart.setVisible(shown)

    def put_beside(self, beside: bool) -> None:
        """Put the chart of the profile beside the surface, or, with False, below it."""
        direction = QBoxLayout.Direction.LeftToRight if beside else QBoxLayout.Direction.TopToBottom
        if direction != self.views.direction():
            self.views.setDirection(direction)
            if "chart" in self.__dict__:
                self._limit(self.chart)

    def _limit(self, chart: LineChart) -> None:
        """Beside the surface it is as high as that."""
        below = self.views.direction() == QBoxLayout.Direction.TopToBottom
        chart.setMinimumHeight(CHART_PX if below else 0)
        chart.setMaximumHeight(CHART_PX if below else ANY_HEIGHT)

    def refresh(self, count: int) -> None:
        """Show the cutting plane in numbers, and the profile of the cloud's first `count` points in it."""
        cut, plane = self._cut, self._cut.plane
        if plane is None:
            return
        names = [f"{axis}′" for axis in AXES] if cut.turned_deg or cut.tilted_deg else AXES
        for place, word in enumerate(_hiding(names[plane.axis])):
            self.side.setItemText(place, word)
        with QSignalBlocker(self.axis), QSignalBlocker(self.turned), QSignalBlocker(self.tilted):
            self.axis.setCurrentIndex(plane.axis)
            self.turned.setValue(cut.turned_deg)
            self.tilted.setValue(cut.tilted_deg)
        self.side.setCurrentIndex(SIDES.index(cut.hides))
        low, high = cut.reach
        with QSignalBlocker(self.at):
            self.at.setRange(low, high)
            self.at.setValue(plane.at_mm)
        profile = cut.profile(count)
        height = names[plane.height]
        shown = names[plane.across], height if plane.upwards > 0 else f"−{height}"
        if shown != self._names:  # each call draws the chart anew
            self._names = shown
            self.chart.set_axes(shown[0], "mm", shown[1], "mm")
        self.chart.set_curve("points", profile.position, profile.height, colour=PROPOSED, points=True)
        self.chart.set_curve("mean", *profile.mean_line)
        self.show_keep()

    def show_keep(self) -> None:
        """Enable the button that adds the cut to the plan, or disable it with the reason."""
        why_not = self._cut.cannot_keep
        enable(self.keep, why_not, tr("Measure this cut as a feature of the plan; undoable"))


def _hiding(axis: str) -> tuple[str, str, str]:
    """What can be hidden of a cut square to this axis, in the order of SIDES."""
    return tr("both sides"), tr("hide larger {axis}", axis=axis), tr("hide smaller {axis}", axis=axis)
