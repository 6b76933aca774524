"""Colour mosaics: whether a picture's pixels were interpolated between sites of different colours.

A sensor behind a Bayer mosaic sees one colour at each site, in tiles of 2 × 2; the other two are made from the sites
around it. A made value is a mean, so it differs less from its neighbours than a measured one, and the places within
the tile tell which is which. A grey sensor, or three of them, show no such pattern; nor does what JPEG leaves.

References
----------
Bayer, B. E., US 3,971,065 (1976). Popescu, A. C., Farid, H., Exposing digital forgeries in color filter array
interpolated images, IEEE Trans. Signal Process. 53 (2005), doi:10.1109/TSP.2005.855406.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

PERIOD_PX = 2
"""Side of the mosaic's tile."""
CLEARLY = 1.3
"""Times the variance of one place of the tile over another's from which on pixels are interpolated. Bilinear ones reach
2.8 in grey and 4 to 19 in one colour, those that follow edges 1.45 and more; sensors read in two fields reach 1.17
without any mosaic (tests/image/test_mosaic.py)."""
_FROM_NEIGHBOURS = np.array([[0, 1, 0], [1, -4, 1], [0, 1, 0]], np.float32) / 4
_ROUGH_SHARE = 0.1
"""Share of the pixels whose differences are cut down to the next one's: edges and stripes."""


def is_interpolated(picture: NDArray[Any]) -> bool:
    """Whether the pixels of a picture (H, W) differ from their neighbours by their place in tiles of 2 × 2."""
    rows, columns = (size // PERIOD_PX for size in picture.shape)
    if min(rows, columns) < PERIOD_PX:
        return False
    square = cv2.filter2D(picture, cv2.CV_32F, _FROM_NEIGHBOURS) ** 2
    square = np.minimum(square, np.quantile(square, 1 - _ROUGH_SHARE))
    places = square[: PERIOD_PX * rows, : PERIOD_PX * columns].reshape(rows, PERIOD_PX, columns, PERIOD_PX)
    variance = places.mean(axis=(0, 2), dtype=np.float64)
    return bool(variance.max() > CLEARLY * variance.min() > 0)
