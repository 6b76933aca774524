"""A comparison of the scan with another surface, as it is looked at. Light to import."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.inspect.shown.shown_scan import Values
from core.messages import Message

Alignment = Literal["as measured", "frame", "best fit"]
ALIGNED: Mapping[Alignment, Message] = {
    "as measured": Message("comparison.as_measured", "as measured"),
    "frame": Message("comparison.by_frame", "by part coordinates"),
    "best fit": Message("comparison.best_fit", "best fit"),
}
"""How both were aligned, in words."""
AUTOMATIC = "auto"
"""By the part's frame if both have one, else as measured."""


@dataclass(frozen=True, slots=True)
class Changed:
    """Places that differ significantly to one side: their share of all, mean and most extreme deviation in mm."""

    share: float
    mean_mm: float
    extreme_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class ShownComparison:
    """Comparison with another surface as the window shows it.

    Parameters
    ----------
    other, alignment
        Name of the other surface, and how it was aligned.
    core_points
        How many places were compared.
    lower, higher
        Where material is missing, and where there is more, significantly.
    lod95_mm, diameter_mm, registration_mm
        Median level of detection, and the scales it was compared at.
    deviation
        (N,) in mm at the points of cloud.ply in their order; NaN where nothing was compared.
    significant
        (N,) whether it is beyond the level of detection.
    mesh_deviation, mesh_significant
        (V,) the same at the vertices of mesh.ply; empty where there is none.
    range_mm
        The end of the colour bar, to either side.
    other_points
        (M, 3) of the other surface in the camera frame, at most as many as can be drawn.
    """

    other: str
    alignment: Alignment
    core_points: int
    lower: Changed
    higher: Changed
    lod95_mm: float
    diameter_mm: float
    registration_mm: float
    deviation: Values
    significant: NDArray[np.bool_]
    mesh_deviation: Values
    mesh_significant: NDArray[np.bool_]
    range_mm: float
    other_points: NDArray[np.float32]

    def of_points(self, *, significant_only: bool) -> Values:
        """Select the deviations (N,) in mm of the points; with `significant_only`, NaN where they are not."""
        values = self.deviation
        return np.where(self.significant, values, np.float32(np.nan)) if significant_only else values

    def of_mesh(self, *, significant_only: bool) -> Values:
        """Select the deviations (V,) in mm of the mesh; with `significant_only`, NaN where they are not."""
        values = self.mesh_deviation
        return np.where(self.mesh_significant, values, np.float32(np.nan)) if significant_only else values
