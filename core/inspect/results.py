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

    `plane` is the face's own plane, fitted freely. `indices` into the cloud, without the points the fit left out;
    `residuals` (mm) of these points from the plane, along its normal, towards the camera positive. `flatness_mm` is
    the spread of the residuals that holds 95 % of the points, the noise of the points included.
    """

    plane: Plane
    indices: NDArray[np.int64]
    residuals: Array
    flatness_mm: float
    rms_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class Contribution:
    """One row of the uncertainty of a thickness: what it comes from and its standard uncertainty in mm.

    `point_mm` is the standard uncertainty in mm, across the surface, that the same cause gives to a typical point;
    None where it is not known.
    """

    source: str
    u_mm: float
    point_mm: float | None = None

    @property
    def sensitivity(self) -> float | None:
        """How much of a typical point's uncertainty from this cause arrives in the result, in mm per mm."""
        return self.u_mm / self.point_mm if self.point_mm else None


@dataclass(frozen=True, eq=False, slots=True)
class GaugeResult:
    """The thickness of a gauge block: distance of two parallel faces.

    `normal` (3,) is the unit normal common to both faces, away from the camera; `parallelism` (rad) the angle between
    the faces when each is fitted freely. `rule` says in words what the thickness is. `points_used` on the upper and
    the lower face. `verdict` is "conforming", "not conforming" or "not proven" (ISO 14253-1), or "" without a nominal
    value and a tolerance.
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
    normal: Array | None = None
    rule: str = ""
    notes: tuple[str, ...] = ()

    @property
    def points_used(self) -> tuple[int, int]:
        """Points on the upper and on the lower face."""
        return len(self.upper.indices), len(self.lower.indices)

    @property
    def U_mm(self) -> float:
        """Expanded uncertainty U = k u."""
        return self.k * self.u_mm

    @property
    def deviation_mm(self) -> float | None:
        """Measured − nominal, or None without a nominal value."""
        return None if self.nominal_mm is None else self.thickness_mm - self.nominal_mm
