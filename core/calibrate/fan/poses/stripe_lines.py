"""The straight lines among a picture's centrelines: on a flat target a plane of light is one straight line of rays.

A stripe that leaves the target for the table behind it goes on along another line, a reflection or the edge of a
mark is a line of its own: all of them come out, longest first, and :mod:`core.calibrate.fan.poses.line_assignment`
decides by all poses together which of them the fan drew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.reprojection import ray_changes
from core.image.stripes.centreline import Centreline
from core.model import Camera
from core.model.arrays import Array
from core.model.robust import Schedule, Weigh, irls, mad_sd

CHUNK = 24
"""Neighbouring points judged as one piece: longer than any speckle grain, shorter than any stripe of use."""
CHUNK_IN_CORRELATIONS = 2.4
"""Correlation lengths in a piece of a short line: points of narrow stripes tell as much in fewer px."""
SHORTEST_CHUNK = 10
"""Points that a piece has at least."""
CHUNKS = 3
"""A line with fewer points than in so many is not used."""
SEEDS = 48
"""A line is searched for through any two of this many chunks."""
STRAIGHT_PX = 1.5
"""How far in pixels a chunk may be off its line when lines are searched for."""
_WEIGHTS = Schedule(9, huber_at=2.0)
"""Of reweighting: points further than this many standard deviations from their line lose weight."""
REJECT = 4.0
"""Points further than this many standard deviations from their line are not on it."""


@dataclass(frozen=True, eq=False, slots=True)
class StripeLine:
    """Straight line of rays with its uncertainty.

    A straight-line fit to many points weighs exactly as two points one standard deviation of the spread either side
    of the centroid, each with half of all weight. `pivots` (2, 3) are these two rays and `sigma` is the standard
    uncertainty of each across the line, in ray units (mm per mm of depth), from the scatter of the data, grain of
    the speckle included; `noise` is that of a single point, as it was stated (RMS). `across` (2,) is the unit
    normal of the line in (x, y). `rays` (N, 3) are all its points,
    `uv` (N, 2) where they were seen in pixels. `saturated` is the share of points whose section is saturated.
    `moments` (3, N) are the weights with which the points' offsets across the line give its offset, slope and bend, in
    standard deviations of the spread: of these a straight line has but the first two, and `bend` in ray units is what
    it leaves of the third. `by_camera` (3, 10) tells how far the two pivots and the bend move across the line per unit
    of each camera parameter, the pixels the same.
    """

    pivots: Array
    sigma: float
    across: Array
    rays: Array
    uv: Array
    saturated: float
    moments: Array
    bend: float
    by_camera: Array
    noise: float

    def __len__(self) -> int:
        return len(self.rays)


def straight_lines(centrelines: Sequence[Centreline], camera: Camera, limit: int = 12) -> tuple[StripeLine, ...]:
    """Find the straight lines among `centrelines`, the one with most points first, at most `limit`.

    Saturated points are left out of a line as long as half of it remains without them.
    """
    length = chunk_length(centrelines)
    chunks, shortest = _chunks(centrelines, camera, length), CHUNKS * length
    lines: list[StripeLine] = []
    while len(lines) < limit and chunks.total >= shortest:
        members = chunks.largest_line(STRAIGHT_PX / camera.focal)
        if members is None or chunks.counts[members].sum() < shortest:
            break
        line = _fit(chunks, members, camera, shortest)
        if line is not None:
            lines.append(line)
        chunks = chunks.without(members)
    return tuple(sorted(lines, key=len, reverse=True))


def chunk_length(centrelines: Sequence[Centreline]) -> int:
    """Choose how many neighbouring points of a stripe are judged as one piece; fewer where there are few points."""
    if sum(map(len, centrelines)) >= CHUNKS * CHUNK:
        return CHUNK
    correlation = min((line.correlation_px for line in centrelines), default=np.inf)
    return int(np.clip(np.rint(CHUNK_IN_CORRELATIONS * correlation), SHORTEST_CHUNK, CHUNK))


@dataclass(frozen=True, eq=False, slots=True)
class _Chunks:
    """Runs of neighbouring points: their points, and for each run its centroid and direction in (x, y)."""

    xy: Array
    uv: Array
    sigma: Array
    saturated: NDArray[np.bool_]
    owner: NDArray[np.intp]
    centres: Array
    directions: Array
    counts: NDArray[np.intp]

    @property
    def total(self) -> int:
        return int(self.counts.sum())

    def largest_line(self, tolerance: float) -> NDArray[np.intp] | None:
        """Indices of the chunks on the line through two chunks that holds most points; None without two."""
        live = np.flatnonzero(self.counts > 0)
        if len(live) < 2:
            return None
        centres, directions = self.centres[live], self.directions[live]
        seeds = np.unique(np.linspace(0, len(live) - 1, SEEDS).astype(np.intp))
        first, second = (seeds[index] for index in np.triu_indices(len(seeds), 1))
        along = centres[second] - centres[first]
        along /= np.maximum(np.linalg.norm(along, axis=1), 1e-12)[:, None]
        agree = (np.abs(_dot(along, directions[first])) > 0.99) & (np.abs(_dot(along, directions[second])) > 0.99)
        first, along = first[agree], along[agree]
        if len(first) == 0:
            return None
        across = np.column_stack([-along[:, 1], along[:, 0]])
        off = np.abs(across @ centres.T - _dot(across, centres[first])[:, None])
        near = (off < tolerance) & (np.abs(along @ directions.T) > 0.98)
        best = int(np.argmax(near @ self.counts[live]))
        members: NDArray[np.intp] = live[near[best]]
        return members

    def without(self, members: NDArray[np.intp]) -> _Chunks:
        """The same with some chunks emptied."""
        counts = self.counts.copy()
        counts[members] = 0
        return _Chunks(self.xy, self.uv, self.sigma, self.saturated, self.owner, self.centres, self.directions, counts)


def _chunks(centrelines: Sequence[Centreline], camera: Camera, length: int) -> _Chunks:
    """Cut centrelines into chunks of about so many points; centrelines shorter than half a chunk are dropped."""
    pieces = [
        line.select(slice(places[0], places[-1] + 1))
        for line in centrelines
        if 2 * len(line) >= length
        for places in np.array_split(np.arange(len(line)), max(1, round(len(line) / length)))
    ]
    counts = np.array([len(piece) for piece in pieces], dtype=np.intp)
    if not pieces:
        empty = np.zeros((0, 2))
        nothing = np.zeros(0, dtype=np.intp)
        return _Chunks(empty, empty, empty[:, 0], nothing.astype(bool), nothing, empty, empty, counts)
    uv = np.vstack([piece.uv for piece in pieces])
    rays = camera.rays(uv)
    to_rays = camera.ray_jacobian(rays)
    normal = np.vstack([piece.normal for piece in pieces])
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    along = np.einsum("nij,nj->ni", to_rays, tangent)
    # a step across the stripe, seen across the line of rays: the area of the parallelogram over its base
    scale = np.abs(np.linalg.det(to_rays)) / np.linalg.norm(along, axis=1)
    owner = np.repeat(np.arange(len(pieces)), counts)
    xy = rays[:, :2]
    centres = np.column_stack([np.bincount(owner, xy[:, axis]) for axis in range(2)]) / counts[:, None]
    spread = xy - centres[owner]
    xx, yy, cross = (np.bincount(owner, v) for v in (spread[:, 0] ** 2, spread[:, 1] ** 2, spread[:, 0] * spread[:, 1]))
    angle = 0.5 * np.arctan2(2 * cross, xx - yy)
    directions = np.column_stack([np.cos(angle), np.sin(angle)])
    sigma = np.concatenate([piece.sigma for piece in pieces]) * scale
    saturated = np.concatenate([piece.saturated for piece in pieces])
    return _Chunks(xy, uv, sigma, saturated, owner, centres, directions, counts)


def _fit(chunks: _Chunks, members: NDArray[np.intp], camera: Camera, shortest: int) -> StripeLine | None:
    """Robust straight line through the points of some chunks; None if fewer than `shortest` agree."""
    chosen = np.flatnonzero(np.isin(chunks.owner, members))
    saturated = float(chunks.saturated[chosen].mean())
    if saturated <= 0.5:
        chosen = chosen[~chunks.saturated[chosen]]
    xy, uv = chunks.xy[chosen], chunks.uv[chosen]
    # a floor keeps a few points that claim to be perfect from ruling the line
    sigma = np.maximum(chunks.sigma[chosen], 0.3 * np.median(chunks.sigma[chosen]))

    def scaled_by(weight: Array) -> Array:
        """Distances from the line by these weights, in their standard deviations."""
        centre, along, _ = _moments(xy, weight)
        off = (xy - centre) @ np.array([-along[1], along[0]])
        return np.asarray(off / (sigma * max(mad_sd(off / sigma), 1e-9)))

    def improve(scaled: Array, weigh: Weigh) -> Array:
        return scaled_by(weigh(scaled) / sigma**2)

    good = np.abs(irls(scaled_by(1 / sigma**2), improve, _WEIGHTS)) < REJECT
    if good.sum() < shortest:
        return None
    xy, uv, sigma, owner = xy[good], uv[good], sigma[good], chunks.owner[chosen][good]
    weight = 1 / sigma**2
    centre, along, spread = _moments(xy, weight)
    across = np.array([-along[1], along[0]])
    pivots = np.column_stack([centre + np.outer([-spread, spread], along), np.ones(2)])
    sigma_of_pivots = float(np.sqrt(2 * _mean_variance((xy - centre) @ across, weight, owner)))
    rays = np.column_stack([xy, np.ones(len(xy))])
    shifts = np.einsum("i,nij->nj", across, ray_changes(camera, rays))
    moments = _offset_slope_and_bend((xy - centre) @ along / spread, weight)
    moved, turned, bent = moments @ shifts
    by_camera = np.array([moved - turned, moved + turned, bent])
    bend = float(moments[2] @ ((xy - centre) @ across))
    noise = float(np.sqrt(np.mean(sigma**2)))
    return StripeLine(pivots, sigma_of_pivots, across, rays, uv, saturated, moments, bend, by_camera, noise)


def _offset_slope_and_bend(t: Array, weight: Array) -> Array:
    """Rows (3, N) that give the coefficients of the orthonormal polynomials 1, t, q(t) of what is on them.

    `t` (N,) has the weighted mean 0 and variance 1.
    """
    share = weight / weight.sum()
    q = t**2 - 1 - (share @ t**3) * t
    q /= np.sqrt(share @ q**2)
    return np.asarray(share * np.array([np.ones_like(t), t, q]))


def _moments(xy: Array, weight: Array) -> tuple[Array, Array, float]:
    """Weighted centroid (2,), direction (2,) and standard deviation along it of points (N, 2)."""
    centre = weight @ xy / weight.sum()
    spread = xy - centre
    values, vectors = np.linalg.eigh((spread * weight[:, None]).T @ spread / weight.sum())
    return centre, vectors[:, 1], float(np.sqrt(values[1]))


def _mean_variance(off: Array, weight: Array, owner: NDArray[np.intp]) -> float:
    """Variance of the weighted mean of `off` (N,), from the scatter of chunk sums, which neighbours' correlation is in.

    Never below what independent points of that scatter would give.
    """
    total = float(weight.sum())
    independent = float((weight**2) @ off**2) / total**2
    sums = np.bincount(owner, weight * off)
    chunks = int((np.bincount(owner) > 0).sum())
    by_chunk = float(sums @ sums) / total**2 * chunks / max(chunks - 2, 1)
    return max(by_chunk, independent)


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("ij,ij->i", a, b), dtype=np.float64)
