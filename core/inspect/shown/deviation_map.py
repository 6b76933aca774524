"""The deviation of a measured surface from the nominal one, in classes that can be told apart without colours."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model import Pose
from core.model.arrays import Array

MARKS = ("", "+", "++", "+++", "+!")
"""Of deviations outwards up to a quarter, a half, three quarters and all of the tolerance, and beyond it."""
QUARTERS = (0.25, 0.5, 0.75, 1.0)
"""Upper ends of the classes, as shares of the tolerance."""


@dataclass(frozen=True, eq=False, slots=True)
class DeviationMap:
    """Deviations of N places of the surface, measured − nominal, outwards positive.

    Parameters
    ----------
    points
        (N, 3) in mm in the camera frame: the mesh's vertices, or points of the cloud.
    vertices
        (N,) which vertices of the mesh they are, or which points of the cloud.
    deviation
        (N,) in mm.
    sigma
        (N,) its standard uncertainty in mm, without what is common to the whole scan.
    tolerance_mm
        What the classes are shares of.
    pose_camera_nominal
        The nominal surface's coordinates into the camera frame: how it was aligned.
    nominal
        (T, 3, 3) in mm in the camera frame: corners of the nominal surface's triangles, as it was aligned.
    """

    points: Array
    vertices: NDArray[np.int64]
    deviation: Array
    sigma: Array
    tolerance_mm: float
    pose_camera_nominal: Pose
    nominal: Array

    @property
    def classes(self) -> NDArray[np.int8]:
        """Classes (N,), −4 … 4, of the deviations by quarters of the tolerance; ±4 is beyond the tolerance."""
        return classes_of(self.deviation, self.tolerance_mm)

    @property
    def outside(self) -> float:
        """Share (0 … 1) of the places whose deviation is beyond the tolerance."""
        return float(np.mean(np.abs(self.deviation) > self.tolerance_mm)) if len(self.deviation) else 0.0

    def histogram(self, bins: int = 40) -> tuple[Array, NDArray[np.int64]]:
        """Count the deviations between edges (bins + 1,) in mm, outliers in the end bins; return edges and counts."""
        widest = max(1.5 * self.tolerance_mm, float(np.quantile(np.abs(self.deviation), 0.99)))
        edges = np.linspace(-widest, widest, bins + 1)
        return edges, np.histogram(np.clip(self.deviation, -widest, widest), edges)[0].astype(np.int64)


def classes_of(deviation: Array, tolerance_mm: float) -> NDArray[np.int8]:
    """Compute the classes −4 … 4 of deviations (N,) in mm by quarters of the tolerance; ±4 is beyond the tolerance.

    Examples
    --------
    >>> [mark(one) for one in classes_of(np.array([0.01, 0.03, -0.06, 0.2, -0.2]), 0.1)]
    ['', '+', '−−', '+!', '−!']
    """
    size = np.searchsorted(np.array(QUARTERS) * tolerance_mm, np.abs(deviation), side="left")
    return np.asarray(np.sign(deviation) * size, dtype=np.int8)


def mark(number: int) -> str:
    """Return the mark of a deviation class −4 … 4, as "++", "−−−" or "+!", where ! means beyond the tolerance."""
    outwards = MARKS[abs(int(number))]
    return outwards if number >= 0 else outwards.replace("+", "−")


def bounds(number: int, tolerance_mm: float) -> tuple[float, float]:
    """Return the lower and upper end in mm of the deviation class `number`, −4 … 4; class ±4 ends at ±inf.

    Examples
    --------
    >>> bounds(0, 0.1), bounds(-4, 0.1)
    ((-0.025, 0.025), (-inf, -0.1))
    """
    ends = (0.0, *(quarter * tolerance_mm for quarter in QUARTERS), math.inf)
    if number == 0:
        return -ends[1], ends[1]
    low, high = ends[abs(number)], ends[abs(number) + 1]
    return (low, high) if number > 0 else (-high, -low)
