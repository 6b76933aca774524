"""What is shown of the surface: points or mesh, what colours it, and up to which σ."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QButtonGroup,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QWidget,
)

from core.inspect.shown.shown_scan import DEPTH
from workbench.language import tr
from workbench.views.common import Choice, Slider, SpinBox
from workbench.views.layouts import Folding, enable, in_row

if TYPE_CHECKING:
    from core.inspect.shown.shown_scan import InspectionView
    from workbench.pages.inspect.stage import SurfaceButtons

STEPS = 200
"""Of the slider from the smallest σ to the largest."""

ARROW_PX = 48
"""Of a list that folds out, beside its text."""

LEAST_SLIDER_PX = 70
"""A shorter slider cannot be set by hand."""

Shape = Literal["points", "mesh", "both"]


class SurfaceChoices(QWidget):
    """Bar over the 3D view. `layers` are colours that wings bring, by name, each with its title."""

    changed = Signal()
    """The shape or the colour is another one."""

    limited = Signal(object)
    """Points up to this σ in mm are to be shown; None: all."""

    def __init__(self, layers: Mapping[str, str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._layers = layers
        self.shapes: dict[Shape, QPushButton] = {}
        self._tips: dict[Shape, str] = {}
        self._nominal = False
        self._before = "height"
        self.colours, self.limit, self.slider = Choice(), SpinBox(), Slider(Qt.Orientation.Horizontal)
        look, limit = in_row(spacing=4), in_row(spacing=4)
        self._make_shapes(look)
        look.addSpacing(4)
        self._make_colours(look)
        look.addStretch()
        limit.addStretch(1)
        self._make_limit(limit)
        in_row(Folding(look, limit, spacing=4, share=2), on=self)

    @property
    def shape(self) -> Shape:
        """What is drawn of the surface: "points", "mesh" or "both"."""
        return next(name for name, button in self.shapes.items() if button.isChecked())

    @property
    def colour(self) -> str:
        """What the surface is coloured by: "faces", "sigma", "height", "deviation", "nominal", …."""
        return str(self.colours.currentData())

    def choose_colour(self, name: str) -> None:
        """Choose what the surface is coloured by."""
        self.colours.setCurrentIndex(self.colours.findData(name))

    def show_layer(self, name: str, why_not: str) -> None:
        """Enable colouring by the layer called `name`, or, with a reason `why_not`, disable it."""
        self._offer(name, why_not)

    def show_nominal(self, there: bool) -> None:
        """Colour by deviations from the nominal surface if they are `there`; else by what was chosen before."""
        was, self._nominal = self._nominal, there
        if there and not was:
            self._before = self.colour
            self._offer("nominal", "")
            self.choose_colour("nominal")
        elif not there:
            if self.colour == "nominal":
                self.choose_colour(self._before)
            self._offer("nominal", tr("Choose a deviation from a nominal surface in the list of features."))

    def show_view(self, view: InspectionView | None, can: SurfaceButtons, clip_mm: float | None) -> None:
        """Enable the choices that a scan has; None: no scan is shown, and nothing can be chosen."""
        for name, button in self.shapes.items():
            enable(button, can.use if name == "points" else can.mesh, self._tips[name])
        for widget in (self.colours, self.limit, self.slider):
            widget.setEnabled(view is not None)
        if view is None:
            return
        if view.mesh is None and self.shape != "points":
            self.shapes["points"].setChecked(True)
        self._name_colours(view)
        self._show_limit(view, clip_mm)

    def _make_shapes(self, bar: QHBoxLayout) -> None:
        group = QButtonGroup(self)
        entries: tuple[tuple[Shape, str, str], ...] = (
            ("points", tr("Points"), tr("Show the measured points")),
            ("mesh", tr("Mesh"), tr("Show the triangulated surface")),
            ("both", tr("Both"), tr("Show the points on the triangulated surface")),
        )
        for name, text, tip in entries:
            button = QPushButton(text)
            self._tips[name] = tip
            button.setCheckable(True)
            group.addButton(button)
            bar.addWidget(button)
            self.shapes[name] = button
        self.shapes["points"].setChecked(True)
        group.buttonToggled.connect(lambda _, on: self.changed.emit() if on else None)

    def _make_colours(self, bar: QHBoxLayout) -> None:
        self.colours.setAccessibleName(tr("Colour by"))
        self.colours.setSizeAdjustPolicy(Choice.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.colours.setMinimumContentsLength(7)
        self.colours.setToolTip(tr("What the colours of the surface mean"))
        for name, text in (
            ("faces", tr("points used")),
            ("height", tr("height")),
            ("sigma", tr("σ of the points")),
            ("deviation", tr("deviation from face")),
            ("nominal", tr("deviation from nominal")),
            *self._layers.items(),
            ("frame", tr("frame")),
            ("plain", tr("nothing (plain)")),
        ):
            self.colours.addItem(text, name)
        widest = max(
            self.fontMetrics().horizontalAdvance(self.colours.itemText(n)) for n in range(self.colours.count())
        )
        self.colours.setMaximumWidth(widest + ARROW_PX)  # where there is room no choice is cut
        self.choose_colour("height")
        self.colours.currentIndexChanged.connect(lambda _: self.changed.emit())
        label = QLabel(tr("Colour"))
        label.setBuddy(self.colours)
        bar.addWidget(label)
        bar.addWidget(self.colours, 1)

    def _make_limit(self, bar: QHBoxLayout) -> None:
        tip = tr(
            "Show points up to this standard uncertainty σ. Only what is seen changes: the thickness uses all points "
            "of its faces."
        )
        self.limit.setSuffix(" mm")
        self.limit.setKeyboardTracking(False)
        self.slider.setRange(1, STEPS)
        self.slider.setMinimumWidth(LEAST_SLIDER_PX)
        self.slider.setMaximumWidth(150)
        label = QLabel(tr("σ up to"))
        label.setBuddy(self.limit)
        for widget in (label, self.limit, self.slider):
            widget.setToolTip(tip)
        for widget in (self.limit, self.slider):
            widget.setAccessibleName(tr("Show points up to this σ"))
        self.limit.valueChanged.connect(self._limited)
        self.slider.valueChanged.connect(self._slid)
        bar.addWidget(label)
        bar.addWidget(self.limit)
        bar.addWidget(self.slider, 1)

    def _name_colours(self, view: InspectionView) -> None:
        """Without a lower face heights are depths, and there is nothing to colour by faces."""
        place = self.colours.findData("height")
        self.colours.setItemText(place, tr("depth") if view.height_is == DEPTH else tr("height"))
        for name in ("faces", "deviation"):
            self._offer(name, "" if view.gauge is not None else tr("Measure the thickness first."))

    def _offer(self, name: str, why_not: str) -> None:
        """Offer a colour, or say why it cannot be chosen; then height is, if it was."""
        model: Any = self.colours.model()
        place = self.colours.findData(name)
        model.item(place).setEnabled(not why_not)
        self.colours.setItemData(place, why_not, Qt.ItemDataRole.ToolTipRole)
        if why_not and self.colour == name:
            self.choose_colour("height")

    def _show_limit(self, view: InspectionView, clip_mm: float | None) -> None:
        largest = float(view.sigma[-1])
        for widget in (self.limit, self.slider):
            widget.blockSignals(True)
        self.limit.setDecimals(4 if largest < 0.1 else 3)
        self.limit.setRange(float(view.sigma[0]), _up(largest, self.limit.decimals()))
        self.limit.setSingleStep(10.0 ** -(self.limit.decimals() - 1))
        self.limit.setValue(self.limit.maximum() if clip_mm is None else clip_mm)
        self.slider.setValue(STEPS if clip_mm is None else round(STEPS * clip_mm / self.limit.maximum()))
        for widget in (self.limit, self.slider):
            widget.blockSignals(False)

    def _limited(self, value: float) -> None:
        self.limited.emit(None if value >= self.limit.maximum() else value)

    def _slid(self, step: int) -> None:
        self.limited.emit(None if step >= STEPS else self.limit.maximum() * step / STEPS)


def _up(value: float, decimals: int) -> float:
    """The next number of so many decimals that is not below `value`."""
    return float(np.ceil(round(value * 10**decimals, 6)) / 10**decimals)
