"""All crossings of a scan, as arrays: where a sweep's centreline meets the fan's or another sweep's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.image.crossing import Crossing, cross_centrelines
from core.image.shading import shading_sigma
from core.model.arrays import Array, set_field
from core.progress import Progress, silent, steps

Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class CrossingTable:
    """M crossings, one a row; a is the sweep, b the fan or the later sweep.

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
        (M,) which centreline of that frame (of the reference, for the fan).
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
        """True where b is the fan."""
        return self.b < 0

    def select(self, keep: NDArray[np.bool_] | Index) -> CrossingTable:
        """The rows that `keep` selects."""
        arrays = {f.name: getattr(self, f.name)[keep] for f in fields(self) if f.name != "half_length_px"}
        return CrossingTable(**arrays, half_length_px=self.half_length_px)

    def renumber(self, number: Index) -> CrossingTable:
        """The same crossings with frame i called `number[i]`; the fan stays −1."""
        b = np.where(self.with_fan, -1, number[np.maximum(self.b, 0)])
        return replace(self, a=number[self.a], b=b)

    def swapped(self) -> CrossingTable:
        """The same crossings with a called b and b called a."""
        pairs = ("tangent", "sigma", "piece", "along", "cell", "share")
        turned = {f"{name}_{to}": getattr(self, f"{name}_{of}") for name in pairs for to, of in ("ab", "ba")}
        return replace(self, a=self.b, b=self.a, **turned)

    def followed_by(self, *others: CrossingTable) -> CrossingTable:
        """The rows of this table and then of the `others`."""
        names = [f.name for f in fields(self) if f.name != "half_length_px"]
        tables = (self, *others)
        joined = {name: np.concatenate([getattr(table, name) for table in tables]) for name in names}
        return CrossingTable(**joined, half_length_px=self.half_length_px)


@dataclass(frozen=True, slots=True)
class CrossingWindow:
    """How crossings are fitted: half the length of the local fit in pixels, smallest angle (rad) accepted."""

    half_length_px: float = 40.0
    min_angle: float = float(np.deg2rad(15.0))


def all_crossings(
    fan: Sequence[Centreline],
    sweeps: Sequence[Sequence[Centreline]],
    window: CrossingWindow,
    progress: Progress = silent,
) -> CrossingTable:
    """Every crossing of each sweep with the fan and with each later sweep."""
    rows: list[Meeting] = []
    stripes = [shaded(pieces) for pieces in sweeps]
    fixed = shaded(fan)
    for a, pieces in steps(enumerate(stripes), progress, "crossings", len(sweeps)):
        rows.extend(meetings(pieces, fixed, a, -1, window))
        for b in range(a + 1, len(sweeps)):
            rows.extend(meetings(pieces, stripes[b], a, b, window))
    return crossing_table(rows, window)


@dataclass(frozen=True, eq=False, slots=True)
class ShadedLines:
    """The centrelines of one picture, with what uneven brightness adds to their σ, and the length along them."""

    pieces: Sequence[Centreline]
    shading: Sequence[Array]
    arc: Sequence[Array]


def shaded(pieces: Sequence[Centreline]) -> ShadedLines:
    """Centrelines made ready to be crossed with many others."""
    arcs = [np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(p.uv, axis=0), axis=1))]) for p in pieces]
    return ShadedLines(pieces, [shading_sigma(piece) for piece in pieces], arcs)


@dataclass(frozen=True, eq=False, slots=True)
class Meeting:
    """One crossing: (a, b, piece of a, piece of b); where along, and the σ of, each centreline."""

    index: tuple[int, int, int, int]
    along: tuple[float, float]
    sigma: tuple[float, float]
    crossing: Crossing


def meetings(of_a: ShadedLines, of_b: ShadedLines, a: int, b: int, window: CrossingWindow) -> list[Meeting]:
    """The crossings of one picture's centrelines with another's, which are called frame `a` and frame `b`."""
    found = cross_centrelines(
        of_a.pieces, of_b.pieces, half_length_px=window.half_length_px, min_angle=window.min_angle
    )
    return meetings_at(found, of_a, of_b, a, b)


def meetings_at(
    found: Sequence[tuple[int, int, Crossing]], of_a: ShadedLines, of_b: ShadedLines, a: int, b: int
) -> list[Meeting]:
    """Crossings (piece of a, piece of b, crossing) that were `found` by a search, with what the table wants of them."""
    rows = []
    for i, j, crossing in found:
        at_a, at_b = _nearest(of_a.pieces[i], crossing.uv), _nearest(of_b.pieces[j], crossing.uv)
        rows.append(
            Meeting(
                (a, b, i, j),
                (float(of_a.arc[i][at_a]), float(of_b.arc[j][at_b])),
                (
                    float(np.hypot(crossing.sigma_a, of_a.shading[i][at_a])),
                    float(np.hypot(crossing.sigma_b, of_b.shading[j][at_b])),
                ),
                crossing,
            )
        )
    return rows


def _nearest(piece: Centreline, uv: Array) -> int:
    return int(np.argmin(np.sum((piece.uv - uv) ** 2, axis=1)))


def crossing_table(rows: Sequence[Meeting], window: CrossingWindow) -> CrossingTable:
    """The crossings as arrays, in their order."""

    def vectors(name: str) -> Array:
        return np.array([getattr(row.crossing, name) for row in rows], dtype=np.float64).reshape(-1, 2)

    index = np.array([row.index for row in rows], dtype=np.int64).reshape(-1, 4)
    along = np.array([row.along for row in rows], dtype=np.float64).reshape(-1, 2)
    sigma = np.array([row.sigma for row in rows], dtype=np.float64).reshape(-1, 2)
    return CrossingTable(
        uv=vectors("uv"),
        tangent_a=vectors("tangent_a"),
        tangent_b=vectors("tangent_b"),
        sigma_a=sigma[:, 0],
        sigma_b=sigma[:, 1],
        a=index[:, 0],
        b=index[:, 1],
        piece_a=index[:, 2],
        piece_b=index[:, 3],
        along_a=along[:, 0],
        along_b=along[:, 1],
        half_length_px=window.half_length_px,
    )
