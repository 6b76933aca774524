"""Where a result lies in its tolerance, to scale: the bar of the report and of the window."""

from __future__ import annotations

import math
from dataclasses import dataclass

from core.inspect.characteristic import Characteristic
from core.messages import decimals_of
from core.report.wording import ENGLISH, Words, shown_unit

_ROOM = 1.3
"""The scale spans so many times what lies on it: room for the words at both ends."""


@dataclass(frozen=True, slots=True)
class ToleranceScale:
    """Scale of a deviation with its interval ±U against the zone of the tolerance; open where there is no limit.

    Parameters
    ----------
    unit
        In which a person reads it; everything else is in it.
    deviation, U
        Of the result from its nominal value, and its expanded uncertainty.
    lower, upper
        The limits of the deviation; −inf or inf where a side has none.
    """

    unit: str
    deviation: float
    U: float
    lower: float
    upper: float

    @classmethod
    def of(cls, one: Characteristic) -> ToleranceScale | None:
        """Make the tolerance scale of a characteristic; None without limits, or if its value or U is not known."""
        unit, factor = shown_unit(one)
        if one.limits is None or one.deviation is None or not math.isfinite(one.deviation + one.U):
            return None
        return cls(unit, *(factor * value for value in (one.deviation, one.U, one.limits.lower, one.limits.upper)))

    @property
    def limits(self) -> tuple[float, ...]:
        """Finite limits of the deviation, in order, in the unit of the scale."""
        return tuple(limit for limit in (self.lower, self.upper) if math.isfinite(limit))

    def share(self, value: float) -> float:
        """Compute the place of a deviation on the scale, from 0 at the left end to 1; nominal is at 0.5."""
        known = [abs(limit) for limit in self.limits]
        half = _ROOM * max(*known, abs(self.deviation) + self.U, 1e-9) if known else 1.0
        return min(max(0.5 * (1 + value / half), 0.0), 1.0)

    def limit_text(self, limit: float, words: Words = ENGLISH) -> str:
        """Write a limit of the deviation with its sign and unit: '+0.2 mm'."""
        return f"{words.numeral(f'{limit:+g}')} {self.unit}"

    def deviation_text(self, words: Words = ENGLISH) -> str:
        """Write the deviation with its U: 'deviation +0.012 mm ± 0.024 mm'."""
        decimals = max(decimals_of(self.U), 0)
        return words(
            "deviation {deviation} ± {U}",
            deviation=f"{words.fixed(self.deviation, decimals, signed=True)} {self.unit}",
            U=f"{words.fixed(self.U, decimals)} {self.unit}",
        )
