"""All results on one part as one list, and the one verdict on the part: what every reader of them shows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from core.inspect.characteristic import Characteristic, thickness_characteristic
from core.inspect.conformity import WORST_FIRST, Verdict
from core.inspect.results import GaugeResult


@dataclass(frozen=True, eq=False, slots=True)
class ResultList:
    """List of the results on one part.

    Parameters
    ----------
    thickness
        Of the gauge; None: none was measured.
    inspected
        What the features of a plan gave, a further thickness among others.
    unmeasured
        Whether a feature with limits could not be measured: that proves nothing.
    """

    thickness: Characteristic | None = None
    inspected: tuple[Characteristic, ...] = ()
    unmeasured: bool = False

    @classmethod
    def of(
        cls, gauge: GaugeResult | None, inspected: Iterable[Characteristic] = (), *, unmeasured: bool = False
    ) -> ResultList:
        """Make the list of results from a thickness, if one was measured, and the characteristics of a plan."""
        return cls(None if gauge is None else thickness_characteristic(gauge), tuple(inspected), unmeasured)

    @property
    def rows(self) -> tuple[Characteristic, ...]:
        """All characteristics measured on the part, the gauge's thickness first."""
        return self.inspected if self.thickness is None else (self.thickness, *self.inspected)

    @property
    def worst_first(self) -> tuple[Characteristic, ...]:
        """Characteristics sorted by verdict, the not conforming first, then by room to the limits, the least first."""
        order = (*WORST_FIRST, Verdict.NONE)
        return tuple(sorted(self.rows, key=lambda one: (order.index(one.verdict), one.room)))

    @property
    def verdict(self) -> Verdict:
        """Verdict on the part: the worst verdict of its characteristics; not proven at best if one was not measured."""
        missing = (Verdict.NOT_PROVEN,) if self.unmeasured else ()
        return Verdict.worst((*(one.verdict for one in self.rows), *missing))
