"""One pose of the plane target as it is shown: its picture and what was found in it. Light to import."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array

NOT_SEEN = -1
"""The number of a stripe that no fan line drew, or of which it is not known."""


@dataclass(frozen=True, eq=False, slots=True)
class NumberedStripe:
    """One straight stripe: its points (N, 2) in pixels, and the fan line (from 0) that drew it or NOT_SEEN."""

    uv: Array
    line: int


@dataclass(frozen=True, eq=False, slots=True)
class PoseStages:
    """The picture (H, W) of a pose with the fan on, and what was found.

    `corners` (N, 2) in pixels are the target's points, none if it was not found; `stripes` the straight stripes with
    the fan line each is of; `reason` why the pose cannot be used, empty if it can.
    """

    name: str
    picture: NDArray[np.uint8]
    corners: Array
    stripes: tuple[NumberedStripe, ...]
    reason: str
    notes: tuple[str, ...]
