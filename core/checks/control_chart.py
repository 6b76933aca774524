"""Control chart of a rig's checks: whether a value lies where the rig's own history, or what is stated of it, has it.

References
----------
ISO 7870-2:2013 (control chart of individual values; limits from the moving range).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.checks.repeats import run_chart
from core.model.arrays import Array

FEWEST = 8
"""So many values give limits of their own: with fewer their uncertainty is more than a third of them."""
STATED_K = 3.0
"""Limits by what is stated are so many standard uncertainties away, as those by the history are."""


@dataclass(frozen=True, slots=True)
class ControlChart:
    """Limits of a chart of individual values.

    `own`: they are the mean ± 3 standard deviations, by the moving range, of `n` earlier values; else they stand about
    zero, by what is stated of the rig.
    """

    centre: float
    lower: float
    upper: float
    own: bool
    n: int

    @property
    def limits(self) -> tuple[float, float]:
        """Lower and upper control limit, in the unit of the values."""
        return self.lower, self.upper

    def contains(self, value: float) -> bool:
        """Whether a value lies within the control limits; false for NaN."""
        return self.lower <= value <= self.upper


def control_chart(values: Array, stated: float) -> ControlChart:
    """Compute control limits from values (n,) of checks in order of time, or, if these are few, from `stated`.

    `stated` is their standard uncertainty.
    """
    known = np.asarray(values, dtype=np.float64)
    known = known[np.isfinite(known)]
    run = run_chart(known) if len(known) >= FEWEST else None
    if run is None:
        return ControlChart(0.0, -STATED_K * stated, STATED_K * stated, own=False, n=len(known))
    return ControlChart(run.centre, run.lower, run.upper, own=True, n=len(known))
