"""Correlated errors of the crossings on one centreline.

A crossing's place on a line is a fit to a stretch of it, so crossings closer together than that share their error, and
a hundred crossings on one stretch are no better than a few. What is common to them are the errors of the line's cells,
see `core.scan.features.crossings.CrossingTable`: standard normal numbers z, of which each crossing takes up some
shares.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from core.model.arrays import Array
from core.scan.features.crossings import CrossingTable, Index

SIGMA_FLOOR_PX = 0.01
"""Standard uncertainty in px of a centreline at least: the phase error of a plain filter at its worst (a stripe of σ
1.5 px), so that no crossing outweighs all others."""

_MOST_CELLS, _MOST_PIECES = 1_000_000, 10_000
"""Factors by which frame, piece and cell are packed into one integer: larger than any of them can be."""


@dataclass(frozen=True, eq=False, slots=True)
class LineErrors:
    """Errors in px of the centrelines at M crossings: shares of errors common to a cell, and an independent rest.

    Once in the network's equations they count along the normal (t_v, −t_u) of a line with the tangent t, that of
    `core.image.stripes.centreline.Centreline`; as all are symmetric about 0, the sign of z is there for the taking.

    Parameters
    ----------
    sigma_a, sigma_b
        (M,) whole standard uncertainty.
    fan
        (M, F) shares that the fan's F cells have in the error of b; empty rows for crossings between sweeps.
    sweep_a, sweep_b
        (M, Q) shares of the sweeps' Q cells in the errors of a, and of b where b is a sweep.
    rest_a, rest_b
        (M,) variance of the independent rest, in px².
    fan_cells
        (F, 2) which centreline of the fan each of its cells is on, and which cell along it.
    sweep_cells
        (Q, 3) which sweep each of theirs is of, on which of its centrelines, and which cell along it.
    """

    sigma_a: Array
    sigma_b: Array
    fan: csr_array
    sweep_a: csr_array
    sweep_b: csr_array
    rest_a: Array
    rest_b: Array
    fan_cells: Index
    sweep_cells: Index

    @classmethod
    def of(cls, crossings: CrossingTable) -> LineErrors:
        """Make the errors of the lines at crossings from their table.

        Where it states no shares of cells, they are those of a mean over `half_length_px` to each side.
        """
        ends = (
            _End.known(
                crossings.a,
                crossings.piece_a,
                crossings.along_a,
                crossings.sigma_a,
                crossings.cell_a,
                crossings.share_a,
                crossings.half_length_px,
            ),
            _End.known(
                crossings.b,
                crossings.piece_b,
                crossings.along_b,
                crossings.sigma_b,
                crossings.cell_b,
                crossings.share_b,
                crossings.half_length_px,
            ),
        )
        a, b = ends
        count, width = len(crossings), b.shares.shape[1]
        of_fan = np.repeat(crossings.with_fan & ~crossings.on_plane, width)
        of_b = np.repeat(~crossings.with_fan, width)
        rows = np.concatenate([a.rows, b.rows[of_b]])
        cells, fan_cells = np.concatenate([a.keys, b.keys[of_b]]), b.keys[of_fan]
        shares = np.concatenate([a.shares.ravel(), b.shares.ravel()[of_b]])
        of_a = np.arange(len(rows)) < len(a.rows)
        names, column = np.unique(cells, return_inverse=True)

        def matrix(mine: NDArray[np.bool_]) -> csr_array:
            return csr_array((shares[mine], (rows[mine], column[mine])), shape=(count, len(names)))

        fan_names, fan_column = np.unique(fan_cells, return_inverse=True)
        fan = csr_array((b.shares.ravel()[of_fan], (b.rows[of_fan], fan_column)), shape=(count, len(fan_names)))
        return cls(
            a.sigma,
            np.where(crossings.on_plane, 0.0, b.sigma),
            fan,
            matrix(of_a),
            matrix(~of_a),
            a.rest,
            np.where(crossings.on_plane, 0.0, b.rest),
            fan_cells=_unnamed(fan_names)[:, 1:],
            sweep_cells=_unnamed(names),
        )


@dataclass(frozen=True, eq=False, slots=True)
class _End:
    """One side, a or b, of all crossings: `rows` and `keys` (M·K,) of its (M, K) `shares`."""

    sigma: Array
    shares: Array
    rest: Array
    rows: Index
    keys: Index

    @classmethod
    def known(
        cls, frame: Index, piece: Index, along: Array, sigma: Array, cell: Index, share: Array, length: float
    ) -> _End:
        sigma = np.maximum(sigma, SIGMA_FLOOR_PX)
        if not share.shape[1]:
            cell, share = _window(along, sigma, length)
        wide = share.shape[1]
        shared = np.sum(share**2, axis=1)
        share = share * np.sqrt(np.minimum(1.0, sigma**2 / np.maximum(shared, 1e-300)))[:, None]
        rest = sigma**2 - np.minimum(shared, sigma**2)
        line = (frame + 1) * _MOST_PIECES + piece
        keys = line[:, None] * _MOST_CELLS + cell[:, None] + np.arange(wide)
        return cls(sigma, share, rest, np.repeat(np.arange(len(along)), wide), keys.ravel())


def _unnamed(names: Index) -> Index:
    """Frame, piece and cell (N, 3) of each name, as `_End.known` makes them; a first cell may be −1."""
    line = (names + _MOST_CELLS // 2) // _MOST_CELLS
    return np.column_stack([line // _MOST_PIECES - 1, line % _MOST_PIECES, names - line * _MOST_CELLS])


def _window(along: Array, sigma: Array, length: float) -> tuple[Index, Array]:
    """First cell (M,) and shares (M, 3) of a mean over ± `length` of a line."""
    first = np.floor(along / length).astype(np.int64) - 1
    inside = along / length - np.floor(along / length)
    return first, sigma[:, None] / np.sqrt(2) * np.column_stack([1 - inside, np.ones(len(along)), inside])
