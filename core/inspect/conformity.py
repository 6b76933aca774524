"""The decision rule: what a measured deviation proves about a tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from core.findings.proof import Doubts


class Verdict(StrEnum):
    """Verdict of a measurement about a tolerance; its values are stored in files."""

    CONFORMING = "conforming"
    NOT_CONFORMING = "not conforming"
    NOT_PROVEN = "not proven"
    NONE = ""
    """Nothing was asked."""

    @classmethod
    def worst(cls, verdicts: Iterable[Verdict]) -> Verdict:
        """Choose the worst of the verdicts on one part: NOT_CONFORMING before NOT_PROVEN; NONE if there is none."""
        found = set(verdicts)
        return next((one for one in WORST_FIRST if one in found), cls.NONE)


WORST_FIRST = (Verdict.NOT_CONFORMING, Verdict.NOT_PROVEN, Verdict.CONFORMING)


@dataclass(frozen=True, slots=True)
class Limits:
    """Requirement on a characteristic: its nominal value and the deviations permitted from it, `lower` ≤ `upper`.

    Values in mm or rad; −inf or inf where a side has no limit. A deviation of form has the nominal value 0, no lower
    limit and its tolerance as the upper one: it cannot be too small.

    Raises
    ------
    ValueError
        If the limits are not in order.
    """

    nominal: float
    lower: float
    upper: float

    def __post_init__(self) -> None:
        if not self.lower <= self.upper:
            raise ValueError(f"the lower limit {self.lower} is not below the upper limit {self.upper}")

    @classmethod
    def around(cls, nominal: float | None, tolerance: float | None) -> Limits | None:
        """Make the limits nominal ± tolerance; None unless both are given."""
        return None if nominal is None or tolerance is None else cls(nominal, -tolerance, tolerance)


def decide(value: float, limits: Limits | None, U: float, doubts: Doubts, *, r: float = 1.0) -> Verdict:
    """Decide by ISO 14253-1, as the maker of a part does, what `value` ± `U` proves about `limits`; NONE if None.

    The expanded uncertainty U narrows the tolerance for the proof of conformity and widens it for the proof of
    nonconformity; between the two nothing is proven. Nor is anything by a value or an uncertainty that is not known.

    Parameters
    ----------
    value
        As measured, in any one unit.
    limits
        What is asked of it; None: no verdict.
    U
        Expanded uncertainty of the value.
    doubts
        By what facts nothing is proven, whatever U; () where nothing speaks against the value. Whoever asks for a
        verdict has to say it.
    r
        Guard band over U, see :class:`Zones`.

    Raises
    ------
    ValueError
        If U or r is negative.

    References
    ----------
    ISO 14253-1, Decision rules for verifying conformity or nonconformity with specifications, with U as guard band.

    Examples
    --------
    >>> from core.findings.proof import Doubt
    >>> limits = Limits(50.0, -0.2, 0.2)
    >>> [str(decide(value, limits, 0.1, ())) for value in (50.05, 50.15, 49.65)]
    ['conforming', 'not proven', 'not conforming']
    >>> str(decide(50.05, limits, 0.1, (Doubt.named("moved"),))), str(decide(50.05, None, 0.1, ()))
    ('not proven', '')
    """
    if limits is None:
        return Verdict.NONE
    deviation = value - limits.nominal
    if doubts or math.isnan(deviation) or math.isnan(U):
        return Verdict.NOT_PROVEN
    zones = Zones(limits.lower, limits.upper, U, r)
    if zones.conformance is not None and zones.conformance[0] <= deviation <= zones.conformance[1]:
        return Verdict.CONFORMING
    low, high = zones.nonconformance
    return Verdict.NOT_CONFORMING if deviation < low or deviation > high else Verdict.NOT_PROVEN


@dataclass(frozen=True, slots=True)
class Zones:
    """Zones of a decision: where a measured deviation proves conformity, nonconformity, or nothing.

    Parameters
    ----------
    lower, upper
        The limits of the tolerance; −inf or inf where a side has none.
    U
        Expanded uncertainty of the measured value.
    r
        The guard band is g = r·U to both sides of a limit. 1: as strict as U itself; 0.83: at most 5 % risk at a limit
        with k = 2 (1.65 u), the rule of ISO 14253-1:2017 where nothing is agreed; 0: shared risk, every value decides.

    Raises
    ------
    ValueError
        If the limits are not in order, or U or r is negative or not a number.

    References
    ----------
    ISO 14253-1:2017, 5. JCGM 106:2012, 8.3 (guard bands). ILAC-G8:09/2019, table 1 (r of the usual rules).

    Examples
    --------
    >>> zones = Zones(-0.2, 0.2, 0.1)
    >>> zones.conformance, zones.uncertainty
    ((-0.1, 0.1), ((-0.30000000000000004, -0.1), (0.1, 0.30000000000000004)))
    """

    lower: float
    upper: float
    U: float
    r: float = 1.0

    def __post_init__(self) -> None:
        if not self.lower <= self.upper or not self.U >= 0 or not self.r >= 0:
            raise ValueError(f"no decision from limits {self.lower} to {self.upper}, U {self.U} and r {self.r}")

    @property
    def guard_band(self) -> float:
        """Width g = r·U of the guard band to both sides of each limit."""
        return self.r * self.U

    @property
    def conformance(self) -> tuple[float, float] | None:
        """Smallest and largest deviation that prove conformity; None if the guard bands leave none."""
        low, high = self.lower + self.guard_band, self.upper - self.guard_band
        return (low, high) if low <= high else None

    @property
    def nonconformance(self) -> tuple[float, float]:
        """Two deviations: any below the first or above the second proves nonconformity."""
        return self.lower - self.guard_band, self.upper + self.guard_band

    @property
    def uncertainty(self) -> tuple[tuple[float, float], ...]:
        """Zones (lower, upper) of deviations that prove nothing: one about each finite limit, or one in all."""
        low, high = self.nonconformance
        if self.conformance is None:
            return ((low, high),)
        below, above = self.conformance
        return tuple(zone for zone in ((low, below), (above, high)) if math.isfinite(zone[0]))
