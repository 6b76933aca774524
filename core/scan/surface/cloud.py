"""The measured points of a scan."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array, frozen_array, set_field

FAN = -1
"""Value of `Cloud.sweep` for points that the fan measured itself; fan line k (from 0) is `FAN - k`."""


@dataclass(frozen=True, eq=False, slots=True)
class Cloud:
    """Points in the camera frame, each with its standard uncertainty.

    Parameters
    ----------
    points
        (N, 3) in mm.
    uv
        (N, 2) the pixel each was seen at (distorted image coordinates).
    sigma
        (N,) standard uncertainty of the depth in mm, without what is common to the whole scan.
    intensity
        (N,) strength of the stripe in grey levels.
    frame
        (N,) index of the frame in the order of the recording; −1 for the reference (the fan's own points).
    sweep
        (N,) index of the sweep in the network's covariance, or `FAN - k` for fan line k.
    normals
        (N, 3) unit normals towards the camera; zero where unknown.
    sigma_common
        (N,) standard uncertainty of the depth in mm that camera and fan have in common for the whole scan; not in
        `sigma`. Zero where it is not known (and when left out).
    skewness, spread_mm
        (N,) of the stripe's section: its skewness, positive where the light reaches further away from the camera, and
        its σ in mm of depth. Zero where they are not known (and when left out).
    view
        (N,) the view that each point was seen in, of views joined in one frame (`core.views`); 0 of a single one (and
        when left out). Then `points` and `normals` are in the first view's camera frame, `uv` in the view's picture.
    """

    points: Array
    uv: Array
    sigma: Array
    intensity: Array
    frame: NDArray[np.int64]
    sweep: NDArray[np.int64]
    normals: Array
    sigma_common: Array = field(default_factory=lambda: np.zeros(0))
    skewness: Array = field(default_factory=lambda: np.zeros(0))
    spread_mm: Array = field(default_factory=lambda: np.zeros(0))
    view: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    def __post_init__(self) -> None:
        count = len(self.points)
        for name in ("sigma_common", "skewness", "spread_mm"):
            if not len(getattr(self, name)):
                set_field(self, name, np.zeros(count))
        for name, shape in (
            ("points", (count, 3)),
            ("uv", (count, 2)),
            ("sigma", (count,)),
            ("intensity", (count,)),
            ("normals", (count, 3)),
            ("sigma_common", (count,)),
            ("skewness", (count,)),
            ("spread_mm", (count,)),
        ):
            set_field(self, name, frozen_array(getattr(self, name), shape, name))
        if not len(self.view):
            set_field(self, "view", np.zeros(count, dtype=np.int64))
        for name in ("frame", "sweep", "view"):
            index = np.array(getattr(self, name), dtype=np.int64).reshape(count)
            index.flags.writeable = False
            set_field(self, name, index)

    def __len__(self) -> int:
        return len(self.points)

    def select(self, keep: NDArray[np.bool_] | NDArray[np.intp]) -> Cloud:
        """Select points by a mask (N,), or by their indices."""
        return Cloud(
            self.points[keep],
            self.uv[keep],
            self.sigma[keep],
            self.intensity[keep],
            self.frame[keep],
            self.sweep[keep],
            self.normals[keep],
            self.sigma_common[keep],
            self.skewness[keep],
            self.spread_mm[keep],
            self.view[keep],
        )
