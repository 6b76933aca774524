"""What an inspection gives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model import LightPlane as Plane
from core.model.arrays import Array


@dataclass(frozen=True, eq=False, slots=True)
class Face:
    """One face of a part: a robustly fitted plane and the points of the cloud it rests on.

    `indices` into the cloud; `residuals` (mm) of these points from the plane, along its normal, towards the camera
    positive. `flatness_mm` is the spread of the residuals that holds 95 % of the points.
    """

    plane: Plane
    indices: NDArray[np.int64]
    residuals: Array
    flatness_mm: float
    rms_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class Contribution:
    """One row of the uncertainty of a thickness: what it comes from and its standard uncertainty in mm."""

    source: str
    u_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class GaugeResult:
    """The thickness of a gauge block: distance of two parallel faces.

    `verdict` is "conforming", "not conforming" or "not proven" (ISO 14253-1), or "" without a nominal value.
    """

    thickness_mm: float
    u_mm: float
    k: float
    upper: Face
    lower: Face
    parallelism: float
    budget: tuple[Contribution, ...]
    nominal_mm: float | None = None
    tolerance_mm: float | None = None
    verdict: str = ""

    @property
    def U_mm(self) -> float:
        """Expanded uncertainty U = k u."""
        return self.k * self.u_mm

    @property
    def deviation_mm(self) -> float | None:
        """Measured − nominal, or None without a nominal value."""
        return None if self.nominal_mm is None else self.thickness_mm - self.nominal_mm
