"""What is shown of a measured scan. Light to import: a window needs it at its start."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.image.stripe import StripeSettings
from core.scan.frame_record import FrameRecord


@dataclass(frozen=True, eq=False, slots=True)
class ScanLook:
    """A measured scan, light enough to be sent from process to process.

    Parameters
    ----------
    points, sigma
        (N, 3) float32 in mm in the camera frame, and (N,) float32, the standard uncertainty of each depth in mm without
        what is common to the whole scan.
    uv, frame
        (N, 2) float32, the pixel each was seen at, and (N,) int32, the index of its frame; −1 for the fan's own.
    triangles
        How many the mesh has.
    frames, frames_used
        What became of every frame, and how many of them gave points.
    median_sigma_mm, sigma_95_mm
        Half and 95 % of the points have no larger σ; NaN without points.
    left_out
        Why frames gave no points, and how many each time, the most frequent reason first.
    share
        Covered share (0 … 1) of what was lit, as in `core.scan.coverage_map`.
    stripe
        How the hand-held laser's stripe looks, as the measurement settled it.
    notes
        Sentences for the technician about the scan; those about `left_out` are not among them.
    problems
        Why a result that is there cannot be shown: whole sentences.
    """

    points: NDArray[np.float32]
    sigma: NDArray[np.float32]
    uv: NDArray[np.float32]
    frame: NDArray[np.int32]
    triangles: int
    frames: tuple[FrameRecord, ...]
    frames_used: int
    median_sigma_mm: float
    sigma_95_mm: float
    left_out: tuple[tuple[str, int], ...]
    share: float
    stripe: StripeSettings | None
    notes: tuple[str, ...]
    problems: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.points)


def reasons_counted(frames: Iterable[FrameRecord]) -> tuple[tuple[str, int], ...]:
    """Why frames gave no points, and how many each time, the most frequent reason first."""
    return tuple(Counter(frame.reason for frame in frames if not frame.used).most_common())
