"""Repeats of one quantity: what their mean proves, by its own uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from core.checks.repeats import Histogram, RepeatStatistics, RunChart, histogram, repeat_statistics, run_chart
from core.findings.proof import Doubt, Doubts, notes_of
from core.findings.table import note_of
from core.inspect.conformity import Limits, Verdict, Zones, decide
from core.messages import Message
from core.model.arrays import Array
from core.wings.studies.kinds.doubted import Doubted, doubts_of_study

if TYPE_CHECKING:  # a window shows statistics long before it shows a budget
    from core.wings.studies.kinds.budget import UncertaintyBudget

THICKNESS = "thickness"
"""What values are of unless another name is given: the program's own word for it."""


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
        """Verdict on the mean of the repeats by ISO 14253-1; `Verdict.NONE` without limits.

        Nothing is proven while its uncertainty is not complete, or a repeat is doubted.
        """
        if self.zones is None or self.nominal is None:
            return Verdict.NONE
        limits = Limits(self.nominal, self.zones.lower, self.zones.upper)
        return decide(self.statistics.mean_mm, limits, self.zones.U, self.doubts, r=self.zones.r)

    @property
    def doubts(self) -> Doubts:
        """Reasons why the mean proves nothing: repeats with doubts, or an incomplete uncertainty; () for none."""
        of_u = () if self.complete else (Doubt.of(note_of("study.scatter_alone")),)
        return (*doubts_of_study(self.doubted), *of_u)

    @property
    def notes(self) -> tuple[Message, ...]:
        """Notes on what limits the study of repeats: its doubts, and repeats outside the limits of the run chart."""
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
    """Analyse n ≥ 1 repeated measurements of one quantity, with the uncertainty budget of their mean.

    Parameters
    ----------
    values, labels, U, name, doubted
        See `RepeatStudy`; without labels "1", "2", …
    budget, complete
        Of the mean: `core.wings.studies.kinds.budget`.
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
