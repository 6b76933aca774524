"""The uncertainty of the mean of repeated scans: what scatters between scans shrinks with their number, the rest stays.

References
----------
JCGM 100:2008, 4.2.3 (mean of n observations), 5.2 (what is common does not average out).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.inspect.results import Contribution
from core.inspect.uncertainty import POINT_NOISE, SWEEP_PLANES
from core.study.budget import UncertaintyBudget, add_up

OF_EACH_SCAN = (POINT_NOISE, SWEEP_PLANES)
"""Causes drawn anew with each scan. Calibrations are not, nor are speckle and form while the part lies still."""
OBSERVED = "repeatability of the scans, above their stated noise"
REPEATABILITY = "repeatability of the scans"
STATED = "uncertainty stated by each scan, as if common to all"
GIVEN = "common to all scans, as given"


def from_budgets(
    values: Sequence[float], budgets: Sequence[Sequence[Contribution]], *, unit: str = "mm"
) -> UncertaintyBudget:
    """Of the mean of n scans with a budget each.

    What is common stays whole, at its quadratic mean over the scans. What is drawn anew with each scan shrinks with √n:
    as stated, or, where the values scatter by more than that, as observed, with n − 1 degrees of freedom. So no noise
    is counted twice, and none is missed.
    """
    n, scatter = len(values), _scatter(values)
    rows = [_quadratic_mean(source, budgets) for source in dict.fromkeys(row.source for one in budgets for row in one)]
    common = [row for row in rows if row.source not in OF_EACH_SCAN]
    own = [row for row in rows if row.source in OF_EACH_SCAN]
    if scatter is not None and scatter > math.hypot(*(row.u_mm for row in own)):
        own = [Contribution(OBSERVED, scatter, scatter, "t", float(n - 1), unit=unit)]
    means = [replace(row, u_mm=row.u_mm / math.sqrt(n)) for row in own]
    return add_up([*common, *means], value=float(np.mean(values)), unit=unit)


def _quadratic_mean(source: str, budgets: Sequence[Sequence[Contribution]]) -> Contribution:
    """One cause over all scans; a scan that does not name it has none of it."""
    found = [row for budget in budgets for row in budget if row.source == source]
    u = math.sqrt(sum(row.u_mm**2 for row in found) / len(budgets))
    return replace(found[0], u_mm=u, dof=min(row.dof for row in found))


def from_stated(values: Sequence[float], u: Sequence[float] | float | None, *, unit: str = "mm") -> UncertaintyBudget:
    """Of the mean of n scans whose budgets are not known.

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
    ValueError
        If there is one value alone and nothing is known of its uncertainty.
    """
    n, scatter = len(values), _scatter(values)
    rows = []
    if isinstance(u, int | float):
        rows.append(Contribution(GIVEN, float(u), float(u), unit=unit))
    elif u is not None:
        common = float(np.sqrt(np.mean(np.square(u))))
        rows.append(Contribution(STATED, common, common, unit=unit))
    if scatter is not None:
        rows.append(Contribution(REPEATABILITY, scatter / math.sqrt(n), scatter, "t", float(n - 1), unit=unit))
    if not rows:
        raise ValueError("one value alone, with no stated uncertainty, has no budget")
    return add_up(rows, value=float(np.mean(values)), unit=unit)


def _scatter(values: Sequence[float]) -> float | None:
    """Standard deviation over n − 1; None for one value alone."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else None
