"""The uncertainty budget of a measured value: its rows, u_c, ν_eff, k and U; correlated inputs kept correlated.

What camera, fan, network and points contribute comes from the fits as rows (`Contribution`); temperature, master and
repeatability join as further rows. A model of one's own gives `Input`s: estimates with signed sensitivities, which may
be correlated.

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
from scipy.sparse.csgraph import connected_components

from core.errors import WrongValue
from core.inspect.results import Contribution
from core.inspect.uncertainty.causes import (
    GIVEN,
    OBSERVED,
    POINT_NOISE,
    REPEATABILITY,
    STATED,
    SWEEP_PLANES,
)
from core.inspect.uncertainty.coverage import COVERAGE, coverage_factor, effective_dof
from core.messages import Message, plain
from core.model.arrays import Array

HALF_WIDTHS = {"rectangular": math.sqrt(3), "triangular": math.sqrt(6), "arcsine": math.sqrt(2)}
"""Half-width of a distribution over its standard deviation (JCGM 100:2008, 4.3.7, 4.3.9; arcsine: H.1.3.4)."""


@dataclass(frozen=True, eq=False, slots=True)
class Input:
    """An input quantity of a measurement model.

    Parameters
    ----------
    name
        What it is.
    value, u
        Estimate and its standard uncertainty, in `unit`.
    sensitivity
        ∂f/∂x with its sign, in the result's unit per `unit`.
    distribution
        As in `Contribution`.
    dof
        Degrees of freedom of u; inf if it is known.
    unit
        Of value and u.
    """

    name: str
    value: float
    u: float
    sensitivity: float = 1.0
    distribution: str = "normal"
    dof: float = math.inf
    unit: str = "mm"

    @property
    def contribution(self) -> float:
        """Signed c·u in the result's unit."""
        return self.sensitivity * self.u

    def row(self) -> Contribution:
        """As a row of a budget."""
        u = abs(self.contribution)
        return Contribution(plain(self.name), u, self.u, self.distribution, self.dof, self.value, self.unit)


def of_observations(name: str, values: Sequence[float], sensitivity: float = 1.0, unit: str = "mm") -> Input:
    """The mean of n ≥ 2 independent observations, u = s/√n with n − 1 degrees of freedom (JCGM 100:2008, 4.2.3)."""
    observed = np.asarray(values, dtype=np.float64)
    if observed.ndim != 1 or len(observed) < 2 or not np.isfinite(observed).all():
        raise ValueError("a type A evaluation needs two finite observations or more")
    u = float(observed.std(ddof=1)) / math.sqrt(len(observed))
    return Input(name, float(observed.mean()), u, sensitivity, "t", float(len(observed) - 1), unit)


def within(
    name: str, value: float, half_width: float, distribution: str = "rectangular", *, sensitivity: float = 1.0,
    dof: float = math.inf, unit: str = "mm",
) -> Input:  # fmt: skip
    """An input known to lie within value ± half_width, by one of HALF_WIDTHS (JCGM 100:2008, 4.3.7 and 4.3.9)."""
    return Input(name, value, half_width / HALF_WIDTHS[distribution], sensitivity, distribution, dof, unit)


def dof_of_doubt(relative: float) -> float:
    """Degrees of freedom of a u that is itself uncertain by the fraction `relative`: ν = ½ (Δu/u)⁻².

    References
    ----------
    JCGM 100:2008, G.4.2, equation (G.3).

    Examples
    --------
    >>> dof_of_doubt(0.25), dof_of_doubt(0.5)
    (8.0, 2.0)
    """
    return 0.5 / relative**2 if relative else math.inf


@dataclass(frozen=True, eq=False, slots=True)
class UncertaintyBudget:
    """A budget that adds up.

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
    correlation
        (n, n) of the rows; None: independent.
    unit
        Of u and the value.
    """

    rows: tuple[Contribution, ...]
    u: float
    dof: float
    coverage: float
    k: float
    value: float | None = None
    correlation: Array | None = None
    unit: str = "mm"

    @property
    def U(self) -> float:
        """Expanded uncertainty k·u."""
        return self.k * self.u

    def share(self, row: Contribution) -> float:
        """Part of u² a row makes up by itself, 0 … 1 (and above, where a correlation takes some of it away again)."""
        return row.u_mm**2 / self.u**2 if self.u else 0.0


def add_up(
    rows: Sequence[Contribution], *, value: float | None = None, coverage: float = COVERAGE, unit: str = "mm"
) -> UncertaintyBudget:
    """The budget of independent contributions: u_c² = Σ u_i², ν_eff by Welch–Satterthwaite, k = t_p(ν_eff).

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


def combine(
    inputs: Sequence[Input],
    *,
    correlation: Array | None = None,
    value: float | None = None,
    coverage: float = COVERAGE,
    unit: str = "mm",
) -> UncertaintyBudget:
    """The budget of a linearised model with inputs that may be correlated: u_c² = Σ_ij c_i u_i r_ij c_j u_j.

    Welch–Satterthwaite holds for independent contributions only. So inputs that hang together are combined first and
    have the freedom of the least known among them: exact where they come from the same n observations each (ν = n − 1,
    as in H.2), careful elsewhere.

    Parameters
    ----------
    inputs
        n of them.
    correlation
        (n, n) symmetric with ones on its diagonal; None: independent.
    value
        The result.
    coverage
        Probability of coverage of U.
    unit
        Of the result.

    Raises
    ------
    ValueError
        If the correlation is no correlation matrix of the inputs.

    References
    ----------
    JCGM 100:2008, 5.2.2, equation (16); G.4.1; H.2.
    """
    rows = tuple(one.row() for one in inputs)
    if correlation is None:
        return add_up(rows, value=value, coverage=coverage, unit=unit)
    r = _checked(np.asarray(correlation, dtype=np.float64), len(inputs))
    signed = np.array([one.contribution for one in inputs])
    covariance = signed[:, None] * r * signed
    count, group = connected_components(r != 0, directed=False)
    joined = []
    for number in range(count):
        mine = group == number
        together = math.sqrt(max(float(covariance[np.ix_(mine, mine)].sum()), 0.0))
        dof = min(one.dof for one, is_in in zip(inputs, mine, strict=True) if is_in)
        joined.append(Contribution(plain(""), together, dof=dof))
    whole = add_up(joined, value=value, coverage=coverage, unit=unit)
    return replace(whole, rows=rows, correlation=r)


def covariance_of(inputs: Sequence[Input], sensitivities: Array, correlation: Array) -> Array:
    """Covariance (m, m) of m results of the same inputs, J V Jᵀ with J (m, n) = `sensitivities`.

    References
    ----------
    JCGM 100:2008, H.2.3.
    """
    u = np.array([one.u for one in inputs])
    jacobian = np.asarray(sensitivities, dtype=np.float64)
    v = u[:, None] * _checked(np.asarray(correlation, dtype=np.float64), len(inputs)) * u
    return np.asarray(jacobian @ v @ jacobian.T)


def _checked(r: Array, n: int) -> Array:
    if (
        r.shape != (n, n)
        or not np.allclose(r, r.T)
        or not np.allclose(np.diag(r), 1)
        or np.linalg.eigvalsh(r)[0] < -1e-6
    ):
        raise ValueError(
            f"no correlation matrix of {n} inputs: it must be symmetric, with ones on its diagonal, and positive"
        )
    return r


OF_EACH_SCAN = (POINT_NOISE, SWEEP_PLANES)
"""Causes drawn anew with each scan. Calibrations are not, nor are speckle and form while the part lies still."""


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


def _quadratic_mean(source: Message, budgets: Sequence[Sequence[Contribution]]) -> Contribution:
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
    WrongValue
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
        raise WrongValue(Message("study.one_value_alone", "one value alone, with no stated uncertainty, has no budget"))
    return add_up(rows, value=float(np.mean(values)), unit=unit)


def _scatter(values: Sequence[float]) -> float | None:
    """Standard deviation over n − 1; None for one value alone."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else None
