"""What a report is put together from besides results: calibrations with their age, repeats, a frame, deviations."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.image.centreline import Centreline
from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, slots=True)
class CalibrationMark:
    """Which calibration a result rests on: its id, the SHA-256 of its file, and when it was made (None: not known)."""

    of: Literal["camera", "fan"]
    id: str
    sha256: str
    made_at: datetime | None = None

    def age(self, at: datetime) -> timedelta | None:
        """How old it was then; None where that is not known."""
        return None if self.made_at is None else at - self.made_at


@dataclass(frozen=True, slots=True)
class RepeatLine:
    """One of several scans of the same part: its thickness and U = k·u in mm, and the calibration it rests on."""

    scan: str
    thickness_mm: float
    U_mm: float
    k: float
    calibration_id: str
    measured_at: datetime


@dataclass(frozen=True, eq=False, slots=True)
class Overlay:
    """One frame and what was found in it.

    Parameters
    ----------
    name
        The frame, for the caption.
    picture
        (height, width) grey levels, uint8.
    fan
        For each line of the fan its centrelines; a line may have none.
    sweep
        Centrelines of the hand-moved laser in this frame.
    sweep_sigma
        For each centreline of `sweep` its (N,) standard uncertainty of depth in mm; NaN where there is none.
    crossings
        (M, 2) pixels of the crossings that were used.

    Raises
    ------
    ValueError
        If the picture is not a two-dimensional uint8 array or a shape does not match.
    """

    name: str
    picture: NDArray[np.uint8]
    fan: tuple[tuple[Centreline, ...], ...]
    sweep: tuple[Centreline, ...]
    sweep_sigma: tuple[Array, ...]
    crossings: Array

    def __post_init__(self) -> None:
        if self.picture.ndim != 2 or self.picture.dtype != np.uint8:
            raise ValueError(f"picture is {self.picture.dtype} {self.picture.shape}, not a grey uint8 picture")
        if [len(line) for line in self.sweep] != [len(sigma) for sigma in self.sweep_sigma]:
            raise ValueError("sweep_sigma does not match the points of sweep")
        set_field(self, "crossings", frozen_array(np.reshape(self.crossings, (-1, 2)), (None, 2), "crossings"))


@dataclass(frozen=True, eq=False, slots=True)
class Deviations:
    """How far places of the surface are from the nominal one.

    Parameters
    ----------
    name
        Of the feature.
    uv
        (N, 2) pixels they are seen at.
    deviation
        (N,) in mm, outwards positive.
    tolerance_mm
        What colours and marks are shares of.
    """

    name: str
    uv: Array
    deviation: Array
    tolerance_mm: float
