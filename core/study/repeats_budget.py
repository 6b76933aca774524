"""The uncertainty of the mean of repeated scans: what scatters between scans shrinks with their number, the rest stays.

References
----------
JCGM 100:2008, 4.2.3 (mean of n observations), 5.2 (what is common does not average out).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from core.inspect.results import Contribution
from core.inspect.uncertainty import POINT_NOISE, SWEEP_PLANES
from core.study.budget import UncertaintyBudget, add_up

OF_EACH_SCAN = (POINT_NOISE, SWEEP_PLANES)
"""Causes drawn anew with each scan. Calibrations are not, nor are speckle and form while the part lies still."""
BEYOND = "scatter of the repeats beyond their stated noise"
REPEATABILITY = "repeatability of the scans"
STATED = "uncertainty stated by each scan, as if common to all"
GIVEN = "common to all scans, as given"


def from_budgets(
    values: Sequence[float], budgets: Sequence[Sequence[Contribution]], *, unit: str = "mm"
) -> UncertaintyBudget:
    """Of the mean of n scans with a budget each.

    What is common stays whole, at its quadratic mean over the scans; the scans' own noise is divided by √n; where the
    values scatter by more than that noise, the excess √(s² − noise²)/√n is a row of its own, with n − 1 degrees of
    freedom. So no noise is counted twice, and none is missed.
    """
    n = len(values)
    sources = dict.fromkeys(row.source for budget in budgets for row in budget)
    rows, noise2 = [], 0.0
    for source in sources:
        found = [row for budget in budgets for row in budget if row.source == source]
        u2 = sum(row.u_mm**2 for row in found) / n
        if source in OF_EACH_SCAN:
            noise2 += u2
            u2 /= n
        first = found[0]
        rows.append(
            Contribution(
                source, math.sqrt(u2), first.point_mm, first.distribution, min(row.dof for row in found), first.value,
                first.unit,
            )
        )  # fmt: skip
    scatter = _scatter(values)
    if scatter is not None:
        beyond = math.sqrt(max(scatter**2 - noise2, 0.0))
        rows.append(Contribution(BEYOND, beyond / math.sqrt(n), beyond, "t", float(n - 1), unit=unit))
    return add_up(rows, value=float(np.mean(values)), unit=unit)


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
