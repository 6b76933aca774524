"""Laser speckle: a grainy factor of mean 1 on the light of a coherent source.

Log-normal with a Gaussian correlation of given grain. One periodic tile holds the pattern; each picture looks at it
from its own place and side, which costs nothing and gives independent grains wherever there is light.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from core.simulate.rays import Map

LEAST_LIGHT = 0.02
"""Grey levels below which laser light gets no speckle: far below what a picture resolves."""
TILE = 1024
"""Side in px of the tile of speckle: a million places, eight ways round, so that pictures hardly repeat."""


class Speckle:
    """Tile of speckle, and views of it.

    Parameters
    ----------
    contrast
        Standard deviation over mean, as one pixel sees it.
    grain_px
        1/e half-width of the correlation of the underlying field, in pixels.
    rng
        Fills the tile.
    """

    def __init__(self, contrast: float, grain_px: float, rng: np.random.Generator) -> None:
        field = rng.standard_normal((TILE, TILE), dtype=np.float32)
        pad = int(np.ceil(4 * grain_px))
        smooth = cv2.GaussianBlur(np.pad(field, pad, mode="wrap"), (0, 0), grain_px / 2)[pad:-pad, pad:-pad]
        smooth = (smooth - smooth.mean()) / smooth.std()
        spread = np.sqrt(np.log1p(contrast**2))
        self._tile: Map = np.exp(spread * smooth - spread**2 / 2).astype(np.float32)

    def at(self, rows: NDArray[np.intp], columns: NDArray[np.intp], rng: np.random.Generator) -> Map:
        """Return the speckle's factors (N,) on the light at pixels `rows`, `columns` (N,) of one picture.

        `rng` chooses its place in the tile.
        """
        down, right = rng.integers(0, TILE, 2)
        flip, mirror, turn = rng.integers(0, 2, 3)
        i = (down + (1 - 2 * flip) * rows) % TILE
        j = (right + (1 - 2 * mirror) * columns) % TILE
        factor: Map = self._tile[j, i] if turn else self._tile[i, j]
        return factor
