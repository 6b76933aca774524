"""A comparison of the scan with another surface, as it is looked at. Light to import."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.inspect.shown.shown_scan import Values


@dataclass(frozen=True, slots=True)
class Changed:
    """Places that differ significantly to one side: their share of all, mean and most extreme deviation in mm."""

    share: float
    mean_mm: float
    extreme_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class ShownComparison:
    """What the window shows of it.

    Parameters
    ----------
    other, alignment
        Name of the other surface, and how it was aligned.
    places
        How many places were compared.
    lower, higher
        Where material is missing, and where there is more, significantly.
    lod95_mm, diameter_mm, registration_mm
        Median level of detection, and the scales it was compared at.
    deviation
        (N,) in mm at the points of cloud.ply in their order; NaN where nothing was compared.
    significant
        (N,) whether it is beyond the level of detection.
    range_mm
        The end of the colour bar, to either side.
    other_points
        (M, 3) of the other surface in the camera frame, at most as many as can be drawn.
    """

    other: str
    alignment: str
    places: int
    lower: Changed
    higher: Changed
    lod95_mm: float
    diameter_mm: float
    registration_mm: float
    deviation: Values
    significant: NDArray[np.bool_]
    range_mm: float
    other_points: NDArray[np.float32]
