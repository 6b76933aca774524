"""Gauge repeatability and reproducibility by analysis of variance: parts × operators × repeats, both factors random.

With p parts, o operators, r repeats and the mean squares MS of parts, operators, their interaction and the error::

    repeatability    σ_E² = MS_E
    interaction      σ_PO² = (MS_PO − MS_E) / r
    operators        σ_O² = (MS_O − MS_PO) / (p r)
    parts            σ_P² = (MS_P − MS_PO) / (o r)

A negative estimate becomes 0. An interaction that is not significant (p > 0.05) is pooled with the error: MS_E and
MS_PO are then both (SS_PO + SS_E) / (ν_PO + ν_E), and σ_PO² is 0. Reproducibility is σ_O² + σ_PO², gauge R&R σ_E² more.

Confidence intervals are generalised ones: each mean square is its expectation times χ²_ν/ν. So a draw θ* = ν MS / χ²_ν
of each, put into the formulas of the components, is a generalised pivotal quantity of any function of them (%GRR, ndc);
the 2.5 % and 97.5 % quantiles of many draws bound it. For the repeatability that is the exact χ² interval. The draws
are seeded: the same study, the same bounds.

References
----------
AIAG, Measurement systems analysis, 4th ed., 2010, chapter III-B and appendix A.
Burdick, Borror, Montgomery, A review of methods for measurement systems capability analysis, Journal of Quality
Technology 35 (2003) 342.
Hamada, Weerahandi, Measurement system assessment via generalized inference, Journal of Quality Technology 32 (2000)
241.
Burdick, Borror, Montgomery, Design and analysis of gauge R&R studies, SIAM 2005, chapter 3 and appendix B,
doi:10.1137/1.9780898718379.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from scipy.special import fdtrc

from core.errors import WrongValue
from core.findings.proof import notes_of
from core.findings.table import note_of
from core.messages import Message
from core.model.arrays import Array
from core.wings.studies.kinds.doubted import Doubted, doubts_of_study

Interval: TypeAlias = tuple[float, float]
Fitness: TypeAlias = Literal["acceptable", "acceptable with reservations", "not acceptable", "not proven"]
ACCEPTABLE, CONDITIONAL, NOT_ACCEPTABLE = get_args(Fitness)[:3]

DRAWS = 40_000
"""Of the pivotal quantities: a bound's share of the draws is then known to 0.0008."""
TAIL = 0.025
"""Share of the draws beyond each bound of a 95 % interval."""


@dataclass(frozen=True, eq=False, slots=True)
class GrrIntervals:
    """Variances by source, and their 95 % intervals; those of %GRR of total and of T (fractions); ndc and its own."""

    estimates: Mapping[str, float]
    variances: Mapping[str, Interval]
    of_total: Interval
    of_tolerance: Interval | None
    ndc: float
    categories: Interval


def intervals(
    squares: Mapping[str, tuple[float, int]], shape: tuple[int, ...], tolerance: float | None, seed: int = 0
) -> GrrIntervals:
    """Compute the variance components of a gauge R&R study and their 95 % intervals from the mean squares.

    Parameters
    ----------
    squares
        Mean square and degrees of freedom of "parts", "error", and, where they are in the model, "operators" and
        "interaction".
    shape
        (p, o, r): parts, operators, repeats.
    tolerance
        Its full width T; None if there is none.
    seed
        Of the draws.
    """
    rng = np.random.default_rng(seed)
    estimates = {
        source: float(value[0])
        for source, value in components({k: np.array([v[0]]) for k, v in squares.items()}, shape).items()
    }
    drawn = components({source: ms * dof / rng.chisquare(dof, DRAWS) for source, (ms, dof) in squares.items()}, shape)
    grr, part = estimates["gauge R&R"], estimates["parts"]
    with np.errstate(divide="ignore"):
        ratio = np.sqrt(drawn["gauge R&R"] / drawn["total"])
        categories = np.sqrt(2 * drawn["parts"] / drawn["gauge R&R"])
    return GrrIntervals(
        estimates,
        {source: _bounds(values) for source, values in drawn.items()},
        _bounds(ratio),
        None if tolerance is None else _bounds(6 * np.sqrt(drawn["gauge R&R"]) / tolerance),
        math.sqrt(2 * part / grr) if grr else math.inf,
        _bounds(categories),
    )


def components(squares: Mapping[str, Array], shape: tuple[int, ...]) -> dict[str, Array]:
    """Compute the variance (n,) of each source in a gauge R&R study, none below 0, from mean squares (n,)."""
    _, operators, repeats = shape
    error = squares["error"]
    both = squares.get("interaction", error)
    interaction = np.maximum(both - error, 0) / repeats
    operator = np.maximum(squares.get("operators", both) - both, 0) / (shape[0] * repeats)
    part = np.maximum(squares["parts"] - both, 0) / (operators * repeats)
    grr = error + operator + interaction
    return {
        "gauge R&R": grr,
        "repeatability": error,
        "reproducibility": operator + interaction,
        "operators": operator,
        "interaction": interaction,
        "parts": part,
        "total": grr + part,
    }


def _bounds(values: Array) -> Interval:
    low, high = np.quantile(values, [TAIL, 1 - TAIL])
    return float(low), float(high)


POOLED_ABOVE = 0.05
"""An interaction with a larger p is pooled with the error."""
GOOD, USABLE = 0.10, 0.30
"""%GRR up to which a gauge is acceptable, and up to which it may be, by what hangs on it (AIAG)."""
ENOUGH_CATEGORIES = 5
"""Distinct categories that a gauge must tell apart (AIAG, chapter II-D)."""


@dataclass(frozen=True, slots=True)
class AnovaRow:
    """Line of the table: sum of squares, degrees of freedom, mean square, F and its p (None for error and total)."""

    source: str
    ss: float
    dof: int
    ms: float
    f: float | None = None
    p: float | None = None


@dataclass(frozen=True, slots=True)
class Component:
    """Component of the variation.

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
        """Standard deviation of this component of the variation."""
        return math.sqrt(self.variance)


@dataclass(frozen=True, eq=False, slots=True)
class GrrStudy:
    """Crossed gauge R&R study.

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
    doubted
        Measurements whose results prove nothing, by their names: nor does the study.
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
    doubted: Doubted = ()

    def component(self, source: str) -> Component:
        """Find the component of the variation whose source is `source`, as "repeatability"."""
        return next(one for one in self.components if one.source == source)

    @property
    def pooled(self) -> bool:
        """Whether the interaction of parts and operators was pooled with the error."""
        return bool(self.pooled_anova)

    @property
    def categories(self) -> int | None:
        """Number of distinct categories ndc, a whole number ≥ 1; None if the gauge has no variation."""
        return None if math.isinf(self.ndc) else max(int(self.ndc), 1)

    @property
    def grr(self) -> float:
        """%GRR as a fraction, of the tolerance if one is stated, else of the total variation.

        The tolerance goes first, as the parts of a study seldom are the process.
        """
        of_all = self.component("gauge R&R")
        return of_all.of_total if of_all.of_tolerance is None else of_all.of_tolerance

    @property
    def verdict(self) -> Fitness:
        """Verdict by %GRR (AIAG, chapter II-D): acceptable up to 10 %, with reservations up to 30 %, else not.

        Not proven where results of measurements prove nothing.
        """
        if self.doubted:
            return "not proven"
        limits = ((GOOD, ACCEPTABLE), (USABLE, CONDITIONAL))
        return next((fitness for most, fitness in limits if self.grr <= most), NOT_ACCEPTABLE)

    @property
    def notes(self) -> tuple[Message, ...]:
        """Notes on the study: results with doubts, pooling, and too few measurements or categories."""
        p, o, r = self.values.shape
        said = [*notes_of(doubts_of_study(self.doubted))]
        if self.pooled:
            said.append(note_of("study.interaction_pooled", limit=POOLED_ABOVE))
        if o == 1:
            said.append(note_of("study.one_operator"))
        if p < 10 or o < 3 or r < 2 or p * o * r < 60:
            said.append(note_of("study.few_measurements", p=p, o=o, r=r))
        if self.categories is not None and self.categories < ENOUGH_CATEGORIES:
            said.append(note_of("study.few_categories", n=self.categories, least=ENOUGH_CATEGORIES))
        return tuple(said)


def grr_study(
    values: Array,
    *,
    parts: Sequence[str] = (),
    operators: Sequence[str] = (),
    tolerance: float | None = None,
    unit: str = "mm",
    doubted: Doubted = (),
) -> GrrStudy:
    """Analyse a gauge R&R study by analysis of variance; `values` (p, o, r): parts, operators, repeats.

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
    doubted
        See `GrrStudy`.

    Raises
    ------
    WrongValue
        If there are too few parts or repeats, a value is not finite, all values are the same, or the tolerance is not
        above 0.
    """
    y = np.array(values, dtype=np.float64)
    if y.ndim != 3 or y.shape[0] < 2 or y.shape[1] < 1 or y.shape[2] < 2 or not np.isfinite(y).all():
        raise WrongValue(
            Message(
                "study.grr_too_small",
                "a gauge R&R study needs two parts, one operator and two repeats of each, or more, all finite",
            )
        )
    if not np.ptp(y) > 0:
        raise WrongValue(Message("study.grr_all_the_same", "a gauge R&R study needs values that differ"))
    if tolerance is not None and not (tolerance > 0 and math.isfinite(tolerance)):
        raise WrongValue(
            Message(
                "study.tolerance_not_positive",
                "the tolerance must be a number above 0, not {tolerance}",
                tolerance=tolerance,
            )
        )
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
        doubted,
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
