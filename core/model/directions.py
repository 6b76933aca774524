"""Directions perpendicular to others."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from core.model.arrays import Array


def square_to(directions: ArrayLike) -> Array:
    """Find two unit vectors, columns of (…, 3, 2), perpendicular to each of `directions` (…, 3) and to each other.

    Which two is arbitrary, but the same for the same direction: the null space of a row by its singular value
    decomposition. `directions` may have any length but 0.
    """
    rows = np.asarray(directions, dtype=np.float64)[..., None, :]
    return np.asarray(np.swapaxes(np.linalg.svd(rows)[2][..., 1:, :], -1, -2))
