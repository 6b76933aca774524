"""Crossings: where the centrelines of two pictures meet.

Each line is fitted close to the meeting, y = a + b·x + c·x² in a frame laid along it, within one piece, so a fit
never reaches across a kink or a depth edge. The bend c comes from a window twice as long where the piece has it: it
is six times better known there and then costs the crossing almost nothing; its uncertainty is carried along. The two
curves are met by Newton's method.

With ε_a, ε_b the errors of the fits along the lines' normals n_a, n_b, the meeting moves by M·ε, M = [n_a; n_b]⁻¹, so
its covariance is M·diag(σ_a², σ_b²)·Mᵀ: errors grow with 1/sin θ.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.model.arrays import Array, frozen_array, set_field

_CHUNK = 16
"""Segments that share a bounding box in the search."""
_REASONS = ("angle too small", "arm too short", "lines do not meet")
_SHORTEST_ARM = 0.75  # of the correlation length


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
        Whether the bend of either line moved its fit by more than the fit's standard uncertainty.
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
    """All crossings of two pictures: (piece of a, piece of b, crossing), and how many were left out for what reason."""

    found: tuple[tuple[int, int, Crossing], ...]
    rejected: Mapping[str, int]


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
        How far along the line on either side the local fit reaches.
    min_angle
        Lines that meet at a smaller angle in rad are left out.
    """
    rejected: Counter[str] = Counter()
    found: list[tuple[int, int, Crossing]] = []
    if not a or not b:
        return CrossingSearch((), rejected)
    lines_a, lines_b = _Stack(a), _Stack(b)
    met = _meeting_segments(lines_a.points, lines_a.starts, lines_b.points, lines_b.starts)
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
            rejected[_REASONS[int(row[0]) - 1]] += 1
            continue
        crossing = _crossing(row)
        if not any(  # one meeting of two rough lines may be met twice
            (i, j) == (p, q) and np.hypot(*(c.uv - crossing.uv)) < half_length_px / 2 for p, q, c in found
        ):
            found.append((int(i), int(j), crossing))
    return CrossingSearch(tuple(found), rejected)


class _Stack:
    """Several centrelines in one array: `points` (N, 3) u, v, weight; piece i is starts[i] … starts[i + 1]."""

    __slots__ = ("points", "starts")

    def __init__(self, lines: Sequence[Centreline]) -> None:
        self.starts = np.cumsum([0, *map(len, lines)])
        self.points = np.empty((int(self.starts[-1]), 3))
        for line, start, end in zip(lines, self.starts[:-1], self.starts[1:], strict=True):
            self.points[start:end, :2] = line.uv
            self.points[start:end, 2] = np.where(line.saturated, 0.0, 1 / line.sigma**2)


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
def _chunks(points: Array, starts: NDArray[np.int64]) -> Array:
    """Bounding boxes of up to _CHUNK segments: (K, 7) piece, first, last point, u and v from, to."""
    count = 0
    for i in range(len(starts) - 1):
        count += max(0, (starts[i + 1] - starts[i] - 2) // _CHUNK + 1)
    boxes = np.empty((count, 7))
    k = 0
    for i in range(len(starts) - 1):
        for first in range(starts[i], starts[i + 1] - 1, _CHUNK):
            last = min(first + _CHUNK, starts[i + 1] - 1)
            boxes[k, 0], boxes[k, 1], boxes[k, 2] = i, first, last
            boxes[k, 3], boxes[k, 5] = points[first : last + 1, 0].min(), points[first : last + 1, 0].max()
            boxes[k, 4], boxes[k, 6] = points[first : last + 1, 1].min(), points[first : last + 1, 1].max()
            k += 1
    return boxes[:k]


@njit(cache=True, nogil=True)
def _meeting_segments(
    a: Array, starts_a: NDArray[np.int64], b: Array, starts_b: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Segments that cut each other: (K, 4) piece and first point within it, of a and of b."""
    boxes_a, boxes_b = _chunks(a, starts_a), _chunks(b, starts_b)
    found = np.empty((16, 4), dtype=np.int64)
    count = 0
    for p in range(len(boxes_a)):
        for q in range(len(boxes_b)):
            if (
                boxes_a[p, 5] < boxes_b[q, 3]
                or boxes_b[q, 5] < boxes_a[p, 3]
                or boxes_a[p, 6] < boxes_b[q, 4]
                or boxes_b[q, 6] < boxes_a[p, 4]
            ):
                continue
            for k in range(int(boxes_a[p, 1]), int(boxes_a[p, 2])):
                for m in range(int(boxes_b[q, 1]), int(boxes_b[q, 2])):
                    if not _segments_cut(a[k], a[k + 1], b[m], b[m + 1]):
                        continue
                    if count == len(found):
                        found = np.concatenate((found, np.empty_like(found)))
                    i, j = int(boxes_a[p, 0]), int(boxes_b[q, 0])
                    found[count, 0], found[count, 1] = i, k - starts_a[i]
                    found[count, 2], found[count, 3] = j, m - starts_b[j]
                    count += 1
    return found[:count]


@njit(cache=True, nogil=True)
def _segments_cut(p: Array, q: Array, r: Array, s: Array) -> bool:
    du, dv, eu, ev = q[0] - p[0], q[1] - p[1], s[0] - r[0], s[1] - r[1]
    cross = du * ev - dv * eu
    if cross == 0.0:
        return False
    along_a = ((r[0] - p[0]) * ev - (r[1] - p[1]) * eu) / cross
    along_b = ((r[0] - p[0]) * dv - (r[1] - p[1]) * du) / cross
    return bool(0 <= along_a < 1 and 0 <= along_b < 1)


@njit(cache=True, nogil=True)
def _moments(line: Array, first: int, last: int, frame: Array, places: Array) -> tuple[Array, Array]:
    """Weighted normal equations of a parabola (3, 3), (3,) through points first … last, seen in a frame.

    `frame` is origin and unit tangent; the places along and beside it are kept in `places` (N, 2).
    """
    normal, right = np.zeros((3, 3)), np.zeros(3)
    for k in range(first, last + 1):
        du, dv = line[k, 0] - frame[0], line[k, 1] - frame[1]
        x, y, w = du * frame[2] + dv * frame[3], dv * frame[2] - du * frame[3], line[k, 2]
        places[k, 0], places[k, 1] = x, y
        normal[0, 0] += w
        normal[0, 1] += w * x
        normal[1, 1] += w * x * x
        normal[1, 2] += w * x * x * x
        normal[2, 2] += w * x * x * x * x
        right[0] += w * y
        right[1] += w * x * y
        right[2] += w * x * x * y
    normal[0, 2] = normal[1, 1]
    normal[1, 0], normal[2, 0], normal[2, 1] = normal[0, 1], normal[0, 2], normal[1, 2]
    return normal, right


@njit(cache=True, nogil=True)
def _local_fit(line: Array, at: int, origin: Array, half: float, correlation: float) -> Array:
    """Local curve around `origin`: ok, t_u, t_v, a, b, c, σ of a, whether it is curved."""
    result = np.zeros(8)
    first, last, wide_first, wide_last = at, at + 1, at, at + 1
    while wide_first > 0 and _distance(line[wide_first - 1], origin) <= 2 * half:
        wide_first -= 1
        if _distance(line[wide_first], origin) <= half:
            first = wide_first
    while wide_last + 1 < len(line) and _distance(line[wide_last + 1], origin) <= 2 * half:
        wide_last += 1
        if _distance(line[wide_last], origin) <= half:
            last = wide_last
    tu, tv = line[last, 0] - line[first, 0], line[last, 1] - line[first, 1]
    length = math.hypot(tu, tv)
    frame = np.array([origin[0], origin[1], tu / length, tv / length])
    places = np.empty((len(line), 2))
    wide, wide_right = _moments(line, wide_first, wide_last, frame, places)
    behind, ahead = 0, 0
    for k in range(first, last + 1):
        if line[k, 2] > 0:
            behind += places[k, 0] < 0
            ahead += places[k, 0] > 0
    if min(behind, ahead) < _SHORTEST_ARM * correlation or min(behind, ahead) < 3:
        return result
    normal, right = _moments(line, first, last, frame, places)
    bend_covariance = np.linalg.inv(wide)
    bend = np.sum(bend_covariance[2] * wide_right)
    determinant = normal[0, 0] * normal[1, 1] - normal[0, 1] ** 2
    flat = right[:2] - bend * normal[:2, 2]  # what is left for the straight line a + b·x
    a = (normal[1, 1] * flat[0] - normal[0, 1] * flat[1]) / determinant
    b = (normal[0, 0] * flat[1] - normal[0, 1] * flat[0]) / determinant
    lever = (normal[1, 1] * normal[0, 2] - normal[0, 1] * normal[1, 2]) / determinant  # −∂a/∂c
    variance = normal[1, 1] / determinant + lever * lever * bend_covariance[2, 2]
    # points within one correlation length share their error; a fit is never better than all its weight allows
    sigma = math.sqrt(variance * max(correlation, 1.0))
    result[:] = np.array([1.0, frame[2], frame[3], a, b, bend, sigma, 1.0 if abs(bend * lever) > sigma else 0.0])
    return result


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
