"""Crossings of the centrelines of two pictures.

Each line is fitted near the meeting by kriging (`core.image.crossings.kriging`) over a window that ends where the piece
does, at kinks and at jumps (`core.image.crossings.local_fit`): as a parabola over all of it where it is one, and
elsewhere as far as its bend can be foretold. The two curves are met by Newton's method.

With ε_a, ε_b the errors of the fits along the lines' normals n_a, n_b, the meeting moves by M·ε, M = [n_a; n_b]⁻¹, so
its covariance is M·diag(σ_a², σ_b²)·Mᵀ: errors grow with 1/sin θ.

How near that comes to the bound, and how honest σ is, is measured in tests/image/crossings/test_crossing_bound.py.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from core.compiled import compiled, inlined
from core.image.crossings.local_fit import BEND, FIT, PLACE, REACH, SIGMA, SLOPE, T_U, T_V, LineAt, local_fit
from core.image.crossings.segments import CELL_REACH, CELLS, Stack, meeting_segments
from core.image.stripes.centreline import Centreline
from core.model.arrays import Array, frozen_array, set_field
from core.model.small_arrays import new_row, zero_table

NoCrossing = Literal["angle too small", "arm too short", "do not meet"]
"""Why two lines whose segments cut each other give no crossing."""
_REASONS: tuple[NoCrossing, ...] = ("angle too small", "arm too short", "do not meet")
HALF_LENGTH_PX = 40.0
"""Length of a cell, a third of how far a local fit may reach on either side: tests/image/crossings/
test_crossing_bound.py holds it near the bound for lines of any curvature."""
LEAST_ANGLE = math.radians(15)
"""rad: errors along the lines grow with 1/sin θ, fourfold here."""
REASON, UV, TANGENTS, SIGMAS, CURVED = 0, 1, 3, 7, 9
"""Columns of a meeting as `cross_segments` gives it: 0 or which of the reasons it is no crossing for; u, v in px; unit
tangents of a and of b; σ of the fits along their normals in px; 1 where a bend matters."""
MEETING = 10
"""Number of these columns."""
_SHORTEST_ARM, _LEAST_POINTS = 0.75, 3.0  # correlation lengths, and points, that a line must have on either side
_ROUNDS = 10  # of Newton's method at most; mostly three
_SETTLED_PX = 1e-9  # a step of it that ends the rounds
_NOT_MET_PX = 1e-6  # a last step beyond which the curves do not meet
_SINGULAR = 1e-3  # determinant of the normals, sin θ: with less a step is not defined
_SIGNIFICANT_BEND = 3.0  # standard uncertainties by which a straight fit would be off


@dataclass(frozen=True, eq=False, slots=True)
class Crossing:
    """Crossing of a line a of one picture with a line b of another.

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
        Whether the bend of either line matters: a straight fit would be off by more than three standard uncertainties.
    along_a, along_b
        Position on each line: length along it from its first point, in pixels.
    cell_a, cell_b, share_a, share_b
        What each fit has in common with others on the same line, see `core.scan.features.crossings.CrossingTable`.
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
    """Crossings of two pictures, and counts of those left out.

    Parameters
    ----------
    found
        (piece of a, piece of b, crossing) of each.
    rejected
        How many were left out for each reason.
    left_out
        Of each of these the rough position (2,) in pixels, and the reason.
    """

    found: tuple[tuple[int, int, Crossing], ...]
    rejected: Mapping[NoCrossing, int]
    left_out: tuple[tuple[Array, NoCrossing], ...] = ()


Lines = Sequence[Centreline] | Stack
"""The centrelines of one picture; made ready if they are to be crossed more than once."""


def cross_centrelines(
    a: Lines, b: Lines, half_length_px: float = HALF_LENGTH_PX, min_angle: float = LEAST_ANGLE
) -> list[tuple[int, int, Crossing]]:
    """Find all crossings of centrelines `a` of one picture with `b` of another: (index, index, crossing)."""
    return list(search_crossings(a, b, half_length_px, min_angle).found)


def search_crossings(
    a: Lines, b: Lines, half_length_px: float = HALF_LENGTH_PX, min_angle: float = LEAST_ANGLE
) -> CrossingSearch:
    """Find all crossings of centrelines `a` of one picture with `b` of another, and count those left out, by reason.

    Parameters
    ----------
    a, b
        Centrelines of the two pictures; a `Stack` must have been made with cells of `half_length_px`.
    half_length_px
        A third of how far along the line on either side the local fit may reach.
    min_angle
        Lines that meet at a smaller angle in rad are left out.

    Raises
    ------
    ValueError
        If a `Stack` was made with cells of another length.
    """
    rejected: Counter[NoCrossing] = Counter()
    found: list[tuple[int, int, Crossing]] = []
    left_out: list[tuple[Array, NoCrossing]] = []
    if not len(a) or not len(b):
        return CrossingSearch((), rejected)
    of_a, of_b = _stack(a, half_length_px), _stack(b, half_length_px)
    met = meeting_segments(of_a.points, of_a.starts, of_a.boxes, of_b.points, of_b.starts, of_b.boxes)
    for i, k, j, m in met:
        crossing = _cross_at(of_a, i, k, of_b, j, m, min_angle)
        if not isinstance(crossing, Crossing):
            rejected[crossing] += 1
            left_out.append((of_a.points[of_a.starts[i] + k, :2].copy(), crossing))
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


def _cross_at(of_a: Stack, i: int, k: int, of_b: Stack, j: int, m: int, min_angle: float) -> Crossing | NoCrossing:
    """The crossing of the segments k of piece i and m of piece j, or the reason there is none."""
    piece_a, piece_b = of_a.piece(i), of_b.piece(j)
    cell = of_a.cell_px
    arc_a, arc_b = 0.5 * (piece_a.arc[k] + piece_a.arc[k + 1]), 0.5 * (piece_b.arc[m] + piece_b.arc[m + 1])
    cell_a, cell_b = (max(0, math.floor(arc / cell) - CELL_REACH) for arc in (arc_a, arc_b))
    share = np.zeros((2, CELLS))
    at_a = LineAt(piece_a.points, k, piece_a.bins, piece_a.broken, arc_a, piece_a.correlation_px, cell_a)
    at_b = LineAt(piece_b.points, m, piece_b.bins, piece_b.broken, arc_b, piece_b.correlation_px, cell_b)
    row = np.empty(MEETING)
    _cross(at_a, at_b, cell, min_angle, share, row)
    if row[REASON] > 0:
        return _REASONS[int(row[REASON]) - 1]
    _, u, v, tau, tav, tbu, tbv, sigma_a, sigma_b, curved = row.tolist()
    sine, cosine = abs(tau * tbv - tav * tbu), abs(tau * tbu + tav * tbv)
    a, b = sigma_a / sine, sigma_b / sine
    spread = np.array([[a * tbu, -b * tau], [a * tbv, -b * tav]])  # the inverse of both normals, or its negative
    return Crossing(
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


@compiled()
def _cross(a: LineAt, b: LineAt, half: float, min_angle: float, share: Array, result: Array) -> None:
    cross_segments(a, b, half, min_angle, share, result)


@inlined()
def _arm_too_short(line: LineAt, origin: tuple[float, float], reach: float) -> bool:
    """Whether a line has too few points to either side of its segment within `reach` px of it."""
    points, at, least = line.points, line.segment, max(_LEAST_POINTS, _SHORTEST_ARM * line.correlation_px)
    behind, ahead = 0, 0
    for k in range(at, -1, -1):
        if math.hypot(points[k, 0] - origin[0], points[k, 1] - origin[1]) > reach or behind >= least:
            break
        behind += points[k, 2] > 0
    for k in range(at + 1, len(points)):
        if math.hypot(points[k, 0] - origin[0], points[k, 1] - origin[1]) > reach or ahead >= least:
            break
        ahead += points[k, 2] > 0
    return bool(min(behind, ahead) < least)


@inlined()
def cross_segments(a: LineAt, b: LineAt, half: float, min_angle: float, share: Array, result: Array) -> None:
    """Cross the local fits of two lines near one segment of each; the crossing's figures go into `result`.

    Parameters
    ----------
    a, b
        The lines at these segments.
    half
        A third of how far the local fits may reach, and the length of a cell, in px.
    min_angle
        Lines at a smaller angle in rad are no crossing.
    share
        (2, K), filled with what the fits have in common with others on the same line: see `local_fit`.
    result
        (MEETING,), filled with the figures that REASON and the others name.
    """
    for i in range(MEETING):
        result[i] = 0.0
    fits, tangents, normals, heights = zero_table(2, FIT), zero_table(2, 2), zero_table(2, 2), new_row(2)
    k, m = a.segment, b.segment
    origin = (
        0.25 * (a.points[k, 0] + a.points[k + 1, 0] + b.points[m, 0] + b.points[m + 1, 0]),
        0.25 * (a.points[k, 1] + a.points[k + 1, 1] + b.points[m, 1] + b.points[m + 1, 1]),
    )
    reach = CELL_REACH * half
    if (
        _arm_too_short(a, origin, reach)
        or _arm_too_short(b, origin, reach)
        or not local_fit(a, origin, reach, half, fits[0], share[0])
        or not local_fit(b, origin, reach, half, fits[1], share[1])
    ):
        result[REASON] = 2
        return
    u, v = 0.0, 0.0  # from the origin
    step = math.inf
    for _ in range(_ROUNDS):
        for i in range(2):
            fit = fits[i]
            tu, tv = fit[T_U], fit[T_V]
            x, y = u * tu + v * tv, v * tu - u * tv
            slope = fit[SLOPE] + 2 * fit[BEND] * x
            heights[i] = y - (fit[PLACE] + fit[SLOPE] * x + fit[BEND] * x * x)
            normals[i, 0], normals[i, 1] = -tv - slope * tu, tu - slope * tv
            norm = math.hypot(1.0, slope)
            tangents[i, 0], tangents[i, 1] = (tu - slope * tv) / norm, (tv + slope * tu) / norm
        determinant = normals[0, 0] * normals[1, 1] - normals[0, 1] * normals[1, 0]
        if abs(determinant) < _SINGULAR:
            result[REASON] = 1
            return
        du = -(heights[0] * normals[1, 1] - heights[1] * normals[0, 1]) / determinant
        dv = -(normals[0, 0] * heights[1] - normals[1, 0] * heights[0]) / determinant
        u, v, step = u + du, v + dv, math.hypot(du, dv)
        if step < _SETTLED_PX or math.hypot(u, v) > half:
            break
    if abs(tangents[0, 0] * tangents[1, 1] - tangents[0, 1] * tangents[1, 0]) < math.sin(min_angle):
        result[REASON] = 1
        return
    if step > _NOT_MET_PX or math.hypot(u, v) > 0.5 * half:
        result[REASON] = 3
        return
    result[UV], result[UV + 1] = origin[0] + u, origin[1] + v
    for i in range(2):
        fit = fits[i]
        result[TANGENTS + 2 * i], result[TANGENTS + 2 * i + 1] = tangents[i, 0], tangents[i, 1]
        along_normal = 1 / math.hypot(1.0, fit[SLOPE])
        result[SIGMAS + i] = fit[SIGMA] * along_normal
        for cell in range(share.shape[1]):
            share[i, cell] *= along_normal
        if abs(fit[BEND]) * fit[REACH] ** 2 / 3 > _SIGNIFICANT_BEND * fit[SIGMA]:
            result[CURVED] = 1.0
