"""Crossings as arrays: where a sweep's centreline meets the fan's or another sweep's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from core.image.crossings.crossing import HALF_LENGTH_PX, LEAST_ANGLE, Crossing, cross_centrelines
from core.image.crossings.segments import CELLS, Stack
from core.image.stripes.centreline import Centreline
from core.image.stripes.shading import shading_sigma
from core.model.arrays import Array, set_field

Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class CrossingTable:
    """Table of M crossings of centrelines, one a row; a is a sweep, b the fan or a later sweep.

    Parameters
    ----------
    uv
        (M, 2) in pixels.
    tangent_a, tangent_b
        (M, 2) unit tangents of the two centrelines.
    sigma_a, sigma_b
        (M,) standard uncertainty of each centreline across itself, in pixels, after the local fit.
    a, b
        (M,) index of the frame of each; b is −1 for the fan.
    piece_a, piece_b
        (M,) which centreline of that frame (of the reference, for the fan); −1 in place of the fan's for a point of a
        sweep on a known plane: b is then any exact line there, square to a.
    along_a, along_b
        (M,) where on that centreline, as length along it from its first point, in pixels.
    half_length_px
        Length of a cell, see below.
    cell_a, cell_b
        (M,) the first cell of each centreline that the local fit rests on.
    share_a, share_b
        (M, K) how the errors of crossings on one centreline hang together, in pixels; K = 0 where that is not known.

    Notes
    -----
    A centreline (frame and piece, whether it is a or b) is cut along itself into cells: cell k reaches from
    k·half_length_px to (k + 1)·half_length_px, measured as `along`. Each cell has one error z, standard normal and
    independent of all others. A local fit that rests on the cells c … c + K − 1 is off across its line by ::

        ε_a = Σ_k share_a[:, k]·z[cell_a + k] + rest,    rest ~ N(0, sigma_a² − Σ_k share_a²), independent

    So the covariance of two crossings on one centreline is the sum over the cells they have in common, and `sigma` is
    the whole standard uncertainty of each. Positive is along (−t_v, t_u); tangents point the way `along` grows, so that
    is the same side all along a centreline.
    """

    uv: Array
    tangent_a: Array
    tangent_b: Array
    sigma_a: Array
    sigma_b: Array
    a: Index
    b: Index
    piece_a: Index
    piece_b: Index
    along_a: Array
    along_b: Array
    half_length_px: float
    cell_a: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    cell_b: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    share_a: Array = field(default_factory=lambda: np.zeros((0, 0)))
    share_b: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def __post_init__(self) -> None:
        count = len(self.a)
        for name in ("cell_a", "cell_b", "share_a", "share_b"):
            value = getattr(self, name)
            if len(value) != count and value.size == 0:
                set_field(self, name, np.zeros((count, *value.shape[1:]), value.dtype))

    def __len__(self) -> int:
        return len(self.a)

    @property
    def with_fan(self) -> NDArray[np.bool_]:
        """Mask (M,) of the crossings with the fan: b is the fan, not a later sweep."""
        return self.b < 0

    @property
    def on_plane(self) -> NDArray[np.bool_]:
        """Mask (M,) of those of the fan's rows that are no crossings but points on a known plane."""
        return (self.b < 0) & (self.piece_b < 0)

    def select(self, keep: NDArray[np.bool_] | Index) -> CrossingTable:
        """Select the crossings by a mask (M,), or by the numbers of their rows."""
        arrays = {f.name: getattr(self, f.name)[keep] for f in fields(self) if f.name != "half_length_px"}
        return CrossingTable(**arrays, half_length_px=self.half_length_px)

    def renumber(self, number: Index) -> CrossingTable:
        """Replace each frame index i in a and b by `number[i]` of `number` (F,); the fan stays −1."""
        b = np.where(self.with_fan, -1, number[np.maximum(self.b, 0)])
        return replace(self, a=number[self.a], b=b)

    def swapped(self) -> CrossingTable:
        """Exchange the two centrelines, a and b, of every crossing."""
        pairs = ("tangent", "sigma", "piece", "along", "cell", "share")
        turned = {f"{name}_{to}": getattr(self, f"{name}_{of}") for name in pairs for to, of in ("ab", "ba")}
        return replace(self, a=self.b, b=self.a, **turned)

    def followed_by(self, *others: CrossingTable) -> CrossingTable:
        """Append the crossings of the `others` to those of this table, in order."""
        names = [f.name for f in fields(self) if f.name != "half_length_px"]
        tables = (self, *others)
        joined = {name: np.concatenate([getattr(table, name) for table in tables]) for name in names}
        return CrossingTable(**joined, half_length_px=self.half_length_px)


@dataclass(frozen=True, slots=True)
class CrossingWindow:
    """Settings of the local fits at crossings: a third of their reach in px, and the smallest angle (rad) accepted."""

    half_length_px: float = HALF_LENGTH_PX
    min_angle: float = LEAST_ANGLE


@dataclass(frozen=True, eq=False, slots=True)
class ShadedLines:
    """Centrelines of one picture with the σ that uneven brightness adds, both prepared for crossing."""

    pieces: Sequence[Centreline]
    shading: Sequence[Array]
    stack: Stack


def shaded(pieces: Sequence[Centreline], window: CrossingWindow) -> ShadedLines:
    """Prepare one picture's centrelines for crossing with many others, with the σ that uneven brightness adds."""
    return ShadedLines(pieces, [shading_sigma(piece) for piece in pieces], Stack(pieces, window.half_length_px))


@dataclass(frozen=True, eq=False, slots=True)
class Meeting:
    """One crossing, with the frames and pieces (a, b, piece of a, piece of b) that meet and the σ in px of each."""

    index: tuple[int, int, int, int]
    sigma: tuple[float, float]
    crossing: Crossing


def meetings(of_a: ShadedLines, of_b: ShadedLines, a: int, b: int, window: CrossingWindow) -> list[Meeting]:
    """Find the crossings of one picture's centrelines, called frame `a`, with those of another, called frame `b`."""
    found = cross_centrelines(of_a.stack, of_b.stack, window.half_length_px, window.min_angle)
    return meetings_at(found, of_a, of_b, a, b)


def meetings_at(
    found: Sequence[tuple[int, int, Crossing]], of_a: ShadedLines, of_b: ShadedLines, a: int, b: int
) -> list[Meeting]:
    """Add frames `a`, `b` and the σ in px of each centreline to crossings `found`, as (piece of a, of b, crossing)."""
    rows = []
    for i, j, crossing in found:
        at_a, at_b = of_a.stack.point_at(i, crossing.along_a), of_b.stack.point_at(j, crossing.along_b)
        rows.append(
            Meeting(
                (a, b, i, j),
                (
                    float(np.hypot(crossing.sigma_a, of_a.shading[i][at_a])),
                    float(np.hypot(crossing.sigma_b, of_b.shading[j][at_b])),
                ),
                crossing,
            )
        )
    return rows


def crossing_table(rows: Sequence[Meeting], window: CrossingWindow) -> CrossingTable:
    """Collect single crossings, found with the fits of `window`, in one table, in their order."""

    def of_crossings(name: str, *shape: int) -> Array:
        return np.array([getattr(row.crossing, name) for row in rows], dtype=np.float64).reshape(-1, *shape)

    index = np.array([row.index for row in rows], dtype=np.int64).reshape(-1, 4)
    sigma = np.array([row.sigma for row in rows], dtype=np.float64).reshape(-1, 2)
    return CrossingTable(
        uv=of_crossings("uv", 2),
        tangent_a=of_crossings("tangent_a", 2),
        tangent_b=of_crossings("tangent_b", 2),
        sigma_a=sigma[:, 0],
        sigma_b=sigma[:, 1],
        a=index[:, 0],
        b=index[:, 1],
        piece_a=index[:, 2],
        piece_b=index[:, 3],
        along_a=of_crossings("along_a"),
        along_b=of_crossings("along_b"),
        half_length_px=window.half_length_px,
        cell_a=of_crossings("cell_a").astype(np.int64),
        cell_b=of_crossings("cell_b").astype(np.int64),
        share_a=of_crossings("share_a", CELLS),
        share_b=of_crossings("share_b", CELLS),
    )
