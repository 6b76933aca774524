"""State map of a picture: which pixels are saturated or to be ignored, and whether any in a part of it are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.compiled import inlined

SATURATED, IGNORED = 1, 2
"""Bits of the picture's state map."""

_AT_ONCE = 32  # pixels tested in one instruction, if a loop has as many rounds


@inlined()
def bits_within(state: NDArray[np.uint8], left: int, right: int, top: int, bottom: int) -> int:
    """Combine by OR the bits of pixels in these columns and rows, ends left out; some columns more may be in."""
    bits, last = np.uint8(0), state.shape[1] - _AT_ONCE
    for j in range(top, bottom):
        row = state[j]
        if last < 0:
            for pixel in row[left:right]:
                bits |= pixel
            continue
        for start in range(left, right, _AT_ONCE):
            at = min(start, last)
            part = row[at : at + _AT_ONCE]
            for i in range(_AT_ONCE):
                bits |= part[i]
    return int(bits)
