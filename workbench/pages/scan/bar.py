"""Going through the frames: slider, stages, and what is said of the frame."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QButtonGroup,
    QCheckBox,
    QHBoxLayout,
    QPushButton,
    QToolButton,
    QWidget,
)

from workbench.language import tr
from workbench.pages.scan import words
from workbench.pages.scan.picture import View
from workbench.pages.scan.presenter import ScanPresenter
from workbench.pages.scan.run import short
from workbench.theme import icon
from workbench.views.common import Slider
from workbench.views.layouts import Elided, Folding, enable, in_column, in_row


class FrameBar(QWidget):
    """Bar with the current frame, its stage, and whether it counts."""

    view_chosen = Signal(object)
    """View."""

    def __init__(self, presenter: ScanPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.back, self.on, self.next_mark = QToolButton(), QToolButton(), QToolButton()
        self.slider, self.used, self.said = Slider(Qt.Orientation.Horizontal), QCheckBox(tr("use it")), Elided()
        self.stages: dict[View, QPushButton] = {}
        self._group = QButtonGroup(self)
        self._lay_out()
        self.slider.valueChanged.connect(presenter.scrub.go_to)
        self.back.clicked.connect(lambda: presenter.scrub.step(-1))
        self.on.clicked.connect(lambda: presenter.scrub.step(1))
        self.next_mark.clicked.connect(lambda: presenter.go_to_next_mark())
        self.used.clicked.connect(lambda on: presenter.set_used([presenter.scrub.current], on))

    def refresh(self) -> None:
        """Show the current frame's number and sentence, and the stages that can be shown."""
        p = self._presenter
        names, scrub = p.work.names, p.scrub
        self.slider.blockSignals(True)
        self.slider.setRange(0, max(len(names) - 1, 0))
        self.slider.setPageStep(max(len(names) // 10, 1))
        self.slider.setValue(max(scrub.index, 0))
        self.slider.blockSignals(False)
        first, last = scrub.index <= 0, scrub.index >= len(names) - 1
        enable(self.back, tr("It is the first frame.") if first else "", self.back.accessibleName())
        enable(self.on, tr("It is the last frame.") if last else "", self.on.accessibleName())
        self.used.setChecked(not p.is_left_out(scrub.current))
        if scrub.current:
            stages = scrub.stages if scrub.up_to_date else None
            record = p.record_of(scrub.current)
            said = words.frame_sentence(
                scrub.index, len(names), short(scrub.current), record, stages, has_fan=p.has_fan
            )
            self.said.setText(tr("{frame} Marked.", frame=said) if scrub.current in p.work.marked else said)
        self.next_mark.setVisible(bool(p.work.marked))
        why_not = "" if p.record_of(scrub.current) is not None else tr("Measure the scan first.")
        enable(self.stages[View.POINTS], why_not, self._tips()[View.POINTS])

    def choose(self, view: View) -> None:
        """Mark the stage `view` of the frame as the one that is shown."""
        self.stages[view].setChecked(True)

    def _lay_out(self) -> None:
        titles = {
            View.RECORDED: tr("Recorded"),
            View.DIFFERENCE: tr("Difference"),
            View.RIDGE: tr("Ridge strength"),
            View.CENTRELINES: tr("Centrelines"),
            View.CROSSINGS: tr("Crossings"),
            View.POINTS: tr("Points"),
        }
        halves = in_row(spacing=0), in_row(spacing=0)
        for number, (view, title) in enumerate(titles.items()):
            button = QPushButton(title)
            button.setCheckable(True)
            button.setToolTip(self._tips()[view])
            button.clicked.connect(lambda _=False, view=view: self.view_chosen.emit(view))
            self._group.addButton(button)
            self.stages[view] = button
            halves[2 * number // len(titles)].addWidget(button, 1)
        for tool, symbol, tip in (
            (self.back, "mdi6.chevron-left", tr("The frame before (←)")),
            (self.on, "mdi6.chevron-right", tr("The next frame (→)")),
            (self.next_mark, "mdi6.flag-outline", tr("The next frame that was marked")),
        ):
            tool.setIcon(icon(symbol))
            tool.setAutoRaise(True)
            tool.setAutoRepeat(True)
            tool.setIconSize(QSize(18, 18))
            tool.setToolTip(tip)
            tool.setAccessibleName(tip)
        self.slider.setAccessibleName(tr("Frame"))
        self.slider.setToolTip(tr("Go through the frames (← and →)"))
        self.used.setToolTip(tr("Whether this frame counts; take the tick away to leave it out, then measure again"))
        along = QHBoxLayout()
        along.setSpacing(4)
        for widget, stretch in ((self.back, 0), (self.slider, 1), (self.on, 0), (self.next_mark, 0), (self.used, 0)):
            along.addWidget(widget, stretch)
        column = in_column(Folding(*halves, spacing=0), along, on=self, margins=(0, 4, 0, 0), spacing=4)
        self.said.setObjectName("muted")
        self.said.setWordWrap(True)
        words = self.used.text()  # in the window's own letters: those of some languages are higher than the font's line
        two_lines = self.said.fontMetrics().boundingRect(self.rect(), Qt.TextFlag.TextWordWrap, f"{words}\n{words}")
        self.said.setFixedHeight(two_lines.height())
        self.said.setAlignment(Qt.AlignmentFlag.AlignTop)
        column.addWidget(self.said)

    def _tips(self) -> dict[View, str]:
        return {
            View.RECORDED: tr("The picture as it was recorded"),
            View.DIFFERENCE: tr("The picture without the reference, brightened: the hand-held laser alone"),
            View.RIDGE: tr("How much each place looks like a stripe (Steger's strength), brightened"),
            View.CENTRELINES: tr("The centrelines found: the fan's by number, and the sweep's"),
            View.CROSSINGS: tr("Where sweep and fan cross: good, weak or left out; hover for the reason"),
            View.POINTS: tr("The measured points of this frame, coloured by σ"),
        }
