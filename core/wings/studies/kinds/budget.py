"""The uncertainty budget of a measured value: its independent rows, u_c, ν_eff, k and U.

What camera, fan, network and points contribute comes from the fits as rows (`Contribution`); temperature, master and
repeatability join as further rows.

In the budget of the mean of repeated scans (`from_budgets`, `from_stated`) what scatters between scans shrinks with
their number, the rest stays.

References
----------
JCGM 100:2008, Guide to the expression of uncertainty in measurement; 4.2.3 (mean of n observations), 5.2 (what is
common does not average out).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.errors import WrongValue
from core.inspect.causes import Cause, Source
from core.inspect.results import Contribution
from core.inspect.uncertainty.coverage import COVERAGE, coverage_factor, effective_dof
from core.messages import Message


@dataclass(frozen=True, eq=False, slots=True)
class UncertaintyBudget:
    """Uncertainty budget with its sum.

    Parameters
    ----------
    rows
        One an input.
    u
        Combined standard uncertainty u_c, in the result's unit.
    dof
        Effective degrees of freedom ν_eff, inf if u is known.
    coverage
        Probability of coverage of U.
    k
        Coverage factor t_p(ν_eff).
    value
        The result, if it is known here.
    unit
        Of u and the value.
    """

    rows: tuple[Contribution, ...]
    u: float
    dof: float
    coverage: float
    k: float
    value: float | None = None
    unit: str = "mm"

    @property
    def U(self) -> float:
        """Expanded uncertainty U = k·u, in the budget's unit."""
        return self.k * self.u

    def share(self, row: Contribution) -> float:
        """Compute the share (0 … 1) of u² that one row of the budget contributes."""
        return row.u_mm**2 / self.u**2 if self.u else 0.0


def add_up(
    rows: Sequence[Contribution], *, value: float | None = None, coverage: float = COVERAGE, unit: str = "mm"
) -> UncertaintyBudget:
    """Add up independent contributions: u_c² = Σ u_i², ν_eff by Welch–Satterthwaite, k = t_p(ν_eff).

    References
    ----------
    JCGM 100:2008, 5.1.2, equation (10); G.4.1, equation (G.2b); G.6.4.
    """
    dof = effective_dof(rows)
    return UncertaintyBudget(
        tuple(rows),
        math.hypot(*(row.u_mm for row in rows)),
        dof,
        coverage,
        coverage_factor(dof, coverage),
        value,
        unit=unit,
    )


OF_EACH_SCAN = frozenset((Cause.POINT_NOISE, Cause.SWEEP_PLANES))
"""Causes drawn anew with each scan. Calibrations are not, nor are speckle and form while the part lies still."""


def from_budgets(
    values: Sequence[float], budgets: Sequence[Sequence[Contribution]], *, unit: str = "mm"
) -> UncertaintyBudget:
    """Make the uncertainty budget of the mean of n scans from the uncertainty budget of each scan.

    What is common stays whole, at its quadratic mean over the scans. What is drawn anew with each scan shrinks with √n:
    as stated, or, where the values scatter by more than that, as observed, with n − 1 degrees of freedom. So no noise
    is counted twice, and none is missed.
    """
    n, scatter = len(values), _scatter(values)
    rows = [_quadratic_mean(source, budgets) for source in dict.fromkeys(row.source for one in budgets for row in one)]
    common = [row for row in rows if row.source not in OF_EACH_SCAN]
    own = [row for row in rows if row.source in OF_EACH_SCAN]
    if scatter is not None and scatter > math.hypot(*(row.u_mm for row in own)):
        own = [Contribution(Cause.OBSERVED, scatter, scatter, "t", float(n - 1), unit=unit)]
    means = [replace(row, u_mm=row.u_mm / math.sqrt(n)) for row in own]
    return add_up([*common, *means], value=float(np.mean(values)), unit=unit)


def _quadratic_mean(source: Source, budgets: Sequence[Sequence[Contribution]]) -> Contribution:
    """One cause over all scans; a scan that does not name it has none of it."""
    found = [row for budget in budgets for row in budget if row.source == source]
    u = math.sqrt(sum(row.u_mm**2 for row in found) / len(budgets))
    return replace(found[0], u_mm=u, dof=min(row.dof for row in found))


def from_stated(values: Sequence[float], u: Sequence[float] | float | None, *, unit: str = "mm") -> UncertaintyBudget:
    """Make the uncertainty budget of the mean of n scans from their stated u alone, or, with None, their scatter.

    Parameters
    ----------
    values
        (n,).
    u
        (n,) standard uncertainties that the scans state: their quadratic mean is taken whole, as if common to all; or
        one for what is common to all; or None: nothing is known but the scatter.
    unit
        Of both.

    Raises
    ------
    WrongValue
        If there is one value alone and nothing is known of its uncertainty.
    """
    n, scatter = len(values), _scatter(values)
    rows = []
    if isinstance(u, int | float):
        rows.append(Contribution(Cause.GIVEN, float(u), float(u), unit=unit))
    elif u is not None:
        common = float(np.sqrt(np.mean(np.square(u))))
        rows.append(Contribution(Cause.STATED, common, common, unit=unit))
    if scatter is not None:
        rows.append(Contribution(Cause.REPEATABILITY, scatter / math.sqrt(n), scatter, "t", float(n - 1), unit=unit))
    if not rows:
        raise WrongValue(Message("study.one_value_alone", "one value alone, with no stated uncertainty, has no budget"))
    return add_up(rows, value=float(np.mean(values)), unit=unit)


def _scatter(values: Sequence[float]) -> float | None:
    """Standard deviation over n − 1; None for one value alone."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else None
