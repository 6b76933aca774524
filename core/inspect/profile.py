"""A cross-section of a cloud: positions along it, heights, and the mean line through them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array


@dataclass(frozen=True, eq=False, slots=True)
class Profile:
    """The points of a cloud near a plane, laid out in it.

    Parameters
    ----------
    origin
        (3,) in mm, camera frame: position 0, height 0.
    along, up
        (3,) unit vectors in the section's plane; `up` is square to `along` and points to the camera's side.
    indices
        (N,) into the cloud.
    position, height
        (N,) in mm of each point.
    sigma
        (N,) standard uncertainty in mm of the height, without what is common to the whole scan.
    mean_position, mean_height
        (M,) of the profile averaged over steps.
    """

    origin: Array
    along: Array
    up: Array
    indices: NDArray[np.int64]
    position: Array
    height: Array
    sigma: Array
    mean_position: Array
    mean_height: Array

    @property
    def normal(self) -> Array:
        """(3,) unit normal of the section's plane."""
        return np.asarray(np.cross(self.along, self.up))

    def between(self, ends: tuple[float, float]) -> NDArray[np.int64]:
        """Which of its points (numbers into `indices`) lie between two positions in mm."""
        return np.flatnonzero((self.position >= min(ends)) & (self.position <= max(ends)))


def averaged(position: Array, height: Array, step_mm: float) -> tuple[Array, Array]:
    """Medians of the heights over steps along a profile, and the mean positions; empty steps are left out."""
    if not len(position):
        return np.zeros(0), np.zeros(0)
    step = np.floor((position - position.min()) / step_mm).astype(np.int64)
    order = np.lexsort((height, step))
    _, first, count = np.unique(step[order], return_index=True, return_counts=True)
    sums = np.add.reduceat(position[order], first)
    low, high = height[order][first + (count - 1) // 2], height[order][first + count // 2]
    return sums / count, (low + high) / 2
