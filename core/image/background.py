"""The picture without what moves, made of pictures in which it moves: a sweep covers a pixel in few of its frames."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

SAMPLE = 15
"""At most this many frames, spread over the scan, make a quantile reference: memory does not grow with the scan."""
QUANTILE = 0.35
"""Of the grey values of a pixel over the scan: below all that the sweep lights."""
FEWEST = 3
"""Frames from which a background can be made: of three, the darkest third is one."""

Picture = NDArray[np.uint8] | NDArray[np.uint16]


def sample_indices(count: int) -> list[int]:
    """Choose at most `SAMPLE` indices of frames, spread evenly from 0 to `count` − 1."""
    return sorted({round(i) for i in np.linspace(0, count - 1, min(count, SAMPLE))}) if count else []


def quantile_reference(pictures: Sequence[Picture]) -> Picture:
    """Compute a reference picture as the low quantile, pixel by pixel, of `pictures`, each (H, W) or (H, W, channels).

    Raises
    ------
    ValueError
        With fewer than three pictures: a sweep would stay in the background.
    """
    if len(pictures) < FEWEST:
        raise ValueError(f"{len(pictures)} pictures cannot tell the background from the sweep")
    rank = int(QUANTILE * (len(pictures) - 1))
    rows = [
        np.partition(np.stack([picture[row] for picture in pictures]), rank, axis=0)[rank]
        for row in range(len(pictures[0]))
    ]
    return np.stack(rows)
