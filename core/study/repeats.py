"""Several measurements of one quantity: how they scatter, how far they are from the nominal value, and what they prove.

The scan is the independent unit, not the point: n repeats are n scans.

References
----------
Sun et al., Sensors 2023, 23, 13, §5.3.2, Tables 1 and 2, doi:10.3390/s23010013.
ISO 7870-2:2013 (control chart of individual values).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.errors import WrongValue
from core.findings.proof import Doubt, Doubts, notes_of
from core.findings.table import note_of
from core.inspect.conformity import Limits, Verdict, Zones, decide
from core.messages import Message
from core.model.arrays import Array
from core.study.doubted import Doubted, doubts_of_study

if TYPE_CHECKING:  # a window shows statistics long before it shows a budget
    from core.study.budget import UncertaintyBudget

MOST_BINS = 20
"""Of a histogram: more cannot be told apart in the drawing."""
TO_LIMITS = 2.66
"""3/d₂ with d₂ = 1.128 of two values: from the mean moving range to three standard deviations (ISO 7870-2)."""


THICKNESS = "thickness"
"""What values are of unless another name is given: the program's own word for it."""


@dataclass(frozen=True, slots=True)
class RepeatStatistics:
    """Statistics of `n` measurements of one thickness, in mm.

    `error_mm` is mean − nominal, `rmse_mm` the root mean square of the single errors (over n), `largest_error_mm` the
    largest magnitude of one; all None without a nominal value. `std_mm` is the standard deviation of a single
    measurement about the mean (over n − 1), NaN for one measurement alone.
    """

    n: int
    mean_mm: float
    error_mm: float | None
    rmse_mm: float | None
    std_mm: float
    largest_error_mm: float | None


def repeat_statistics(thicknesses: Sequence[float], nominal_mm: float | None = None) -> RepeatStatistics:
    """Compute mean, error, RMSE, standard deviation and largest error of repeated `thicknesses` in mm.

    Raises
    ------
    WrongValue
        If there is no thickness, or one is not a finite number.
    """
    values = np.asarray(thicknesses, dtype=np.float64)
    if values.ndim != 1 or not len(values) or not np.isfinite(values).all():
        raise WrongValue(Message("study.no_repeats", "repeats need one finite thickness or more"))
    mean = float(values.mean())
    std = float(values.std(ddof=1)) if len(values) > 1 else float("nan")
    if nominal_mm is None:
        return RepeatStatistics(len(values), mean, None, None, std, None)
    errors = values - nominal_mm
    rmse, largest = float(np.sqrt(np.mean(errors**2))), float(np.abs(errors).max())
    return RepeatStatistics(len(values), mean, mean - nominal_mm, rmse, std, largest)


@dataclass(frozen=True, eq=False, slots=True)
class RunChart:
    """Data for a chart of the values in their order.

    Parameters
    ----------
    centre
        Their mean.
    lower, upper
        centre ∓ 2.66 mean moving range: limits that a steady measurement seldom leaves.
    outside
        Indices of the values beyond them.
    """

    centre: float
    lower: float
    upper: float
    outside: tuple[int, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Histogram:
    """Counts of values (`counts`, B) between the `edges` (B + 1)."""

    edges: Array
    counts: NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class RepeatStudy:
    """Study of repeats of one quantity.

    Parameters
    ----------
    name
        Of the quantity.
    labels
        (n,) of the scans, in the order of measuring.
    values
        (n,) in `unit`.
    U
        (n,) expanded uncertainties that the scans state themselves, NaN where one does not.
    statistics
        Of the values, in `unit` whatever the names of its fields say.
    run
        The run chart; None for one value alone.
    histogram
        Of the values.
    budget
        Of the mean of the repeats.
    complete
        Whether the budget holds what is common to all repeats as well, and not their scatter alone.
    nominal
        None if there is none.
    zones
        Of the deviation of the mean from the nominal value; None without a nominal value and a tolerance.
    unit
        "mm" or "deg".
    doubted
        Repeats that prove nothing, whatever their uncertainty: nor does their mean.
    """

    name: str
    labels: tuple[str, ...]
    values: Array
    U: Array
    statistics: RepeatStatistics
    run: RunChart | None
    histogram: Histogram
    budget: UncertaintyBudget
    complete: bool
    nominal: float | None = None
    zones: Zones | None = None
    unit: str = "mm"
    doubted: Doubted = ()

    @property
    def verdict(self) -> Verdict:
        """Verdict on the mean by ISO 14253-1; none without limits.

        Nothing is proven while its uncertainty is not complete, or a repeat is doubted.
        """
        if self.zones is None or self.nominal is None:
            return Verdict.NONE
        limits = Limits(self.nominal, self.zones.lower, self.zones.upper)
        return decide(self.statistics.mean_mm, limits, self.zones.U, self.doubts, r=self.zones.r)

    @property
    def doubts(self) -> Doubts:
        """Doubts that the mean proves anything."""
        of_u = () if self.complete else (Doubt.of(note_of("study.scatter_alone")),)
        return (*doubts_of_study(self.doubted), *of_u)

    @property
    def notes(self) -> tuple[Message, ...]:
        """Notes on the figures."""
        said = notes_of(self.doubts)
        if self.run is not None and self.run.outside:
            names = [self.labels[place] for place in self.run.outside]
            said += (note_of("study.beyond_run_chart", names=names),)
        return said


@dataclass(frozen=True, slots=True)
class Requirement:
    """Requirement on the mean of repeats: its nominal value and the deviations permitted from it.

    Parameters
    ----------
    nominal
        None: there is no nominal value.
    limits
        Deviations permitted from it, the lower first; ±inf where a side has none; None: no decision is made.
    r
        Guard band over U, see `core.inspect.conformity.Zones`.
    """

    nominal: float | None = None
    limits: tuple[float, float] | None = None
    r: float = 1.0


def repeat_study(
    values: Sequence[float],
    budget: UncertaintyBudget,
    *,
    complete: bool,
    name: str = THICKNESS,
    labels: Sequence[str] = (),
    U: Sequence[float] = (),
    asked: Requirement = Requirement(),
    doubted: Doubted = (),
) -> RepeatStudy:
    """Analyse n ≥ 1 repeats, in the unit of the budget of their mean.

    Parameters
    ----------
    values, labels, U, name, doubted
        See `RepeatStudy`; without labels "1", "2", …
    budget, complete
        Of the mean: `core.study.budget`.
    asked
        Nominal value and limits.

    Raises
    ------
    WrongValue
        If there is no value, one is not finite, or the limits are not in order.
    """
    nominal, limits = asked.nominal, asked.limits
    statistics = repeat_statistics(values, nominal)
    measured = np.array(values, dtype=np.float64)
    stated = np.array(U, dtype=np.float64) if len(U) else np.full(len(measured), np.nan)
    measured.setflags(write=False)
    stated.setflags(write=False)
    names = tuple(labels) or tuple(str(number) for number in range(1, len(measured) + 1))
    zones = None if limits is None or nominal is None else Zones(*limits, budget.U, asked.r)
    return RepeatStudy(
        name, names, measured, stated, statistics, run_chart(measured), histogram(measured), budget, complete, nominal,
        zones, budget.unit, doubted,
    )  # fmt: skip


def run_chart(values: Array) -> RunChart | None:
    """Compute centre line and limits of `values` (n,) in their order; None if n < 2."""
    if len(values) < 2:
        return None
    centre = float(values.mean())
    reach = TO_LIMITS * float(np.abs(np.diff(values)).mean())
    outside = np.flatnonzero(np.abs(values - centre) > reach * (1 + 1e-9))
    return RunChart(centre, centre - reach, centre + reach, tuple(int(place) for place in outside))


def histogram(values: Array) -> Histogram:
    """Count `values` (n,) in at most MOST_BINS bins of one width (Freedman, Diaconis 1981, or Sturges 1926)."""
    if not np.ptp(values):
        counts, edges = np.histogram(values, 1)
    else:
        bins = min(len(np.histogram_bin_edges(values, "auto")) - 1, MOST_BINS)
        counts, edges = np.histogram(values, bins)
    return Histogram(np.asarray(edges, dtype=np.float64), np.asarray(counts, dtype=np.int64))
