"""The study of a series: parts measured one after another. Is their making steady, and do they fit their limits?

Cp and Cpk are told only with their 95 % intervals, and only beside charts with limits of their own; Pp and Ppk, of the
whole scatter, from FEWEST_POINTS values on. `series_chart` and `capability` say by which formula.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from core.errors import WrongValue
from core.findings.proof import notes_of
from core.findings.table import note_of
from core.inspect.results import Contribution
from core.messages import Message
from core.model.arrays import Array
from core.wings.studies.kinds.budget import OF_EACH_SCAN
from core.wings.studies.kinds.capability import LIMIT, Index, Indices, Scatter, indices, looks_normal
from core.wings.studies.kinds.doubted import Doubted, doubts_of_study
from core.wings.studies.kinds.repeats import THICKNESS
from core.wings.studies.kinds.series_chart import (
    FEWEST_POINTS,
    POINTS_A_BREAK,
    RULE_WORDS,
    SeriesCharts,
    single_values,
    subgroups,
)

Finding: TypeAlias = Literal["", "capable", "not capable", "not proven"]
LARGEST_SUBGROUP = 25
"""Values; Montgomery's tables end there."""


@dataclass(frozen=True, slots=True)
class StatedUncertainty:
    """Stated standard uncertainties of the measurements of a series in quadratic mean, in its unit.

    `own` is drawn anew with each measurement and so surely part of their scatter; `whole` is all of it. What is not
    known to be drawn anew (`common`) may move all of them alike.
    """

    own: float
    whole: float

    @property
    def common(self) -> float:
        """Standard uncertainty that all measurements of the series share, √(whole² − own²)."""
        return math.sqrt(max(0.0, self.whole**2 - self.own**2))


@dataclass(frozen=True, eq=False, slots=True)
class SeriesStudy:
    """Study of values of one characteristic of part after part.

    Parameters
    ----------
    name
        Of the characteristic.
    labels
        (n,) of the parts, in the order of measuring.
    values
        (n,) in `unit`.
    size
        Values a subgroup, one after another; 1: single values. What is over at the end awaits its subgroup: it stands
        on no chart, but in Pp and Ppk.
    lower, upper
        Limits of the characteristic, −inf and inf where there is none.
    stated
        None if no uncertainty is stated.
    charts
        None where they are too few points, or all values are the same.
    short, overall
        Cp and Cpk by the scatter within a short time; Pp and Ppk by that of all values. None without limits of the
        characteristic, or with too few points or values.
    unit
        "mm" or "deg".
    doubted
        Parts whose results prove nothing.
    """

    name: str
    labels: tuple[str, ...]
    values: Array
    size: int
    lower: float
    upper: float
    stated: StatedUncertainty | None
    charts: SeriesCharts | None
    short: Indices | None
    overall: Indices | None
    unit: str = "mm"
    doubted: Doubted = ()

    @property
    def n(self) -> int:
        """Number of values in the series."""
        return len(self.values)

    @property
    def points(self) -> int:
        """Number of points of each control chart: whole subgroups, or single values."""
        return self.n // self.size

    @property
    def mean(self) -> float:
        """Mean of all values of the series."""
        return float(self.values.mean())

    @property
    def s(self) -> float:
        """Standard deviation of all values of the series, over n − 1."""
        return float(self.values.std(ddof=1)) if np.ptp(self.values) else 0.0

    @property
    def indices(self) -> dict[str, Index]:
        """Capability indices by name, Cp, Cpk, Pp and Ppk; those that are not known are missing."""
        found: dict[str, Index | None] = {}
        if self.short is not None:
            found |= {"Cp": self.short.p, "Cpk": self.short.pk}
        if self.overall is not None:
            found |= {"Pp": self.overall.p, "Ppk": self.overall.pk}
        return {name: index for name, index in found.items() if index is not None}

    @property
    def share_of_u(self) -> tuple[float, float] | None:
        """Smallest and largest share of the variance s² that the measurement's uncertainty can account for.

        None without stated uncertainty, or if s is 0.
        """
        if self.stated is None or not self.s:
            return None
        own, whole = (min(1.0, (u / self.s) ** 2) for u in (self.stated.own, self.stated.whole))
        return own, whole

    @property
    def verdict(self) -> Finding:
        """Verdict "capable" if Cpk and Ppk are surely LIMIT or more, "not capable" if one is surely less, at 95 %.

        Nothing is proven of a process that left its control limits, nor by values that are too few or doubted.
        """
        if math.isinf(self.lower) and math.isinf(self.upper):
            return ""
        if self.doubted or self.charts is None or self.short is None or self.overall is None or self._beyond_limits:
            return "not proven"
        intervals = self.short.pk.interval, self.overall.pk.interval
        if min(low for low, _ in intervals) >= LIMIT:
            return "capable"
        return "not capable" if min(high for _, high in intervals) < LIMIT else "not proven"

    @property
    def notes(self) -> tuple[Message, ...]:
        """Notes on what limits the study of a series, in its control charts and in its capability."""
        return (*self._of_charts(), *self._of_capability())

    def label_of(self, point: int) -> str:
        """Return the label of a point of the location chart: its part, or the first and last part of its subgroup."""
        first, last = self.labels[point * self.size], self.labels[(point + 1) * self.size - 1]
        return first if first == last else f"{first} … {last}"

    def label_of_spread(self, point: int) -> str:
        """Return the label of a point of the spread chart: its subgroup, or the two parts of a moving range."""
        return self.label_of(point) if self.size > 1 else f"{self.labels[point]} … {self.labels[point + 1]}"

    @property
    def _beyond_limits(self) -> bool:
        """Whether a point is beyond its limits; not a moving range, which once in 100 is with a steady process, too."""
        charts = self.charts
        if charts is None:
            return False
        return any(one.rule == 1 for one in charts.location.breaks) or (self.size > 1 and bool(charts.spread.breaks))

    def _of_charts(self) -> list[Message]:
        said = []
        if self.points < FEWEST_POINTS:
            said.append(note_of("study.series_too_short", n=self.points, least=FEWEST_POINTS))
        elif self.charts is None:
            said.append(note_of("study.series_no_spread"))
        if over := self.n % self.size:
            said.append(note_of("study.series_values_over", n=over))
        if self.charts is None:
            return said
        breaks = self.charts.location.breaks
        said += [
            note_of(
                "study.rule_broken",
                rule=rule,
                words=words,
                names=[self.label_of(one.place) for one in breaks if one.rule == rule],
            )
            for rule, words in enumerate(RULE_WORDS, start=1)
            if any(one.rule == rule for one in breaks)
        ]
        if self.charts.spread.breaks:
            names = [self.label_of_spread(one.place) for one in self.charts.spread.breaks]
            said.append(note_of("study.spread_beyond_limits", names=names))
        if breaks:
            said.append(note_of("study.breaks_by_chance", every=POINTS_A_BREAK))
        return said

    def _of_capability(self) -> list[Message]:
        said = []
        if self.short is not None and self._beyond_limits:
            said.append(note_of("study.not_steady"))
        if self.overall is not None and not looks_normal(self.values):
            said.append(note_of("study.not_normal"))
        if self.stated is None and self.overall is not None:
            said.append(note_of("study.series_without_u"))
        return [*said, *notes_of(doubts_of_study(self.doubted))]


def stated_uncertainty(u: Sequence[float], budgets: Sequence[Sequence[Contribution]]) -> StatedUncertainty:
    """Combine n standard uncertainties `u` to their quadratic mean, and to the part that is each scan's own."""
    own = [row.u_mm**2 for budget in budgets for row in budget if row.source in OF_EACH_SCAN]
    return StatedUncertainty(
        math.sqrt(sum(own) / len(budgets)) if budgets else 0.0, math.sqrt(float(np.mean(np.square(u))))
    )


def series_study(
    values: Sequence[float],
    limits: tuple[float, float] = (-math.inf, math.inf),
    *,
    size: int = 1,
    stated: StatedUncertainty | None = None,
    name: str = THICKNESS,
    labels: Sequence[str] = (),
    unit: str = "mm",
    doubted: Doubted = (),
) -> SeriesStudy:
    """Analyse a series of n ≥ 2 values in the order of measuring: control charts and capability indices.

    Raises
    ------
    WrongValue
        If there are fewer than two values, one is not finite, the limits are not in order, or the subgroups' size is
        not 1 to 25.
    """
    measured = np.array(values, dtype=np.float64)
    if measured.ndim != 1 or len(measured) < 2 or not np.isfinite(measured).all():
        raise WrongValue(Message("study.series_too_few", "a series needs two finite values or more"))
    lower, upper = limits
    if not lower < upper:
        raise WrongValue(
            Message(
                "study.series_limits",
                "the lower limit must be below the upper one, not {lower} and {upper}",
                lower=lower,
                upper=upper,
            )
        )
    if not 1 <= size <= LARGEST_SUBGROUP:
        raise WrongValue(
            Message(
                "study.subgroup_size",
                "a subgroup has 1 to {most} values, not {size}",
                most=LARGEST_SUBGROUP,
                size=size,
            )
        )
    measured.setflags(write=False)
    charts = _charts(measured, size)
    n, common = len(measured), 0.0 if stated is None else stated.common
    short = overall = None
    if math.isfinite(lower) or math.isfinite(upper):
        if charts is not None:
            within = Scatter(charts.location.centre, charts.sigma, charts.dof, n - n % size, common)
            short = indices(within, lower, upper)
        if n >= FEWEST_POINTS and np.ptp(measured):
            whole = Scatter(float(measured.mean()), float(measured.std(ddof=1)), n - 1, n, common)
            overall = indices(whole, lower, upper)
    names = tuple(labels) or tuple(str(number) for number in range(1, n + 1))
    return SeriesStudy(name, names, measured, size, lower, upper, stated, charts, short, overall, unit, doubted)


def _charts(values: Array, size: int) -> SeriesCharts | None:
    """None with too few points for limits, or without any spread within them."""
    whole = values[: len(values) - len(values) % size]
    if len(whole) // size < FEWEST_POINTS:
        return None
    groups = whole.reshape(-1, size)
    if not np.any(np.ptp(groups if size > 1 else whole[None], axis=1)):
        return None
    return single_values(whole) if size == 1 else subgroups(groups)
