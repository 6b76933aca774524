"""Crossings: where the centrelines of two pictures meet.

Each line is fitted near the meeting by kriging (`core.image.kriging`) over a window that ends where the piece does, at
kinks and at jumps (`core.image.local_fit`): as a parabola over all of it where it is one, and elsewhere as far as its
bend can be foretold. The two curves are met by Newton's method.

With ε_a, ε_b the errors of the fits along the lines' normals n_a, n_b, the meeting moves by M·ε, M = [n_a; n_b]⁻¹, so
its covariance is M·diag(σ_a², σ_b²)·Mᵀ: errors grow with 1/sin θ.

How near that comes to the bound, and how honest σ is, is measured in tests/image/test_crossing_bound.py.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.image.local_fit import BEND, FIT, PLACE, REACH, SIGMA, SLOPE, T_U, T_V, local_fit
from core.image.segments import CELL_REACH, CELLS, Stack, meeting_segments
from core.model.arrays import Array, frozen_array, set_field

_REASONS = ("angle too small", "arm too short", "lines do not meet")
MEETING = 10
"""Figures that `cross_segments` gives of a meeting."""
_SHORTEST_ARM = 0.75  # of the correlation length


@dataclass(frozen=True, eq=False, slots=True)
class Crossing:
    """Where line a of one picture and line b of another meet.

    Parameters
    ----------
    uv
        (2,) in pixels, distorted image coordinates.
    tangent_a, tangent_b
        (2,) unit tangents of the lines there, the way their points run.
    angle
        Angle θ between the lines in rad, 0 < θ ≤ π/2.
    sigma_a, sigma_b
        Standard uncertainty of each local fit along its normal there, in pixels.
    covariance
        (2, 2) of `uv` in px².
    curved
        Whether the bend of either line matters: a straight fit would be off by three standard uncertainties.
    along_a, along_b
        Where on each line, as length along it from its first point, in pixels.
    cell_a, cell_b, share_a, share_b
        What each fit has in common with others on the same line: see `core.scan.crossings.CrossingTable`.
    """

    uv: Array
    tangent_a: Array
    tangent_b: Array
    angle: float
    sigma_a: float
    sigma_b: float
    covariance: Array
    curved: bool
    along_a: float = 0.0
    along_b: float = 0.0
    cell_a: int = 0
    cell_b: int = 0
    share_a: Array = field(default_factory=lambda: np.zeros(CELLS))
    share_b: Array = field(default_factory=lambda: np.zeros(CELLS))

    def __post_init__(self) -> None:
        for name in ("uv", "tangent_a", "tangent_b"):
            set_field(self, name, frozen_array(getattr(self, name), (2,), name))
        set_field(self, "covariance", frozen_array(self.covariance, (2, 2), "covariance"))


@dataclass(frozen=True, eq=False, slots=True)
class CrossingSearch:
    """All crossings of two pictures: (piece of a, piece of b, crossing).

    `rejected` counts those left out by reason; `left_out` has about where (2,) in pixels each of them is, and why.
    """

    found: tuple[tuple[int, int, Crossing], ...]
    rejected: Mapping[str, int]
    left_out: tuple[tuple[Array, str], ...] = ()


Lines = Sequence[Centreline] | Stack
"""The centrelines of one picture; made ready if they are to be crossed more than once."""


def cross_centrelines(
    a: Lines, b: Lines, half_length_px: float = 40.0, min_angle: float = math.radians(15)
) -> list[tuple[int, int, Crossing]]:
    """All crossings of the pieces `a` of one picture with the pieces `b` of another; see `search_crossings`."""
    return list(search_crossings(a, b, half_length_px, min_angle).found)


def search_crossings(
    a: Lines, b: Lines, half_length_px: float = 40.0, min_angle: float = math.radians(15)
) -> CrossingSearch:
    """All crossings of the pieces `a` of one picture with the pieces `b` of another.

    Parameters
    ----------
    a, b
        Centrelines of the two pictures; a `Stack` must have been made with cells of `half_length_px`.
    half_length_px
        A third of how far along the line on either side the local fit may reach.
    min_angle
        Lines that meet at a smaller angle in rad are left out.
    """
    rejected: Counter[str] = Counter()
    found: list[tuple[int, int, Crossing]] = []
    left_out: list[tuple[Array, str]] = []
    if not len(a) or not len(b):
        return CrossingSearch((), rejected)
    of_a, of_b = _stack(a, half_length_px), _stack(b, half_length_px)
    met = meeting_segments(of_a.points, of_a.starts, of_a.boxes, of_b.points, of_b.starts, of_b.boxes)
    for i, k, j, m in met:
        reason, crossing = _cross_at(of_a, i, k, of_b, j, m, min_angle)
        if crossing is None:
            rejected[reason] += 1
            left_out.append((of_a.points[of_a.starts[i] + k, :2].copy(), reason))
        elif not any(  # one meeting of two rough lines may be met twice
            (i, j) == (p, q) and np.hypot(*(c.uv - crossing.uv)) < half_length_px / 2 for p, q, c in found
        ):
            found.append((int(i), int(j), crossing))
    return CrossingSearch(tuple(found), rejected, tuple(left_out))


def _stack(lines: Lines, cell_px: float) -> Stack:
    if not isinstance(lines, Stack):
        return Stack(lines, cell_px)
    if lines.cell_px != cell_px:
        raise ValueError(f"lines made ready with cells of {lines.cell_px} px cannot be fitted with {cell_px} px")
    return lines


def _cross_at(
    of_a: Stack, i: int, k: int, of_b: Stack, j: int, m: int, min_angle: float
) -> tuple[str, Crossing | None]:
    """The crossing of the segments k of piece i and m of piece j, or the reason there is none."""
    piece_a, piece_b = of_a.piece(i), of_b.piece(j)
    cell = of_a.cell_px
    arc_a, arc_b = 0.5 * (piece_a.arc[k] + piece_a.arc[k + 1]), 0.5 * (piece_b.arc[m] + piece_b.arc[m + 1])
    cell_a, cell_b = (max(0, math.floor(arc / cell) - CELL_REACH) for arc in (arc_a, arc_b))
    share = np.zeros((2, CELLS))
    row = cross_segments(
        piece_a.points, k, piece_a.bins, piece_a.broken, arc_a, piece_a.correlation_px, cell_a,
        piece_b.points, m, piece_b.bins, piece_b.broken, arc_b, piece_b.correlation_px, cell_b,
        cell, min_angle, share,
    )  # fmt: skip
    if row[0] > 0:
        return _REASONS[int(row[0]) - 1], None
    _, u, v, tau, tav, tbu, tbv, sigma_a, sigma_b, curved = row.tolist()
    sine, cosine = abs(tau * tbv - tav * tbu), abs(tau * tbu + tav * tbv)
    a, b = sigma_a / sine, sigma_b / sine
    spread = np.array([[a * tbu, -b * tau], [a * tbv, -b * tav]])  # the inverse of both normals, or its negative
    crossing = Crossing(
        uv=np.array([u, v]),
        tangent_a=np.array([tau, tav]),
        tangent_b=np.array([tbu, tbv]),
        angle=math.atan2(sine, cosine),
        sigma_a=sigma_a,
        sigma_b=sigma_b,
        covariance=spread @ spread.T,
        curved=bool(curved),
        along_a=float(arc_a),
        along_b=float(arc_b),
        cell_a=cell_a,
        cell_b=cell_b,
        share_a=share[0],
        share_b=share[1],
    )
    return "", crossing


@njit(cache=True, nogil=True)
def _arm_too_short(points: Array, at: int, origin: Array, half: float, correlation: float) -> bool:
    """Whether there is too little to either side of the segment `at` within `half` px of it."""
    least = max(3.0, _SHORTEST_ARM * correlation)
    behind, ahead = 0, 0
    for k in range(at, -1, -1):
        if math.hypot(points[k, 0] - origin[0], points[k, 1] - origin[1]) > half or behind >= least:
            break
        behind += points[k, 2] > 0
    for k in range(at + 1, len(points)):
        if math.hypot(points[k, 0] - origin[0], points[k, 1] - origin[1]) > half or ahead >= least:
            break
        ahead += points[k, 2] > 0
    return bool(min(behind, ahead) < least)


@njit(cache=True, nogil=True)
def cross_segments(
    a: Array,
    k: int,
    bins_a: Array,
    broken_a: NDArray[np.bool_],
    arc_a: float,
    correlation_a: float,
    cell_a: int,
    b: Array,
    m: int,
    bins_b: Array,
    broken_b: NDArray[np.bool_],
    arc_b: float,
    correlation_b: float,
    cell_b: int,
    half: float,
    min_angle: float,
    share: Array,
) -> Array:
    """Meeting of two lines near the segments k and m.

    Returns (MEETING,): 0 or the number of a reason, u, v, both tangents, σ_a, σ_b, whether curved; into `share` (2, K)
    what cells share.
    """
    result = np.zeros(MEETING)
    fits = np.zeros((2, FIT))
    origin = 0.25 * (a[k, :2] + a[k + 1, :2] + b[m, :2] + b[m + 1, :2])
    reach = CELL_REACH * half
    if (
        _arm_too_short(a, k, origin, reach, correlation_a)
        or _arm_too_short(b, m, origin, reach, correlation_b)
        or not local_fit(bins_a, broken_a, arc_a, origin, reach, half, cell_a, fits[0], share[0])
        or not local_fit(bins_b, broken_b, arc_b, origin, reach, half, cell_b, fits[1], share[1])
    ):
        result[0] = 2
        return result
    u, v = 0.0, 0.0  # from the origin
    tangents = np.zeros((2, 2))
    step = np.inf
    for _ in range(10):
        normals, heights = np.empty((2, 2)), np.empty(2)
        for i, fit in enumerate(fits):
            tu, tv = fit[T_U], fit[T_V]
            x, y = u * tu + v * tv, v * tu - u * tv
            slope = fit[SLOPE] + 2 * fit[BEND] * x
            heights[i] = y - (fit[PLACE] + fit[SLOPE] * x + fit[BEND] * x * x)
            normals[i, 0], normals[i, 1] = -tv - slope * tu, tu - slope * tv
            norm = math.hypot(1.0, slope)
            tangents[i, 0], tangents[i, 1] = (tu - slope * tv) / norm, (tv + slope * tu) / norm
        determinant = normals[0, 0] * normals[1, 1] - normals[0, 1] * normals[1, 0]
        if abs(determinant) < 1e-3:
            result[0] = 1
            return result
        du = -(heights[0] * normals[1, 1] - heights[1] * normals[0, 1]) / determinant
        dv = -(normals[0, 0] * heights[1] - normals[1, 0] * heights[0]) / determinant
        u, v, step = u + du, v + dv, math.hypot(du, dv)
        if step < 1e-9 or math.hypot(u, v) > half:
            break
    if abs(tangents[0, 0] * tangents[1, 1] - tangents[0, 1] * tangents[1, 0]) < math.sin(min_angle):
        result[0] = 1
        return result
    if step > 1e-6 or math.hypot(u, v) > 0.5 * half:
        result[0] = 3
        return result
    result[1], result[2] = origin[0] + u, origin[1] + v
    result[3:5], result[5:7] = tangents[0], tangents[1]
    for i, fit in enumerate(fits):
        along_normal = 1 / math.hypot(1.0, fit[SLOPE])
        result[7 + i] = fit[SIGMA] * along_normal
        share[i] *= along_normal
        if abs(fit[BEND]) * fit[REACH] ** 2 / 3 > 3 * fit[SIGMA]:
            result[9] = 1.0
    return result
