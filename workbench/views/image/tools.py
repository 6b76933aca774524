"""What stands round a picture: the strip with readout and buttons, the brightness popover, the legend."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QFontDatabase
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QLabel,
    QMenu,
    QPushButton,
    QToolButton,
    QWidget,
    QWidgetAction,
)

from workbench.language import number, tr
from workbench.theme import icon
from workbench.views.common import Slider
from workbench.views.layouts import in_row

_STEPS = 20
"""Slider steps for a factor of two."""


class ToolStrip(QFrame):
    """Strip with the readout at the left, buttons at the right."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.readout = QLabel()
        self.readout.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.readout.setObjectName("muted")
        self.zoom = QLabel()
        self.zoom.setObjectName("muted")
        self.zoom.setToolTip(tr("Size of a picture pixel on the screen"))
        self.fit = self._button("mdi6.fit-to-page-outline", tr("Show the whole picture (F)"))
        self.one = self._button("mdi6.numeric-1-box-outline", tr("One picture pixel on one screen pixel (1)"))
        self.tone = self._button("mdi6.brightness-6", tr("Brightness of the picture on the screen"))
        self.layers = self._button("mdi6.layers-outline", tr("Show or hide what is drawn on the picture"))
        for button in (self.tone, self.layers):
            button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self._row = in_row((self.readout, 1), self.zoom, on=self, margins=(6, 1, 2, 1), spacing=2)
        self._row.addSpacing(6)
        self._place_for_tools = self._row.count()
        for button in (self.fit, self.one, self.tone, self.layers):
            self._row.addWidget(button)

    def add_tool(self, widget: QWidget) -> None:
        """Add a widget to the strip under the picture, before its buttons."""
        self._row.insertWidget(self._place_for_tools, widget)
        self._place_for_tools += 1

    def set_layers_tip(self, titles: Sequence[str]) -> None:
        """List the layers' titles in the tooltip of the layers button; [] lists none."""
        self.layers.setToolTip("\n".join((self.layers.accessibleName(), *titles)))

    def _button(self, symbol: str, tip: str) -> QToolButton:
        button = QToolButton()
        button.setAutoRaise(True)
        button.setIconSize(QSize(18, 18))
        button.setToolTip(tip)
        button.setAccessibleName(tip)
        button.setIcon(icon(symbol))
        return button


class ToneMenu(QMenu):
    """Menu with two sliders: brightness, and how much the dark is lifted. Only the screen changes, never what is
    measured.
    """

    changed = Signal(float, float)
    """Gain and gamma."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.gain, self._gain_text = self._slider(-2 * _STEPS, 5 * _STEPS)
        self.gamma, self._gamma_text = self._slider(-_STEPS, 2 * _STEPS)
        self.gain.setAccessibleName(tr("Brightness"))
        self.gamma.setAccessibleName(tr("Dark parts"))
        panel = QWidget()
        grid = QGridLayout(panel)
        grid.setContentsMargins(12, 10, 12, 10)
        for row, (title, slider, text) in enumerate(
            (
                (tr("Brightness"), self.gain, self._gain_text),
                (tr("Lift the dark"), self.gamma, self._gamma_text),
            )
        ):
            grid.addWidget(QLabel(title), row, 0)
            grid.addWidget(slider, row, 1)
            grid.addWidget(text, row, 2)
        note = QLabel(tr("On the screen only; measuring is not affected."))
        note.setObjectName("help")
        reset = QPushButton(tr("Reset"))
        reset.clicked.connect(self.reset)
        grid.addWidget(note, 2, 0, 1, 2)
        grid.addWidget(reset, 2, 2)
        action = QWidgetAction(self)
        action.setDefaultWidget(panel)
        self.addAction(action)
        self._say()

    @property
    def values(self) -> tuple[float, float]:
        """Gain and gamma that the sliders are set to."""
        return 2.0 ** (self.gain.value() / _STEPS), 2.0 ** (self.gamma.value() / _STEPS)

    def reset(self) -> None:
        """Reset both sliders, so that the picture is shown as it is."""
        self.gain.setValue(0)
        self.gamma.setValue(0)

    def _slider(self, low: int, high: int) -> tuple[Slider, QLabel]:
        slider = Slider(Qt.Orientation.Horizontal)
        slider.setRange(low, high)
        slider.setMinimumWidth(180)
        slider.valueChanged.connect(self._say)
        text = QLabel()
        text.setMinimumWidth(64)
        text.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        return slider, text

    def _say(self) -> None:
        gain, gamma = self.values
        self._gain_text.setText(f"× {number(gain, '.2f')}")
        self._gamma_text.setText(f"γ {number(gamma, '.2f')}")
        self.changed.emit(gain, gamma)
