"""Error common to the fan's own points and the light planes of the sweeps: the fan's static speckle.

The fan stands still, so one picture of its speckle is in every crossing with it and in its own points. The network
calls the errors of the fan's centrelines z, standard normal, one for each cell of 40 px
(`core.scan.network.line_errors`). What it says of the sweeps is then correlated with z, and the fan's own points depend
on the same z by how they were averaged along their line (`core.image.stripes.lines.smoothing`): a parabola over a
window, linear in the line's errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.image.stripes.centreline import Centreline
from core.image.stripes.runs import arc_length
from core.model import Camera, LightPlane
from core.model.arrays import Array, frozen_array, set_field
from core.scan.features.crossings import Index
from core.scan.features.straightening import straightened

SAME_PX = 0.05
"""Two points of the fan this near to each other in the picture are one: points are a pixel apart."""

_WINDOW_OF_MEAN = 9 / 8
"""Half the window of a parabola over the length of a mean that is as sure: its variance in the middle is 9/4 of a
mean's."""
_END_SHARE = 0.3
"""Share of its half length that a smoothing window keeps at an end of the line, as in
`core.image.stripes.lines.smoothing`."""
_SHORTEST_PX = 2.5
"""Half length in px of the shortest window: five points."""
_SINGULAR = 1e-6
"""Determinant of the moments relative to their size below which a window holds too few points for a parabola."""


@dataclass(frozen=True, eq=False, slots=True)
class FanSpeckle:
    """The N points of the fan's numbered centrelines, and how errors of these lines' F cells move them in depth.

    Parameters
    ----------
    uv
        (N, 2) in pixels.
    cell
        (N,) the cell each point lies in, from 0 through all centrelines.
    members
        (F,) how many points each cell has.
    first, shares
        Point p is off in depth by Σ_k shares[p, k]·z[first[p] + k] mm; (N,) and (N, K).
    covariance
        (3S, F) of the errors of the sweeps' stacked π in 1/mm with z.
    """

    uv: Array
    cell: Index
    members: Index
    first: Index
    shares: Array
    covariance: Array

    def __post_init__(self) -> None:
        count, cells = len(self.cell), len(self.members)
        for name, shape in (("uv", (count, 2)), ("shares", (count, None)), ("covariance", (None, cells))):
            set_field(self, name, frozen_array(getattr(self, name), shape, name))
        for name, size in (("cell", count), ("first", count), ("members", cells)):
            index = np.array(getattr(self, name), dtype=np.int64).reshape(size)
            index.flags.writeable = False
            set_field(self, name, index)

    def places(self, uv: Array) -> Index:
        """Find for pixels `uv` (M, 2) the indices (M,) of the fan's points seen there; −1 for none."""
        if not len(self.uv) or not len(uv):
            return np.full(len(uv), -1, dtype=np.int64)
        distance, place = cKDTree(self.uv).query(uv)
        return np.where(distance < SAME_PX, place, -1).astype(np.int64)


def fan_speckle(
    pieces: Sequence[Centreline],
    planes: Sequence[LightPlane | None],
    camera: Camera,
    cell_px: float,
    cells: Index,
    covariance: Array,
) -> FanSpeckle:
    """Compute how errors of the cells of the fan's centrelines move the fan's points in depth.

    Parameters
    ----------
    pieces
        The fan's centrelines, averaged along themselves.
    planes
        The light plane of each; None where it is not known.
    camera
        Cells are measured along centrelines freed of its distortion.
    cell_px
        Length of a cell.
    cells, covariance
        (F', 2) and (3S, F') as of `core.scan.network.adjustment.Network`.
    """
    parts: list[tuple[Array, Index, Index, Array]] = []
    column = {}
    count, members = 0, []
    for number, (piece, plane) in enumerate(zip(pieces, planes, strict=True)):
        if plane is None or not len(piece):
            continue
        straight = straightened((piece,), camera)[0]
        arc = arc_length(straight.uv)
        cell = np.floor(arc / cell_px).astype(np.int64)
        first, shares = _shares(arc, cell, piece.sigma, _WINDOW_OF_MEAN * piece.correlation_px)
        parts.append((piece.uv, cell + count, first + count, shares * _depth_per_px(piece, plane, camera)[:, None]))
        members.append(np.bincount(cell))
        column.update({(number, int(k)): count + int(k) for k in range(len(members[-1]))})
        count += len(members[-1])
    of_all = np.zeros((len(covariance), count))
    for place, key in enumerate(map(tuple, cells.tolist())):
        if key in column:
            of_all[:, column[key]] = covariance[:, place]
    if not parts:
        empty = np.zeros(0, dtype=np.int64)
        return FanSpeckle(np.zeros((0, 2)), empty, empty, empty, np.zeros((0, 0)), of_all)
    widest = max(shares.shape[1] for *_, shares in parts)
    return FanSpeckle(
        np.concatenate([uv for uv, *_ in parts]),
        np.concatenate([cell for _, cell, *_ in parts]),
        np.concatenate(members),
        np.concatenate([first for _, _, first, _ in parts]),
        np.concatenate([np.pad(shares, ((0, 0), (0, widest - shares.shape[1]))) for *_, shares in parts]),
        of_all,
    )


def _shares(arc: Array, cell: Index, sigma: Array, half: float) -> tuple[Index, Array]:
    """First cell (N,) and shares (N, K) in px of the cells' z in each point of a line.

    A point is the value at itself of the parabola through all within `half` px along the line, of points as noisy as
    itself; a cell's z is the mean of its points over that mean's standard deviation.
    """
    count = len(arc)
    room = np.minimum(arc - arc[0], arc[-1] - arc)
    half_at = np.clip(room / _END_SHARE, min(_SHORTEST_PX, half), half)
    spacing = max(arc[-1] / max(count - 1, 1), 1e-9)
    reach = int(np.ceil(half / spacing)) + 1
    at = np.arange(count)[:, None] + np.arange(-reach, reach + 1)
    inside = (at >= 0) & (at < count)
    at = np.clip(at, 0, count - 1)
    t = (arc[at] - arc[:, None]) / half_at[:, None]
    inside &= np.abs(t) <= 1
    weight = _at_middle(np.where(inside, t, 0.0), inside)
    first = cell[np.argmax(inside, axis=1) + np.arange(count) - reach]
    shares = np.zeros((count, int((cell[at] - first[:, None])[inside].max(initial=0)) + 1))
    rows = np.broadcast_to(np.arange(count)[:, None], at.shape)
    np.add.at(shares, (rows[inside], (cell[at] - first[:, None])[inside]), weight[inside])
    own = sigma / np.sqrt((weight**2).sum(axis=1))
    of_cell = np.maximum(np.bincount(cell), 1)[np.minimum(first[:, None] + np.arange(shares.shape[1]), cell.max())]
    return first, shares * own[:, None] / np.sqrt(of_cell)


def _at_middle(t: Array, inside: NDArray[np.bool_]) -> Array:
    """Weights (N, W) of values at `t` (N, W) in the parabola's value at t = 0; of the mean where there are too few."""
    moments = np.stack([(inside * t**power).sum(axis=1) for power in range(5)])
    matrix = moments[np.add.outer(np.arange(3), np.arange(3))].transpose(2, 0, 1)
    few = np.linalg.det(matrix) < _SINGULAR * moments[0] ** 3
    matrix[few] = np.eye(3)
    coefficients = np.linalg.inv(matrix)[:, 0, :]
    weight = inside * np.einsum("nk,knw->nw", coefficients, np.stack([t**0, t, t**2]))
    return np.asarray(np.where(few[:, None], inside / moments[0][:, None], weight))


def _depth_per_px(piece: Centreline, plane: LightPlane, camera: Camera) -> Array:
    """∂z/∂(offset along the normal), (N,) in mm/px, of each point on the plane: 1/z = π·r."""
    rays = camera.rays(piece.uv)
    slope = camera.inverse_depth_slopes(plane.pi, rays, piece.normal)
    inverse_depth = rays @ plane.pi
    return np.asarray(-slope / np.where(np.abs(inverse_depth) > 1e-9, inverse_depth, np.inf) ** 2)
