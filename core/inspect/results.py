"""What an inspection gives."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.findings.proof import Doubts, check_doubted
from core.inspect.causes import Source, message_of
from core.inspect.conformity import Limits, Verdict, decide
from core.messages import Message
from core.model import LightPlane as Plane
from core.model.arrays import Array


@dataclass(frozen=True, eq=False, slots=True)
class Face:
    """Face of a part: a robustly fitted plane and the points of the cloud it rests on.

    `plane` is the face's own plane, fitted freely. `indices` into the cloud, without the points the fit left out;
    `residuals` (mm) of these points from the plane, along its normal, towards the camera positive. `flatness_mm` is
    the width of the zone of its form, free of the points' noise (`core.inspect.fit.form_zone`), and `flatness_u_mm` its
    standard uncertainty; None where it is not known. Where the points do not span the face
    (`core.inspect.fit.spanned`), `plane` and `residuals` are those of the joint fit.
    """

    plane: Plane
    indices: NDArray[np.int64]
    residuals: Array
    flatness_mm: float | None
    rms_mm: float
    spanned: bool = True
    flatness_u_mm: float | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Contribution:
    """Row of an uncertainty budget: its source and its contribution to the result's uncertainty.

    Parameters
    ----------
    source
        What it comes from.
    u_mm
        Its contribution |c| u(x) to the result, in the result's unit: mm, or rad for an angle.
    point_mm
        Standard uncertainty u(x) of the input itself, in `unit`: for the causes within a scan, what the cause gives to
        a typical point, in mm across the surface. None where it is not known.
    distribution
        "normal", "rectangular", "triangular", "arcsine" or "t".
    dof
        Degrees of freedom of u(x); inf where it is known as well as that.
    value
        Estimate of the input, in `unit`; None where the causes have the expectation zero, or the estimate says nothing.
    unit
        Of the input.
    """

    source: Source
    u_mm: float
    point_mm: float | None = None
    distribution: str = "normal"
    dof: float = math.inf
    value: float | None = None
    unit: str = "mm"

    @property
    def words(self) -> Message:
        """Name of the source of uncertainty, in words."""
        return message_of(self.source)

    @property
    def sensitivity(self) -> float | None:
        """Sensitivity |c| of the result to the input, in the result's unit per `unit`; None if not known."""
        return self.u_mm / self.point_mm if self.point_mm else None


Corners = tuple[tuple[float, float], ...]
"""Corners [u, v] of a polygon in pixels."""


@dataclass(frozen=True, slots=True)
class PairCandidate:
    """Pair of parallel faces that could be the ones meant.

    Parameters
    ----------
    thickness_mm
        Their distance, roughly: by the planes found in the search.
    points
        How many points the search found on the upper and on the lower face.
    upper_px, lower_px
        Where in the picture the middle of their points is.
    outlines_px
        Corners [u, v] round the points of the upper and of the lower face: as regions they confirm this pair. Without
        any where they are not known, as of an older file.
    """

    thickness_mm: float
    points: tuple[int, int]
    upper_px: tuple[float, float]
    lower_px: tuple[float, float]
    outlines_px: tuple[Corners, Corners] = ((), ())


@dataclass(frozen=True, eq=False, slots=True)
class GaugeResult:
    """Thickness of a gauge block: distance of two parallel faces.

    `normal` (3,) is the unit normal common to both faces, away from the camera; `parallelism` (rad) the angle between
    the faces when each is fitted freely, None where a face is not spanned by its points. `rule` says what the thickness
    is. `points_used` on the upper and the lower face. `nominal_mm` ± `tolerance_mm` (above 0) is what is asked. By its
    `doubts` it proves nothing, whatever u; `notes` tell of them. `at_20` tells whether it is stated at 20 °C, by a
    temperature that was stated of the part; None: not known. `candidates` are the pairs of faces that could be meant,
    the measured one first; () where there was no choice.

    Raises
    ------
    ValueError
        If the tolerance is not above 0, or a note says that nothing is proven and there are no doubts.
    """

    thickness_mm: float
    u_mm: float
    k: float
    upper: Face
    lower: Face
    parallelism: float | None
    budget: tuple[Contribution, ...]
    nominal_mm: float | None = None
    tolerance_mm: float | None = None
    normal: Array | None = None
    rule: Message | None = None
    notes: tuple[Message, ...] = ()
    at_20: bool | None = False
    candidates: tuple[PairCandidate, ...] = ()
    doubts: Doubts = field(kw_only=True)

    def __post_init__(self) -> None:
        if self.tolerance_mm is not None and not self.tolerance_mm > 0:
            raise ValueError(f"no decision from a tolerance of {self.tolerance_mm}")
        check_doubted(self.notes, self.doubts)

    @property
    def points_used(self) -> tuple[int, int]:
        """Numbers of points on the upper and on the lower face."""
        return len(self.upper.indices), len(self.lower.indices)

    @property
    def U_mm(self) -> float:
        """Expanded uncertainty U = k u of the thickness, in mm."""
        return self.k * self.u_mm

    @property
    def limits(self) -> Limits | None:
        """Nominal value ± tolerance as limits; None unless both are given."""
        return Limits.around(self.nominal_mm, self.tolerance_mm)

    @property
    def verdict(self) -> Verdict:
        """Verdict on the thickness by ISO 14253-1; `Verdict.NONE` without limits."""
        return decide(self.thickness_mm, self.limits, self.U_mm, self.doubts)

    @property
    def deviation_mm(self) -> float | None:
        """Deviation of the thickness, measured − nominal, in mm; None without a nominal value."""
        return None if self.nominal_mm is None else self.thickness_mm - self.nominal_mm
