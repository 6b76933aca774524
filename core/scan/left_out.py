"""Why crossings do not count."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.scan.network import SILENCED

REASONS = (
    "",
    "disagrees with the fan",
    "disagrees with other sweeps",
    "object or camera moved between its frame and the others, or the fan",
    "its frame was not located",
)
COUNTS, NOT_THE_FAN, NOT_THE_SWEEPS, MOVED, NOT_LOCATED = range(len(REASONS))


def reasons_of(
    with_fan: NDArray[np.bool_], weights: Array, still: NDArray[np.bool_], located: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Index into REASONS (M,) for crossings with these weights, of frames that stood still and were located."""
    reasons = np.where(weights < SILENCED, np.where(with_fan, NOT_THE_FAN, NOT_THE_SWEEPS), COUNTS)
    reasons = np.where(located, reasons, NOT_LOCATED)
    return np.where(still, reasons, MOVED).astype(np.int64)
