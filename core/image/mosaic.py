"""Colour mosaics: which sites of a sensor see a colour, and whether pixels were interpolated between sites.

A sensor behind a Bayer mosaic sees one colour at each site, in tiles of 2 × 2; the other two are made from the sites
around it. A made value is a mean, so it differs less from its neighbours than a measured one, and the places within
the tile tell which is which. A grey sensor, or three of them, show no such pattern; nor does what JPEG leaves.

What one site of each tile has measured is a whole picture of half the size, of which no pixel was made up: stripes of a
laser of that colour are measured in it, and their points brought back.

References
----------
Bayer, B. E., US 3,971,065 (1976). Popescu, A. C., Farid, H., Exposing digital forgeries in color filter array
interpolated images, IEEE Trans. Signal Process. 53 (2005), doi:10.1109/TSP.2005.855406.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias, overload

import cv2
import numpy as np
from numpy.typing import NDArray

from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import StripeSettings
from core.model.arrays import Array

PERIOD_PX = 2
"""Side of the mosaic's tile."""
CLEARLY = 1.3
"""Times the variance of one place of the tile over another's from which on pixels are interpolated. Bilinear ones reach
2.8 in grey and 4 to 19 in one colour, those that follow edges 1.45 and more; sensors read in two fields reach 1.17
without any mosaic (tests/image/test_mosaic.py)."""
Pattern: TypeAlias = Literal["RGGB", "BGGR", "GRBG", "GBRG"]
"""Colours of the first two sites of the first row, then of the second."""
_TO_BGR = {
    "RGGB": cv2.COLOR_BayerRGGB2BGR,
    "BGGR": cv2.COLOR_BayerBGGR2BGR,
    "GRBG": cv2.COLOR_BayerGRBG2BGR,
    "GBRG": cv2.COLOR_BayerGBRG2BGR,
}
_LIT_QUANTILE = 0.5
"""Of the tiles by brightness: the brighter ones tell how the sites' sensitivities compare."""
_FROM_NEIGHBOURS = np.array([[0, 1, 0], [1, -4, 1], [0, 1, 0]], np.float32) / 4
_ROUGH_SHARE = 0.1
"""Share of the pixels whose differences are cut down to the next one's: edges and stripes."""


def is_interpolated(picture: NDArray[Any]) -> bool:
    """Whether colours of a picture (H, W) were interpolated from a mosaic, by differences within tiles of 2 × 2 px."""
    rows, columns = (size // PERIOD_PX for size in picture.shape)
    if min(rows, columns) < PERIOD_PX:
        return False
    square = cv2.filter2D(picture, cv2.CV_32F, _FROM_NEIGHBOURS) ** 2
    square = np.minimum(square, np.quantile(square, 1 - _ROUGH_SHARE))
    places = square[: PERIOD_PX * rows, : PERIOD_PX * columns].reshape(rows, PERIOD_PX, columns, PERIOD_PX)
    variance = places.mean(axis=(0, 2), dtype=np.float64)
    return bool(variance.max() > CLEARLY * variance.min() > 0)


@dataclass(frozen=True, slots=True)
class Sites:
    """Sites of one colour in a mosaic: those `u`, `v` from the first one of each tile, of `period` px either way."""

    u: int
    v: int
    period: int = PERIOD_PX

    def of(self, picture: NDArray[Any]) -> NDArray[Any]:
        """Select the pixels of a picture (H, W) at the sites of this colour, about (H / period, W / period)."""
        return np.ascontiguousarray(picture[self.v :: self.period, self.u :: self.period])

    def places_of(self, uv: Array) -> Array:
        """Convert places (N, 2) from px of the whole picture to px of the picture made of these sites alone."""
        return np.asarray((uv - (self.u, self.v)) / self.period)

    def stripe_of(self, stripe: StripeSettings | None) -> StripeSettings | None:
        """Convert a stripe's width from px of the whole picture to px of these sites; None stays None."""
        return None if stripe is None else replace(stripe, width_px=stripe.width_px / self.period)

    @overload
    def stripe_in_whole_picture(self, stripe: StripeSettings) -> StripeSettings: ...
    @overload
    def stripe_in_whole_picture(self, stripe: None) -> None: ...
    def stripe_in_whole_picture(self, stripe: StripeSettings | None) -> StripeSettings | None:
        """Convert a stripe's width from px of these sites to px of the whole picture; None stays None."""
        return None if stripe is None else replace(stripe, width_px=stripe.width_px * self.period)

    def in_whole_picture(self, lines: Sequence[Centreline]) -> tuple[Centreline, ...]:
        """Convert centrelines from px of these sites to px of the whole picture, where points are further apart."""
        if self == ALL_SITES:
            return tuple(lines)
        return tuple(
            replace(
                line,
                uv=self.period * line.uv + (self.u, self.v),
                width=self.period * line.width,
                sigma=self.period * line.sigma,
                correlation_px=self.period * line.correlation_px,
            )
            for line in lines
        )


ALL_SITES = Sites(0, 0, 1)
"""Every pixel, where a picture is none of a mosaic."""


def sites_of(pattern: Pattern, colour: str) -> Sites:
    """Return the sites of a colour mosaic that see "red", "green" or "blue"; of two green ones the first."""
    at = pattern.index(colour[0].upper())
    return Sites(at % PERIOD_PX, at // PERIOD_PX)


def colours_of(picture: NDArray[Any], pattern: Pattern) -> NDArray[Any]:
    """Interpolate a raw picture (H, W) of a colour mosaic to blue, green and red, (H, W, 3)."""
    return np.asarray(cv2.cvtColor(picture, _TO_BGR[pattern]))


def even_grey(picture: NDArray[Any]) -> NDArray[np.uint16]:
    """Scale the colours of a raw picture (H, W) of a black and white target to one white level, in 16 bits.

    So every pixel of it was measured, and an edge lies where it is. The least sensitive colour is the standard.
    """
    white = float(np.iinfo(picture.dtype).max)
    rows, columns = (size // PERIOD_PX for size in picture.shape)
    tiles = picture[: PERIOD_PX * rows, : PERIOD_PX * columns].reshape(rows, PERIOD_PX, columns, PERIOD_PX)
    level = tiles.max(axis=(1, 3))
    lit = (level >= np.quantile(level, _LIT_QUANTILE)) & (level < white)
    sums = np.array([[float(tiles[:, v, :, u][lit].sum(dtype=np.float64)) for u in (0, 1)] for v in (0, 1)])
    gain = sums.min() / np.maximum(sums, 1.0)  # towards the least sensitive: nothing goes beyond white
    found = picture.astype(np.float32) * np.float32(np.iinfo(np.uint16).max / white)
    for v in (0, 1):
        for u in (0, 1):
            found[v::PERIOD_PX, u::PERIOD_PX] *= np.float32(gain[v, u])
    return np.asarray(np.rint(found), dtype=np.uint16)
