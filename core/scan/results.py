"""What a scan gives: the cloud, the sweeps, and a record of every frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array
from core.scan.cloud import Cloud
from core.scan.crossings import CrossingTable
from core.scan.fan_lines import FanLines
from core.scan.frame_record import FrameRecord

__all__ = ["FrameRecord", "ScanResult"]


@dataclass(frozen=True, eq=False, slots=True)
class ScanResult:
    """The surface points of a scan and what they rest on.

    Parameters
    ----------
    cloud
        All points whose σ is within the cut, the fan's own included.
    pis
        (S, 3) light planes of the sweeps in 1/mm.
    covariance
        (3S, 3S) of them, without what camera and fan have in common.
    sweep_frames
        (S,) the frame of each sweep.
    frames
        One record for every frame of the recording.
    crossings, crossing_weights
        All crossings, and the weight (0 left out … 1) each had.
    fan_lines
        The number given to each of the fan's centrelines.
    scale
        Standard deviation of unit weight of the adjustment; 1 where the noise model is true.
    notes
        Sentences for the technician.
    """

    cloud: Cloud
    pis: Array
    covariance: Array
    sweep_frames: NDArray[np.int64]
    frames: tuple[FrameRecord, ...]
    crossings: CrossingTable
    crossing_weights: Array
    fan_lines: FanLines
    scale: float
    notes: tuple[str, ...] = ()
