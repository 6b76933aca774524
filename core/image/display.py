"""Pictures converted to 8 bit for display."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

_LEAST_BITS = 10  # bits; cameras that give 16-bit pictures have at least so many: a dark picture stays dark


def in_8_bit(picture: NDArray[Any], brightest: float) -> NDArray[np.uint8]:
    """Scale the grey levels 0 … `brightest` of a picture of any shape to 0 … 255, and clip what is outside."""
    if picture.dtype == np.uint8 and brightest == 255:
        return np.asarray(picture, dtype=np.uint8)
    scaled = picture.astype(np.float32) * np.float32(255 / max(brightest, 1e-6))
    return np.asarray(np.clip(scaled, 0, 255), dtype=np.uint8)


def white_level(picture: NDArray[Any]) -> float:
    """Compute the grey level to show as white: the largest of a camera with as many bits as `picture` uses."""
    if picture.dtype == np.uint8:
        return 255.0
    return float(2 ** max(int(picture.max()).bit_length(), _LEAST_BITS) - 1)


def halved(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Reduce a picture to half size, (H // 2, W // 2) or in colour (H // 2, W // 2, 3), by means over four pixels."""
    rows, columns = picture.shape[0] // 2, picture.shape[1] // 2
    small = cv2.resize(picture[: 2 * rows, : 2 * columns], (columns, rows), interpolation=cv2.INTER_AREA)
    return np.ascontiguousarray(small, dtype=np.uint8)
