"""The plot of the chosen feature: the profile of a section, or how the deviations are spread, with their marks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtWidgets import QWidget

from core.inspect.plan.kinds import kind_of
from workbench.language import text_of, tr
from workbench.pages.inspect.features import words
from workbench.pages.inspect.features.edit import InspectFeatureEdit
from workbench.pages.inspect.features.plan import InspectFeatures
from workbench.views.colours import FEATURE
from workbench.views.layouts import STRETCH, Folding, in_column, in_row, muted
from workbench.views.lists.value_rows import ValueRows
from workbench.views.plots.lines import LineChart

if TYPE_CHECKING:
    from core.inspect.shown.shown_features import ShownDeviations, ShownFeature, ShownProfile


LEAST_CHART_PX, ROWS_PX = 260, 320
"""Widths; where there is less than both the numbers stand below the chart."""


class PlotTab(QWidget):
    """Tab with a chart, and beside it its numbers."""

    def __init__(self, features: InspectFeatures, edit: InspectFeatureEdit, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._features, self._edit = features, edit
        self._shown: object = None
        self.chart, self.rows, self.words = LineChart(), ValueRows(), muted()
        self.chart.setMinimumWidth(LEAST_CHART_PX)
        self.rows.setMinimumWidth(ROWS_PX)
        beside = in_column(self.rows, STRETCH)
        both = Folding(in_row(self.chart), beside, spacing=14, share=2)
        self._beside = both.part(1)
        in_column(self.words, (both, 1), on=self, margins=(6, 6, 6, 4))

    def refresh(self) -> None:
        """Show the chart of the chosen feature: a section's profile, or the distribution of deviations."""
        features = self._features
        result = features.result(features.chosen)
        wanted = (features.chosen, result)
        if wanted == self._shown:
            return
        self._shown = wanted
        self.words.setText("")
        if result is not None and result.profile is not None:
            self._show_profile(result, result.profile)
        elif result is not None and result.deviations is not None:
            self._show_deviations(result, result.deviations)
        else:
            self.rows.set_rows([])
            self.chart.clear(self._message(result))
        self._beside.setVisible(result is not None and bool(result.rows))

    def _message(self, result: ShownFeature | None) -> str:
        if result is not None and result.problem:
            return text_of(result.problem)
        spec = self._edit.spec
        if spec is not None and kind_of(spec).plotted:
            return tr("Measure the features: then what was found is drawn here.")
        return tr("Choose a cross-section or a deviation in the list of features: it is drawn here.")

    def _show_profile(self, result: ShownFeature, profile: ShownProfile) -> None:
        self.chart.clear()
        self.chart.set_axes(tr("along the cut"), "mm", tr("height in the cut"), "mm")
        title = tr("points near the cut")
        self.chart.set_curve("points", profile.position, profile.height, colour=FEATURE, title=title, points=True)
        self.chart.set_curve("mean", *profile.mean_line, title=tr("their median over each step"))
        self.words.setText(
            tr(
                "{name}: both axes lie in the plane of the cut; heights that are measured are square to the faces.",
                name=result.name,
            )
        )
        self.rows.set_rows(words.result_rows(result))

    def _show_deviations(self, result: ShownFeature, found: ShownDeviations) -> None:
        self.chart.clear()
        self.chart.set_axes(tr("measured − nominal"), "mm", tr("places"), "", from_zero=True)
        self.chart.set_curve("histogram", np.repeat(found.edges, 2)[1:-1], np.repeat(found.counts, 2))
        self.words.setText(
            tr(
                "{name}: the outermost bars hold all beyond. Marks are quarters of ±{tolerance:g} mm, ! is beyond it.",
                name=result.name,
                tolerance=found.tolerance_mm,
            )
        )
        self.rows.set_rows([*words.result_rows(result), *words.class_rows(found)])
