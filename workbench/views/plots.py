"""The workbench's plots, under one roof."""

from __future__ import annotations

from workbench.views.plot_bars import Bar, BarsWithThreshold
from workbench.views.plot_lines import LineChart
from workbench.views.plot_map import HeatMap
from workbench.views.plot_residuals import ResidualPlot
from workbench.views.plot_runs import Histogram, RunChart

__all__ = ["Bar", "BarsWithThreshold", "HeatMap", "Histogram", "LineChart", "ResidualPlot", "RunChart"]
