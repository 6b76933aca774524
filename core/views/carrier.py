"""The carrier: reference marks on both sides of a plate or frame that a part is held in, and how well they are known.

Its frame has the origin amid the carrier, z out of side A. The marks' errors are correlated: those of one side were
calibrated together, and how the two sides lie to each other was seen in fewer pictures.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.inspect.uncertainty.part import TargetTemperature
from core.model.arrays import Array, frozen_array, set_field

FEWEST_MARKS = 4
"""Marks that a view needs: with three, one that has moved cannot be told from the others."""


NOT_STATED = TargetTemperature()
AT_CELSIUS = 20.0
"""Temperature that lengths are stated at, ISO 1."""


@dataclass(frozen=True, eq=False, slots=True)
class Carrier:
    """Reference marks of a carrier, as calibrated.

    Parameters
    ----------
    numbers
        (N,) the number that each mark is known by, all different; of rings that of the code.
    sides
        (N,) 0 on side A, 1 on side B.
    positions
        (N, 3) in mm in the carrier's frame, at 20 °C: the centres of the discs.
    covariance
        (3N, 3N) in mm² of the stacked positions.
    radius_mm
        Of the discs in mm.
    scaled_by_target
        Whether the carrier was calibrated by the rig's own plane target: then it is larger than stated by as much as
        all that the rig measures. If not, or if that is not known, the rig's scale is in the thickness in full.
    name
        Of the carrier, for reports.
    temperature
        Of the carrier while the views are taken, and its expansion.
    as_printed
        Whether nobody has measured where its marks are: then nothing joined by it is proven.
    """

    numbers: NDArray[np.int64]
    sides: NDArray[np.int64]
    positions: Array
    covariance: Array
    radius_mm: float
    scaled_by_target: bool = False
    name: str = ""
    temperature: TargetTemperature = NOT_STATED
    as_printed: bool = False

    def __post_init__(self) -> None:
        count = len(self.positions)
        set_field(self, "positions", frozen_array(self.positions, (count, 3), "positions"))
        set_field(self, "covariance", frozen_array(self.covariance, (3 * count, 3 * count), "covariance"))
        for name in ("numbers", "sides"):
            index = np.array(getattr(self, name), dtype=np.int64).reshape(count)
            index.flags.writeable = False
            set_field(self, name, index)
        if len(set(self.numbers.tolist())) != count:
            raise ValueError("two marks of a carrier have the same number")

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def sigma(self) -> Array:
        """Standard uncertainties (N, 3) of the marks' positions in mm."""
        return np.asarray(np.sqrt(np.diag(self.covariance)).reshape(-1, 3), dtype=np.float64)

    @property
    def root(self) -> Array:
        """Root R (3N, r) of the covariance: R Rᵀ is the covariance."""
        values, vectors = np.linalg.eigh((self.covariance + self.covariance.T) / 2)
        kept = values > 1e-12 * max(float(values.max(initial=0.0)), 1e-300)
        return np.asarray(vectors[:, kept] * np.sqrt(values[kept]), dtype=np.float64)

    @property
    def growth(self) -> tuple[float, float]:
        """By what share of itself it is larger than at 20 °C, by a stated temperature, with the uncertainty of that."""
        (celsius, u_celsius, _), (alpha, u_alpha) = self.temperature.warmth, self.temperature.expansion
        warmer = celsius - AT_CELSIUS
        return alpha * warmer, float(np.hypot(np.hypot(alpha, u_alpha) * u_celsius, u_alpha * warmer))

    def index_of(self, numbers: NDArray[np.int64]) -> NDArray[np.intp]:
        """Find the places (n,) of the marks with these numbers (n,), which the carrier must have."""
        order = np.argsort(self.numbers)
        return np.asarray(order[np.searchsorted(self.numbers[order], numbers)])

    def on(self, side: int) -> NDArray[np.bool_]:
        """Select (N,) the marks of a side, 0 for A and 1 for B."""
        return np.asarray(self.sides == side)
