"""The bits of a picture's state map, and whether any are set in a part of it."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

SATURATED, IGNORED = 1, 2
"""Bits of the picture's state map."""

_LANES = 32  # marks looked at in one instruction, if a loop has as many rounds


@njit(cache=True, nogil=True)
def marks_within(state: NDArray[np.uint8], left: int, right: int, top: int, bottom: int) -> int:
    """All bits set in columns `left` … `right` − 1 and rows `top` … `bottom` − 1, perhaps some columns more."""
    bits, last = np.uint8(0), state.shape[1] - _LANES
    for j in range(top, bottom):
        row = state[j]
        if last < 0:
            for mark in row[left:right]:
                bits |= mark
            continue
        for start in range(left, right, _LANES):
            at = min(start, last)
            part = row[at : at + _LANES]
            for i in range(_LANES):
                bits |= part[i]
    return int(bits)
