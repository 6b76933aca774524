"""The workbench's plots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from workbench.views.colours import ColourLike


@dataclass(frozen=True, slots=True)
class Bar:
    """One view or pose; `value` None where there is none."""

    name: str
    value: float | None
    used: bool = True
    tip: str = ""


class BarsWithThreshold(QWidget):
    """One bar a view, and a threshold that can be dragged."""

    threshold_changed = Signal(float)
    threshold_moving = Signal(float)
    bar_clicked = Signal(str)

    def set_bars(self, bars: Sequence[Bar], *, label: str, unit: str, threshold: float | None = None) -> None: ...
    def set_current(self, name: str) -> None: ...


class ResidualPlot(QWidget):
    """Residual vectors over the picture, enlarged, or as a scatter with the RMS circle."""

    def set_residuals(
        self,
        uv: ArrayLike,
        residuals: ArrayLike,
        *,
        size: tuple[int, int],
        rms: float | None = None,
        counted: ArrayLike | None = None,
        unit: str = "px",
    ) -> None: ...


class RunChart(QWidget):
    """Repeats with their U, the mean, the nominal and the tolerance."""

    def set_runs(
        self,
        values: ArrayLike,
        U: ArrayLike,
        *,
        labels: Sequence[str] | None = None,
        mean: float | None = None,
        nominal: float | None = None,
        tolerance: float | None = None,
        unit: str = "mm",
        k: float = 2.0,
    ) -> None: ...


class Histogram(QWidget):
    """How values are spread."""

    def set_values(
        self,
        values: ArrayLike,
        *,
        label: str,
        unit: str,
        bins: int | None = None,
        limits: Sequence[tuple[float, str]] = (),
    ) -> None: ...


class HeatMap(QWidget):
    """A grid of values over the picture, with a colour bar."""

    def set_map(
        self,
        values: ArrayLike,
        *,
        size: tuple[int, int],
        label: str,
        unit: str,
        limits: tuple[float, float] | None = None,
        colour_map: str = "viridis",
    ) -> None: ...


class LineChart(QWidget):
    """Curves over one axis."""

    def set_axes(self, x_label: str, x_unit: str, y_label: str, y_unit: str) -> None: ...
    def set_curve(
        self, name: str, x: ArrayLike, y: ArrayLike, *, colour: ColourLike = "", title: str = "", points: bool = False
    ) -> None: ...
    def set_limit(self, name: str, y: float | None, text: str = "") -> None: ...
    def clear(self, message: str = "") -> None: ...
