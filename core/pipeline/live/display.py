"""Pictures made small and 8 bit, for a window."""

from __future__ import annotations

from typing import Self

import cv2
import numpy as np
from numpy.typing import NDArray

from core.acquire.channel import Channel
from core.acquire.grey import to_grey
from core.acquire.source import Picture
from core.files.recording.rig import Rig
from core.image.mosaic import Pattern, colours_of

Reduced = tuple[NDArray[np.uint8], int]
"""A small picture (h, w), and the whole factor it was reduced by."""

_FEWEST_BITS = 10  # of cameras that give 16-bit pictures


class Display:
    """Converter of the pictures of one source to 8 bit, reduced by a whole factor to at most `width_px` across.

    16-bit pictures of cameras with fewer bits are brightened by as many bits as none of them has used yet. Raw ones,
    of a `mosaic`, are shown in the `channel` that is looked at, between its sites their means: as they come they are a
    checkerboard. Nothing is measured in what is shown.
    """

    def __init__(self, width_px: int, mosaic: Pattern | None = None, channel: Channel | None = None) -> None:
        self._width_px, self._bits = width_px, _FEWEST_BITS
        self._mosaic, self._channel = mosaic, channel

    @classmethod
    def of(cls, rig: Rig, width_px: int) -> Self:
        """Make the converter for the live pictures of a rig, with the mosaic and the channel that it states."""
        return cls(width_px, rig.mosaic, rig.live_channel)

    def reduced(self, picture: Picture) -> Reduced:
        """Reduce a picture (H, W) to 8 bit (h, w) for display; return it with the whole factor H / h."""
        if self._mosaic is not None:
            picture = to_grey(colours_of(picture, self._mosaic), self._channel)
        height, width = picture.shape
        factor = max(1, -(-width // self._width_px))
        rows, columns = max(1, height // factor), max(1, width // factor)
        whole = picture[: rows * factor, : columns * factor]
        small = whole if factor == 1 else cv2.resize(whole, (columns, rows), interpolation=cv2.INTER_AREA)
        if picture.dtype == np.uint8:
            return np.ascontiguousarray(small, dtype=np.uint8), factor
        self._bits = max(self._bits, int(picture.max()).bit_length())
        return np.asarray(np.asarray(small, dtype=np.uint16) >> (self._bits - 8), dtype=np.uint8), factor
