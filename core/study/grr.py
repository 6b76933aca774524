"""Gauge repeatability and reproducibility by analysis of variance: parts × operators × repeats, both factors random.

With p parts, o operators, r repeats and the mean squares MS of parts, operators, their interaction and the error::

    repeatability    σ_E² = MS_E
    interaction      σ_PO² = (MS_PO − MS_E) / r
    operators        σ_O² = (MS_O − MS_PO) / (p r)
    parts            σ_P² = (MS_P − MS_PO) / (o r)

A negative estimate becomes 0. An interaction that is not significant (p > 0.05) is pooled with the error: MS_E and
MS_PO are then both (SS_PO + SS_E) / (ν_PO + ν_E), and σ_PO² is 0. Reproducibility is σ_O² + σ_PO², gauge R&R σ_E² more.

References
----------
AIAG, Measurement systems analysis, 4th ed., 2010, chapter III-B and appendix A.
Burdick, Borror, Montgomery, A review of methods for measurement systems capability analysis, Journal of Quality
Technology 35 (2003) 342.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc

from core.model.arrays import Array
from core.study.grr_intervals import Interval, intervals

POOLED_ABOVE = 0.05
"""An interaction with a larger p is pooled with the error."""
GOOD, USABLE = 0.10, 0.30
"""%GRR up to which a gauge is acceptable, and up to which it may be, by what hangs on it (AIAG)."""
ENOUGH_CATEGORIES = 5
ACCEPTABLE, CONDITIONAL, NOT_ACCEPTABLE = "acceptable", "acceptable with reservations", "not acceptable"


@dataclass(frozen=True, slots=True)
class AnovaRow:
    """A line of the table: sum of squares, degrees of freedom, mean square, F and its p (None for error and total)."""

    source: str
    ss: float
    dof: int
    ms: float
    f: float | None = None
    p: float | None = None


@dataclass(frozen=True, slots=True)
class Component:
    """A component of the variation.

    Parameters
    ----------
    source
        "gauge R&R", "repeatability", "reproducibility", "operators", "interaction", "parts" or "total".
    variance
        Estimated, not below 0.
    variance_interval
        95 % confidence interval of it.
    contribution
        Variance over the total variance.
    of_total
        Standard deviation over the total's: % study variation.
    of_tolerance
        6 standard deviations over the tolerance's full width T; None without one.
    """

    source: str
    variance: float
    variance_interval: Interval
    contribution: float
    of_total: float
    of_tolerance: float | None

    @property
    def sigma(self) -> float:
        """Standard deviation."""
        return math.sqrt(self.variance)


@dataclass(frozen=True, eq=False, slots=True)
class GrrStudy:
    """A crossed study.

    Parameters
    ----------
    values
        (p, o, r).
    parts, operators
        Their names.
    anova
        The full table: parts, operators, interaction, error, total. With one operator: parts, error, total.
    pooled_anova
        The table without the interaction; empty where that was kept.
    components
        See `Component`; in that order.
    tolerance
        T = upper − lower limit: the full width, twice a ± tolerance; None if none was stated.
    grr_interval, tolerance_interval
        95 % confidence intervals of %GRR of the total variation, and of the tolerance (None without one): fractions.
    ndc
        Number of distinct categories, √2 σ_P / σ_GRR, before it is cut off to a whole number; inf for a perfect gauge.
    ndc_interval
        95 % confidence interval of it.
    unit
        Of the values.
    """

    values: Array
    parts: tuple[str, ...]
    operators: tuple[str, ...]
    anova: tuple[AnovaRow, ...]
    pooled_anova: tuple[AnovaRow, ...]
    components: tuple[Component, ...]
    tolerance: float | None
    grr_interval: Interval
    tolerance_interval: Interval | None
    ndc: float
    ndc_interval: Interval
    unit: str = "mm"

    def component(self, source: str) -> Component:
        """The component of that name."""
        return next(one for one in self.components if one.source == source)

    @property
    def pooled(self) -> bool:
        """Whether the interaction was pooled with the error."""
        return bool(self.pooled_anova)

    @property
    def categories(self) -> int | None:
        """Number of distinct categories, a whole number of at least 1; None for a perfect gauge."""
        return None if math.isinf(self.ndc) else max(int(self.ndc), 1)

    @property
    def grr(self) -> float:
        """The %GRR that decides, as a fraction: of T if it is stated (the parts of a study seldom are the process)."""
        of_all = self.component("gauge R&R")
        return of_all.of_total if of_all.of_tolerance is None else of_all.of_tolerance

    @property
    def verdict(self) -> str:
        """ACCEPTABLE up to 10 %, CONDITIONAL up to 30 %, else NOT_ACCEPTABLE (AIAG, chapter II-D)."""
        if self.grr <= GOOD:
            return ACCEPTABLE
        return CONDITIONAL if self.grr <= USABLE else NOT_ACCEPTABLE

    @property
    def notes(self) -> tuple[str, ...]:
        """What to know about the figures: whole sentences."""
        p, o, r = self.values.shape
        said = []
        if self.pooled:
            said.append(
                "The interaction of parts and operators is not significant (p > 0.05) and is pooled with the error."
            )
        if o == 1:
            said.append("One operator alone shows no reproducibility: gauge R&R is the repeatability.")
        if p < 10 or o < 3 or r < 2 or p * o * r < 60:
            said.append(f"{p} × {o} × {r} measurements are few: 10 parts, 3 operators and 2 to 3 repeats are usual.")
        if self.categories is not None and self.categories < ENOUGH_CATEGORIES:
            said.append(
                f"{self.categories} distinct categories: with fewer than {ENOUGH_CATEGORIES} the gauge hardly tells "
                "these parts apart."
            )
        return tuple(said)


def grr_study(
    values: Array,
    *,
    parts: Sequence[str] = (),
    operators: Sequence[str] = (),
    tolerance: float | None = None,
    unit: str = "mm",
) -> GrrStudy:
    """Study of every part measured by every operator, each as often.

    Parameters
    ----------
    values
        (p, o, r): p ≥ 2 parts, o ≥ 1 operators, r ≥ 2 repeats.
    parts, operators
        Names; else "1", "2", …
    tolerance
        T, the full width of the tolerance, if %GRR shall be told of it.
    unit
        Of values and tolerance.

    Raises
    ------
    ValueError
        If there are too few parts or repeats, a value is not finite, all values are the same, or the tolerance is not
        above 0.
    """
    y = np.array(values, dtype=np.float64)
    if y.ndim != 3 or y.shape[0] < 2 or y.shape[1] < 1 or y.shape[2] < 2 or not np.isfinite(y).all():
        raise ValueError("a gauge R&R study needs two parts, one operator and two repeats of each, or more, all finite")
    if not np.ptp(y) > 0:
        raise ValueError("a gauge R&R study needs values that differ")
    if tolerance is not None and not (tolerance > 0 and math.isfinite(tolerance)):
        raise ValueError(f"a tolerance of {tolerance} is none")
    y.setflags(write=False)
    names = (tuple(parts) or _numbers(y.shape[0]), tuple(operators) or _numbers(y.shape[1]))
    full = _anova(y)
    interaction = next((row for row in full if row.source == "interaction"), None)
    pooled = (
        _pooled(full) if interaction is not None and interaction.p is not None and interaction.p > POOLED_ABOVE else ()
    )
    squares = {row.source: (row.ms, row.dof) for row in (pooled or full) if row.source != "total"}
    found = intervals(squares, y.shape, tolerance)
    total = found.estimates["total"]
    components = tuple(
        Component(
            source,
            variance,
            found.variances[source],
            variance / total,
            math.sqrt(variance / total),
            None if tolerance is None else 6 * math.sqrt(variance) / tolerance,
        )
        for source, variance in found.estimates.items()
    )
    return GrrStudy(
        y,
        *names,
        full,
        pooled,
        components,
        tolerance,
        found.of_total,
        found.of_tolerance,
        found.ndc,
        found.categories,
        unit,
    )


def _numbers(count: int) -> tuple[str, ...]:
    return tuple(str(number) for number in range(1, count + 1))


def _anova(y: Array) -> tuple[AnovaRow, ...]:
    """The table of a balanced crossed study; F is against the interaction, of that against the error."""
    p, o, r = y.shape
    grand = y.mean()
    of_part, of_operator, of_cell = y.mean(axis=(1, 2)), y.mean(axis=(0, 2)), y.mean(axis=2)
    ss_part = o * r * float(((of_part - grand) ** 2).sum())
    ss_operator = p * r * float(((of_operator - grand) ** 2).sum())
    ss_both = r * float(((of_cell - of_part[:, None] - of_operator + grand) ** 2).sum())
    ss_error = float(((y - of_cell[:, :, None]) ** 2).sum())
    total = AnovaRow("total", float(((y - grand) ** 2).sum()), y.size - 1, math.nan)
    error = _row("error", ss_error, p * o * (r - 1))
    if o == 1:
        return _row("parts", ss_part, p - 1, error), error, total
    both = _row("interaction", ss_both, (p - 1) * (o - 1), error)
    return _row("parts", ss_part, p - 1, both), _row("operators", ss_operator, o - 1, both), both, error, total


def _pooled(full: tuple[AnovaRow, ...]) -> tuple[AnovaRow, ...]:
    """The table with the interaction given to the error."""
    part, operator, both, error, total = full
    pool = _row("error", both.ss + error.ss, both.dof + error.dof)
    return _row("parts", part.ss, part.dof, pool), _row("operators", operator.ss, operator.dof, pool), pool, total


def _row(source: str, ss: float, dof: int, against: AnovaRow | None = None) -> AnovaRow:
    ms = ss / dof
    if against is None:
        return AnovaRow(source, ss, dof, ms)
    f = ms / against.ms if against.ms else math.inf
    return AnovaRow(source, ss, dof, ms, f, float(fdtrc(dof, against.dof, f)))
