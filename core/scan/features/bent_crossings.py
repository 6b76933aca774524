"""Crossings on a surface that bends, where the averaged centrelines themselves meet.

Crossings are found by local fits over long windows (`core.image.crossings.crossing`), stiff enough to be of use on
flat faces. On
a bent surface such a fit cuts the corner: by less than its standard uncertainty, which counts that, but by the same on
all stripes, and a ball of 50 mm comes out 0.02 mm too small (half resolution). Centrelines averaged along themselves
(`core.image.stripes.lines.smoothing`) are held to a tenth of their own uncertainty there; where they meet is off by a
tenth of that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable, Index

ROUNDS = 4
"""Steps of Newton towards the place where two polylines meet; each starts within a px of it."""
FARTHEST = 4.0
"""Crossings that would move by more than so many standard uncertainties are left: lines that hardly meet."""

Name = tuple[int, int]
"""Frame (−1: the fan) and piece of a centreline."""


class BentLine(NamedTuple):
    """Centreline of N points, its arc length (N,) as crossings count it, and the mask (N,) of its points on a bend."""

    line: Centreline
    arc: Array
    bent: NDArray[np.bool_]


@dataclass(frozen=True, eq=False, slots=True)
class _End:
    """One end, a or b, of M crossings: the rows of each line."""

    rows: tuple[tuple[BentLine, Index], ...]
    tangent: Array

    def offsets(self, uv: Array, along: Array) -> tuple[Array, Array]:
        """How far (M,) the lines lie off `uv` (M, 2) along (t_v, −t_u), and where along them that is."""
        off, along = np.zeros(len(uv)), along.copy()
        for (line, arc, _), rows in self.rows:
            tangent = self.tangent[rows]
            normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
            for _ in range(2):
                away = _at(line.uv, arc, along[rows]) - uv[rows]
                along[rows] -= (away * tangent).sum(axis=1)
            off[rows] = ((_at(line.uv, arc, along[rows]) - uv[rows]) * normal).sum(axis=1)
        return off, along

    def sigma(self, along: Array) -> Array:
        """Standard uncertainty (M,) in px of the lines there."""
        sigma = np.zeros(len(along))
        for (line, arc, _), rows in self.rows:
            sigma[rows] = np.interp(along[rows], arc, line.sigma)
        return sigma


def crossed_again(table: CrossingTable, lines: Mapping[Name, BentLine]) -> CrossingTable:
    """Compute again, with σ, the crossings of which both centrelines lie on a bend there; the others stay."""
    bent = np.flatnonzero(_on_bend(table, "a", lines) & _on_bend(table, "b", lines))
    mine = table.select(bent)
    ends = [_End(tuple(_rows(mine, end, lines)), getattr(mine, f"tangent_{end}")) for end in "ab"]
    t_a, t_b = mine.tangent_a, mine.tangent_b
    sine = t_a[:, 0] * t_b[:, 1] - t_a[:, 1] * t_b[:, 0]
    uv, along = mine.uv.copy(), [mine.along_a, mine.along_b]
    for _ in range(ROUNDS):
        (off_a, along[0]), (off_b, along[1]) = (end.offsets(uv, where) for end, where in zip(ends, along, strict=True))
        uv += t_b * (off_a / -sine)[:, None] + t_a * (off_b / sine)[:, None]
    far = np.linalg.norm(uv - mine.uv, axis=1) * np.abs(sine)
    met = np.isfinite(far) & (far < FARTHEST * np.hypot(mine.sigma_a, mine.sigma_b) + 1.0)
    sigma_a, sigma_b = (end.sigma(where) for end, where in zip(ends, along, strict=True))
    return _with(table, bent[met], uv[met], sigma_a[met], sigma_b[met])


def _with(table: CrossingTable, rows: Index, uv: Array, sigma_a: Array, sigma_b: Array) -> CrossingTable:
    """The table with other places and σ in some rows; what crossings share grows and falls with their σ."""
    changed = {"uv": table.uv.copy()}
    changed["uv"][rows] = uv
    for end, sigma in (("a", sigma_a), ("b", sigma_b)):
        all_sigma, share = getattr(table, f"sigma_{end}").copy(), getattr(table, f"share_{end}").copy()
        share[rows] *= (sigma / np.maximum(all_sigma[rows], 1e-12))[:, None]
        all_sigma[rows] = sigma
        changed |= {f"sigma_{end}": all_sigma, f"share_{end}": share}
    return replace(table, **changed)  # type: ignore[arg-type]


def _rows(table: CrossingTable, end: str, lines: Mapping[Name, BentLine]) -> Iterator[tuple[BentLine, Index]]:
    """The rows of each of `lines` that crossings have as their `end`."""
    frame, piece = getattr(table, end), getattr(table, f"piece_{end}")
    order = np.lexsort((piece, frame))
    cuts = np.flatnonzero((np.diff(frame[order]) != 0) | (np.diff(piece[order]) != 0)) + 1
    for rows in np.split(order, cuts):
        line = lines.get((int(frame[rows[0]]), int(piece[rows[0]]))) if len(rows) else None
        if line is not None:
            yield line, rows


def _on_bend(table: CrossingTable, end: str, lines: Mapping[Name, BentLine]) -> NDArray[np.bool_]:
    """Which crossings (M,) lie on a bend of the line at their `end`."""
    on = np.zeros(len(table), dtype=np.bool_)
    for (_, arc, bent), rows in _rows(table, end, lines):
        nearest = np.minimum(np.searchsorted(arc, getattr(table, f"along_{end}")[rows]), len(arc) - 1)
        on[rows] = bent[nearest]
    return on


def _at(uv: Array, arc: Array, along: Array) -> Array:
    return np.column_stack([np.interp(along, arc, uv[:, k]) for k in range(2)])
