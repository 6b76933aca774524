"""From contributions to the expanded uncertainty: effective degrees of freedom and the coverage factor.

References
----------
JCGM 100:2008, Guide to the expression of uncertainty in measurement, annex G.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from scipy.special import ndtri, stdtrit

from core.inspect.results import Contribution

COVERAGE = math.erf(math.sqrt(2))
"""Probability of coverage of U, 95.45 %: k = 2 for infinitely many degrees of freedom."""

ROUNDING = 1e-9
"""Relative error of an effective number of degrees of freedom that is none: 7.999999999 are 8."""


def effective_dof(contributions: Iterable[Contribution]) -> float:
    """Compute the effective degrees of freedom ν_eff = u_c⁴ / Σ (u_i⁴/ν_i) of independent contributions.

    Infinite if every u is known, or one is not known at all.

    References
    ----------
    JCGM 100:2008, G.4.1, equation (G.2b): the Welch–Satterthwaite formula.
    """
    rows = tuple(contributions)
    u = np.array([row.u_mm for row in rows], dtype=np.float64)
    u = np.ldexp(u, -np.frexp(np.max(u, initial=0.0))[1])  # their size does not matter; powers of two change no digit
    doubt = float(np.sum(u**4 / [row.dof for row in rows]))
    return float(np.sum(u**2)) ** 2 / doubt if doubt > 0 else math.inf


def coverage_factor(dof: float, coverage: float = COVERAGE) -> float:
    """Compute the coverage factor k = t_p(ν), ν cut off to a whole number, that gives U the coverage probability p.

    Raises
    ------
    ValueError
        If the degrees of freedom are fewer than one, or the coverage is not between 0 and 1.

    References
    ----------
    JCGM 100:2008, G.4.1 (ν_eff cut off to the next lower integer) and table G.2.

    Examples
    --------
    >>> round(coverage_factor(16.7, 0.99), 2), round(coverage_factor(math.inf), 6)
    (2.92, 2.0)
    """
    dof *= 1 + ROUNDING
    if not dof >= 1 or not 0 < coverage < 1:
        raise ValueError(f"no coverage factor from {dof} degrees of freedom and a coverage of {coverage}")
    tail = (1 + coverage) / 2
    return float(ndtri(tail) if math.isinf(dof) else stdtrit(math.floor(dof), tail))


def student_factor(k: float, contributions: Iterable[Contribution]) -> float:
    """Compute the coverage factor, to two decimals, that gives u with few degrees of freedom the coverage of `k`.

    Examples
    --------
    >>> from core.inspect.causes import Cause
    >>> known, rough = Contribution(Cause.CAMERA, 0.1), Contribution(Cause.CAMERA, 0.1, dof=10)
    >>> student_factor(2.0, [known]), student_factor(2.0, [rough])
    (2.0, 2.28)
    """
    dof = effective_dof(contributions)
    return k if math.isinf(dof) else round(coverage_factor(dof, math.erf(k / math.sqrt(2))), 2)
