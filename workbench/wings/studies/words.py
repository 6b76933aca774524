"""Control charts of studies as the window draws them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.wings.studies.kinds.series import SeriesStudy
from core.wings.studies.kinds.series_chart import RULE_WORDS, Chart
from core.wings.studies.study_facts import chart_names, digits_of
from workbench.language import named, tr
from workbench.pages.words import wording

if TYPE_CHECKING:
    from core.wings.studies.kinds.study import Study


@dataclass(frozen=True, eq=False, slots=True)
class ShownChart:
    """Control chart as it is drawn: values (k,), NaN for none, whether each is good, its tip; the lines; the axes."""

    values: Array
    good: NDArray[np.bool_]
    tips: tuple[str, ...]
    limits: tuple[float, float, float]
    axes: tuple[str, str]


def charts(study: Study) -> tuple[ShownChart, ...]:
    """Convert the control charts of a study to what is drawn: two for a series with limits, else none."""
    if not isinstance(study, SeriesStudy) or study.charts is None:
        return ()
    both = (study.charts.location, study.label_of), (study.charts.spread, study.label_of_spread)
    return tuple(
        _shown(chart, study, label_of, (tr(title), tr("part") if study.size == 1 else tr("subgroup")))
        for (chart, label_of), title in zip(both, chart_names(study), strict=True)
    )


def _shown(chart: Chart, study: SeriesStudy, label_of: Callable[[int], str], axes: tuple[str, str]) -> ShownChart:
    """A chart as wide as the study: a moving range stands at its second value, and the first value has none."""
    missing = study.points - len(chart.points)
    tips = [""] * missing
    for place, value in enumerate(chart.points):
        said = named(label_of(place), f"{wording().fixed(float(value), digits_of(study))} {study.unit}")
        rules = [RULE_WORDS[one.rule - 1] for one in chart.breaks if one.place == place]
        tips.append("\n".join([said, *map(tr, rules)]))
    good = np.array([place - missing not in chart.breaking for place in range(study.points)])
    values = np.concatenate([np.full(missing, np.nan), chart.points])
    return ShownChart(values, good, tuple(tips), (chart.lower, chart.centre, chart.upper), axes)
