"""The workbench's plots, under one roof."""

from __future__ import annotations

from workbench.views.plot_bars import Bar, BarsWithThreshold
from workbench.views.plot_curves import Histogram, LineChart, RunChart
from workbench.views.plot_map import HeatMap
from workbench.views.plot_residuals import ResidualPlot

__all__ = ["Bar", "BarsWithThreshold", "HeatMap", "Histogram", "LineChart", "ResidualPlot", "RunChart"]
