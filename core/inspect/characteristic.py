"""One measured characteristic of a part: the row every table, export and verdict of an inspection is made of."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from core.findings.proof import Doubts, check_doubted
from core.inspect.causes import Cause
from core.inspect.conformity import Limits, Verdict, decide
from core.inspect.results import Contribution, GaugeResult
from core.messages import Message

Quantity: TypeAlias = Literal["length", "angle"]


@dataclass(frozen=True, eq=False, slots=True)
class Characteristic:
    """Measured characteristic of a part, with its uncertainty and its limits.

    Parameters
    ----------
    name
        As the technician calls it; unique within an inspection.
    kind
        What it is: "thickness", "step height", "flatness", "diameter", "form", "distance", "angle", …
    value
        In mm, or in rad if `quantity` is "angle".
    u
        Standard uncertainty of the value, in the same unit.
    k
        Coverage factor of U = k·u.
    limits
        What is asked of it; None: no verdict.
    budget
        What u is made of.
    rule
        What exactly was measured; None: nobody said.
    notes
        What is to be known of it.
    doubts
        By what facts of its scan, its own points and its uncertainty it proves nothing.
    at_20
        Whether it is stated at 20 °C, by a temperature that was stated of the part; None: not known.

    Raises
    ------
    ValueError
        If a note says that nothing is proven, and there are no doubts.
    """

    name: str
    kind: str
    value: float
    u: float
    quantity: Quantity = "length"
    k: float = 2.0
    limits: Limits | None = None
    budget: tuple[Contribution, ...] = ()
    rule: Message | None = None
    notes: tuple[Message, ...] = ()
    at_20: bool | None = False
    doubts: Doubts = field(kw_only=True)

    def __post_init__(self) -> None:
        check_doubted(self.notes, self.doubts)

    @property
    def by_master(self) -> bool:
        """Whether the value was compared with a master, so that the master's certificate is in the budget."""
        return any(row.source is Cause.CERTIFICATE for row in self.budget)

    @property
    def U(self) -> float:
        """Expanded uncertainty U = k u, in the unit of the value."""
        return self.k * self.u

    @property
    def deviation(self) -> float | None:
        """Deviation, measured − nominal, in the unit of the value; None without limits."""
        return None if self.limits is None else self.value - self.limits.nominal

    @property
    def verdict(self) -> Verdict:
        """Verdict on conformity with the limits by ISO 14253-1; `Verdict.NONE` without limits."""
        return decide(self.value, self.limits, self.U, self.doubts)

    @property
    def room(self) -> float:
        """Room between the deviation ± U and the nearest limit, as a share of half the width of the tolerance.

        Below 0 where a limit may be exceeded; infinite without limits, −inf where nothing is known.
        """
        if self.limits is None or self.deviation is None:
            return math.inf
        ends = [end for end in (self.limits.lower, self.limits.upper) if math.isfinite(end)]
        if not ends:
            return math.inf
        half = 0.5 * (max(ends) - min(ends)) if len(ends) == 2 else abs(ends[0])
        left = min(self.limits.upper - self.deviation, self.deviation - self.limits.lower) - self.U
        return -math.inf if math.isnan(left) else left / (half or self.U or 1.0)


def thickness_characteristic(gauge: GaugeResult) -> Characteristic:
    """Convert the measured thickness of a gauge result to a characteristic, a row of the list of results."""
    return Characteristic(
        name="thickness",
        kind="thickness",
        value=gauge.thickness_mm,
        u=gauge.u_mm,
        k=gauge.k,
        limits=gauge.limits,
        budget=gauge.budget,
        rule=gauge.rule,
        notes=gauge.notes,
        at_20=gauge.at_20,
        doubts=gauge.doubts,
    )
