"""Crossings: where the centrelines of two pictures meet.

Each line is fitted close to the meeting by a parabola y = a + b·x + c·x² in a frame laid along it, within one piece, so
a fit never reaches across a kink or a depth edge. The window is as long as the line stays a parabola, found by Lepski's
rule. Over ±2h it knows the line's place as well, within 6 %, as a straight line over ±h. The two curves are met by
Newton's method.

With ε_a, ε_b the errors of the fits along the lines' normals n_a, n_b, the meeting moves by M·ε, M = [n_a; n_b]⁻¹, so
its covariance is M·diag(σ_a², σ_b²)·Mᵀ: errors grow with 1/sin θ.

References
----------
Lepski, O., Asymptotically minimax adaptive estimation, Theory Probab. Appl. 36 (1992), doi:10.1137/1136085.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from core.image.centreline import Centreline
from core.image.local_arc import BIAS_ALLOWED, arc_bias
from core.image.segments import Stack, meeting_segments
from core.model.arrays import Array, frozen_array, set_field

_REASONS = ("angle too small", "arm too short", "lines do not meet")
_SHORTEST_ARM = 0.75  # of the correlation length
_AGREE = 2.5  # standard uncertainties


@dataclass(frozen=True, eq=False, slots=True)
class Crossing:
    """Where line a of one picture and line b of another meet.

    Parameters
    ----------
    uv
        (2,) in pixels, distorted image coordinates.
    tangent_a, tangent_b
        (2,) unit tangents of the lines there.
    angle
        Angle θ between the lines in rad, 0 < θ ≤ π/2.
    sigma_a, sigma_b
        Standard uncertainty of each local fit along its normal there, in pixels.
    covariance
        (2, 2) of `uv` in px².
    curved
        Whether the bend of either line matters: a straight fit would be off by three standard uncertainties.
    """

    uv: Array
    tangent_a: Array
    tangent_b: Array
    angle: float
    sigma_a: float
    sigma_b: float
    covariance: Array
    curved: bool

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


def cross_centrelines(
    a: Sequence[Centreline], b: Sequence[Centreline], half_length_px: float = 40.0, min_angle: float = math.radians(15)
) -> list[tuple[int, int, Crossing]]:
    """All crossings of the pieces `a` of one picture with the pieces `b` of another; see `search_crossings`."""
    return list(search_crossings(a, b, half_length_px, min_angle).found)


def search_crossings(
    a: Sequence[Centreline], b: Sequence[Centreline], half_length_px: float = 40.0, min_angle: float = math.radians(15)
) -> CrossingSearch:
    """All crossings of the pieces `a` of one picture with the pieces `b` of another.

    Parameters
    ----------
    a, b
        Centrelines of the two pictures.
    half_length_px
        How far along the line on either side it may be expected to be nearly straight; the local fit reaches from half
        to twice as far, see above.
    min_angle
        Lines that meet at a smaller angle in rad are left out.
    """
    rejected: Counter[str] = Counter()
    found: list[tuple[int, int, Crossing]] = []
    left_out: list[tuple[Array, str]] = []
    if not a or not b:
        return CrossingSearch((), rejected)
    lines_a, lines_b = Stack(a), Stack(b)
    met = meeting_segments(lines_a.points, lines_a.starts, lines_b.points, lines_b.starts)
    for i, k, j, m in met:
        row = _cross(
            lines_a.points[lines_a.starts[i] : lines_a.starts[i + 1]],
            k,
            a[i].correlation_px,
            lines_b.points[lines_b.starts[j] : lines_b.starts[j + 1]],
            m,
            b[j].correlation_px,
            half_length_px,
            min_angle,
        )
        if row[0] > 0:
            reason = _REASONS[int(row[0]) - 1]
            rejected[reason] += 1
            left_out.append((lines_a.points[lines_a.starts[i] + k, :2].copy(), reason))
            continue
        crossing = _crossing(row)
        if not any(  # one meeting of two rough lines may be met twice
            (i, j) == (p, q) and np.hypot(*(c.uv - crossing.uv)) < half_length_px / 2 for p, q, c in found
        ):
            found.append((int(i), int(j), crossing))
    return CrossingSearch(tuple(found), rejected, tuple(left_out))


def _crossing(row: Array) -> Crossing:
    _, u, v, tau, tav, tbu, tbv, sigma_a, sigma_b, curved = row
    normals = np.array([[-tav, tau], [-tbv, tbu]])
    spread = np.linalg.inv(normals) * np.array([sigma_a, sigma_b])
    sine, cosine = abs(tau * tbv - tav * tbu), abs(tau * tbu + tav * tbv)
    return Crossing(
        uv=np.array([u, v]),
        tangent_a=np.array([tau, tav]),
        tangent_b=np.array([tbu, tbv]),
        angle=math.atan2(sine, cosine),
        sigma_a=float(sigma_a),
        sigma_b=float(sigma_b),
        covariance=spread @ spread.T,
        curved=bool(curved),
    )


@njit(cache=True, nogil=True)
def _parabola(line: Array, first: int, last: int, frame: Array) -> Array:
    """Weighted parabola through points first … last: a, b, c, variance of a, weighted points behind and ahead.

    `frame` is the origin, the unit tangent and a unit of length.
    """
    unit = frame[4]
    normal, right = np.zeros((3, 3)), np.zeros(3)
    powers = np.empty(3)
    powers[0] = 1.0
    behind, ahead = 0, 0
    for k in range(first, last + 1):
        du, dv, weight = line[k, 0] - frame[0], line[k, 1] - frame[1], line[k, 2]
        x, y = (du * frame[2] + dv * frame[3]) / unit, dv * frame[2] - du * frame[3]
        powers[1], powers[2] = x, x * x
        for p in range(3):
            right[p] += weight * powers[p] * y
            for q in range(3):
                normal[p, q] += weight * powers[p] * powers[q]
        if weight > 0:
            behind += x < 0
            ahead += x > 0
    result = np.array([0.0, 0.0, 0.0, np.inf, float(behind), float(ahead)])
    if min(behind, ahead) < 3:
        return result
    covariance = np.linalg.inv(normal)
    for p in range(3):
        result[p] = np.sum(covariance[p] * right) / unit**p
    result[3] = covariance[0, 0]
    return result


@njit(cache=True, nogil=True)
def _local_fit(line: Array, at: int, origin: Array, half: float, correlation: float) -> Array:
    """Local curve around `origin`: ok, t_u, t_v, a, b, c, σ of a, whether its bend matters.

    A parabola over ± half / 2, and over twice and four times that as long as it agrees with the shorter ones
    (Lepski's rule) and an arc of the bend found so far still is a parabola: the longest window over which the line is.
    """
    result = np.zeros(8)
    spread = max(correlation, 1.0)  # points within one correlation length share their error
    first, last = at, at + 1
    frame = np.array([origin[0], origin[1], 0.0, 0.0, half])
    for level in range(3):
        reach = half * 0.5 * 2**level
        while first > 0 and _distance(line[first - 1], origin) <= reach:
            first -= 1
        while last + 1 < len(line) and _distance(line[last + 1], origin) <= reach:
            last += 1
        if level == 0:
            frame[2], frame[3] = line[last, 0] - line[first, 0], line[last, 1] - line[first, 1]
            frame[2:4] /= math.hypot(frame[2], frame[3])
        fit = _parabola(line, first, last, frame)
        if min(fit[4], fit[5]) < _SHORTEST_ARM * correlation or not fit[3] < np.inf:
            continue
        sigma = math.sqrt(fit[3] * spread)
        if result[0] > 0 and (fit[3] * spread > result[6] ** 2 or _disagree(result, fit[0], sigma)):
            break
        if result[0] > 0 and arc_bias(2 * abs(result[5]), reach) > BIAS_ALLOWED * sigma:
            break
        bent = abs(fit[2]) * reach * reach / 3 > 3 * sigma
        result[:] = np.array([1.0, frame[2], frame[3], fit[0], fit[1], fit[2], sigma, 1.0 if bent else 0.0])
    return result


@njit(cache=True, nogil=True)
def _disagree(shorter: Array, a: float, sigma: float) -> bool:
    """Whether the fit `a` over a longer window is further from the shorter window's than noise explains."""
    return bool(abs(a - shorter[3]) > _AGREE * math.sqrt(shorter[6] ** 2 - sigma**2))


@njit(cache=True, nogil=True)
def _distance(p: Array, q: Array) -> float:
    return math.hypot(p[0] - q[0], p[1] - q[1])


@njit(cache=True, nogil=True)
def _cross(
    a: Array, k: int, correlation_a: float, b: Array, m: int, correlation_b: float, half: float, min_angle: float
) -> Array:
    """Meeting of two lines near the segments k and m.

    Returns (10,): 0 or the number of a reason, u, v, both tangents, σ_a, σ_b, whether curved.
    """
    result = np.zeros(10)
    origin = 0.25 * (a[k, :2] + a[k + 1, :2] + b[m, :2] + b[m + 1, :2])
    fit_a = _local_fit(a, k, origin, half, correlation_a)
    fit_b = _local_fit(b, m, origin, half, correlation_b)
    if fit_a[0] == 0 or fit_b[0] == 0:
        result[0] = 2
        return result
    u, v = 0.0, 0.0  # from the origin
    tangents = np.zeros((2, 2))
    step = np.inf
    for _ in range(10):
        normals, heights = np.empty((2, 2)), np.empty(2)
        for i, fit in enumerate((fit_a, fit_b)):
            tu, tv = fit[1], fit[2]
            x, y = u * tu + v * tv, v * tu - u * tv
            slope = fit[4] + 2 * fit[5] * x
            heights[i] = y - (fit[3] + fit[4] * x + fit[5] * x * x)
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
    result[7], result[8] = fit_a[6], fit_b[6]
    result[9] = max(fit_a[7], fit_b[7])
    return result
