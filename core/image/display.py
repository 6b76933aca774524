"""Pictures in 8 bit, for looking at."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_FEWEST_BITS = 10  # of cameras that give 16-bit pictures


def in_8_bit(picture: NDArray[Any], brightest: float) -> NDArray[np.uint8]:
    """Grey levels from 0 to `brightest` spread over 0 … 255; what is darker or brighter is cut off."""
    if picture.dtype == np.uint8 and brightest == 255:
        return np.asarray(picture, dtype=np.uint8)
    scaled = picture.astype(np.float32) * np.float32(255 / max(brightest, 1e-6))
    return np.asarray(np.clip(scaled, 0, 255), dtype=np.uint8)


def white_level(picture: NDArray[Any]) -> float:
    """The grey level to show white: the largest of a camera with as many bits as `picture` makes use of."""
    if picture.dtype == np.uint8:
        return 255.0
    return float(2 ** max(int(picture.max()).bit_length(), _FEWEST_BITS) - 1)
