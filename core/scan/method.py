"""The ways of locating sweeps: the one place where they are named. Light to import: command line and files need it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from core.messages import Message

SIGMA_CUT_MM = 0.05
"""Points with a larger standard uncertainty of depth are left out, if nothing else is said."""
MOST_SIGMA_CUT_MM = 10.0
"""The largest such limit that can be meant."""


class Method(StrEnum):
    """Method of locating the sweeps of a scan; the value is its name in files and on the command line."""

    NETWORK = "network"
    """All sweeps adjusted together."""
    THREE_CROSSINGS = "three-crossings"
    """Each frame by itself, from its own crossings with the fan: Sun et al. 2023, section 4."""


@dataclass(frozen=True, slots=True)
class ReconstructOptions:
    """Options of solving a scan: how sweeps are located, which points are left out, time from row to row.

    `method`: how sweeps are located. Points with a σ above `sigma_cut_mm` are left out. `row_time_us` is the time from
    one row of a picture to the next, 0 where all are taken at once, None where nothing is stated.
    """

    method: Method = Method.NETWORK
    sigma_cut_mm: float = SIGMA_CUT_MM
    row_time_us: float | None = None

    @property
    def complaint(self) -> Message | None:
        """Complaint that the cut of σ or the time from row to row is impossible; None if both can be."""
        row_time = 0.0 if self.row_time_us is None else self.row_time_us
        if 0 < self.sigma_cut_mm <= MOST_SIGMA_CUT_MM and 0 <= row_time < math.inf:
            return None
        return Message(
            "api.no_options",
            "a σ cut of {cut_mm} mm with {row_time} µs from row to row cannot be",
            cut_mm=str(self.sigma_cut_mm),
            row_time=str(self.row_time_us),
        )
