"""The decision rule: what a measured deviation proves about a tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """What a measurement proves about a tolerance; its values stand in files."""

    CONFORMING = "conforming"
    NOT_CONFORMING = "not conforming"
    NOT_PROVEN = "not proven"
    NONE = ""
    """Nothing was asked."""

    @classmethod
    def worst(cls, verdicts: Iterable[Verdict]) -> Verdict:
        """Of several on one part: what does not conform, then what is not proven; NONE where nothing is asked."""
        found = set(verdicts)
        return next((one for one in WORST_FIRST if one in found), cls.NONE)


WORST_FIRST = (Verdict.NOT_CONFORMING, Verdict.NOT_PROVEN, Verdict.CONFORMING)


def decide(deviation_mm: float, tolerance_mm: float, U_mm: float) -> Verdict:
    """Conformity with the tolerance ± `tolerance_mm` by ISO 14253-1, for the maker of a part.

    The expanded uncertainty U narrows the tolerance for the proof of conformity and widens it for the proof of
    nonconformity; between the two nothing is proven.

    Parameters
    ----------
    deviation_mm
        Measured − nominal.
    tolerance_mm
        Largest permitted deviation, to either side.
    U_mm
        Expanded uncertainty of the deviation.

    Raises
    ------
    ValueError
        If the tolerance is not positive, U is negative, or a value is not a number.

    References
    ----------
    ISO 14253-1, Decision rules for verifying conformity or nonconformity with specifications, with U as guard band.

    Examples
    --------
    >>> [str(decide(deviation, 0.20, 0.10)) for deviation in (0.05, 0.15, -0.35)]
    ['conforming', 'not proven', 'not conforming']
    """
    if not tolerance_mm > 0:
        raise ValueError(f"no decision from a tolerance of {tolerance_mm}")
    return decide_between(deviation_mm, -tolerance_mm, tolerance_mm, U_mm)


def decide_between(deviation: float, lower: float, upper: float, U: float, *, r: float = 1.0) -> Verdict:
    """Conformity with deviations permitted from `lower` to `upper` (±inf: no limit), by the same rule, in any one unit.

    Raises
    ------
    ValueError
        As :class:`Zones`, or if the deviation is not a number.

    Examples
    --------
    >>> str(decide_between(0.03, -0.01, 0.05, 0.01)), str(decide_between(0.045, float("-inf"), 0.05, 0.01))
    ('conforming', 'not proven')
    """
    if math.isnan(deviation):
        raise ValueError(f"no decision from deviation {deviation}, limits {lower} to {upper} and U {U}")
    return Zones(lower, upper, U, r).verdict(deviation)


@dataclass(frozen=True, slots=True)
class Zones:
    """The zones of a decision: where a measured value proves conformity, nonconformity, or nothing.

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
        """g, to both sides of each limit."""
        return self.r * self.U

    @property
    def conformance(self) -> tuple[float, float] | None:
        """Values that prove conformity, both ends included; None if the guard bands leave none."""
        low, high = self.lower + self.guard_band, self.upper - self.guard_band
        return (low, high) if low <= high else None

    @property
    def nonconformance(self) -> tuple[float, float]:
        """Values below the first or above the second prove nonconformity."""
        return self.lower - self.guard_band, self.upper + self.guard_band

    @property
    def uncertainty(self) -> tuple[tuple[float, float], ...]:
        """The zones in which nothing is proven: about each limit there is, or all at once where they meet."""
        low, high = self.nonconformance
        if self.conformance is None:
            return ((low, high),)
        below, above = self.conformance
        return tuple(zone for zone in ((low, below), (above, high)) if math.isfinite(zone[0]))

    def verdict(self, value: float) -> Verdict:
        """The decision on a measured value."""
        if self.conformance is not None and self.conformance[0] <= value <= self.conformance[1]:
            return Verdict.CONFORMING
        low, high = self.nonconformance
        return Verdict.NOT_CONFORMING if value < low or value > high else Verdict.NOT_PROVEN
