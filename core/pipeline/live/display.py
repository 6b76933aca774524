"""Pictures made small and 8 bit, for a window."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from core.acquire.source import Picture

Reduced = tuple[NDArray[np.uint8], int]
"""A small picture (h, w), and the whole factor it was reduced by."""

_FEWEST_BITS = 10  # of cameras that give 16-bit pictures


class Display:
    """Reduces the pictures of one source by a whole factor to at most `width_px` across.

    16-bit pictures of cameras with fewer bits are brightened by as many bits as none of them has used yet.
    """

    def __init__(self, width_px: int) -> None:
        self._width_px, self._bits = width_px, _FEWEST_BITS

    def reduced(self, picture: Picture) -> Reduced:
        """The small picture (h, w), and the factor."""
        height, width = picture.shape
        factor = max(1, -(-width // self._width_px))
        rows, columns = max(1, height // factor), max(1, width // factor)
        whole = picture[: rows * factor, : columns * factor]
        small = whole if factor == 1 else cv2.resize(whole, (columns, rows), interpolation=cv2.INTER_AREA)
        if picture.dtype == np.uint8:
            return np.ascontiguousarray(small, dtype=np.uint8), factor
        self._bits = max(self._bits, int(picture.max()).bit_length())
        return np.asarray(np.asarray(small, dtype=np.uint16) >> (self._bits - 8), dtype=np.uint8), factor
