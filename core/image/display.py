"""Pictures in 8 bit, for looking at."""

from __future__ import annotations

from typing import Any

import cv2
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


def halved(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Half as wide and high, (h // 2, w // 2) or with colours (h // 2, w // 2, 3): means of four pixels each."""
    rows, columns = picture.shape[0] // 2, picture.shape[1] // 2
    small = cv2.resize(picture[: 2 * rows, : 2 * columns], (columns, rows), interpolation=cv2.INTER_AREA)
    return np.ascontiguousarray(small, dtype=np.uint8)
