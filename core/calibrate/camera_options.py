"""What a calibration of the camera leaves free, and which outliers it leaves out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.calibrate.results import CAMERA_PARAMETERS
from core.calibrate.screening import Outliers


@dataclass(frozen=True)
class CameraOptions:
    """What a camera calibration leaves free, and which outliers it leaves out.

    Parameters
    ----------
    skew
        Whether γ is free; else it is 0.
    fixed
        Those of k1, k2, p1, p2 that are fixed to 0.
    k3
        Whether k3 is free; else it is 0.
    outliers
        "keep": every corner of every view counts. "gross": views out of line with the others are left out, and
        corners that stand out against the plain standard deviation of their view, which they raise themselves. "all":
        also corners that stand out against the median of their view only.
    """

    skew: bool = True
    fixed: frozenset[str] = frozenset()
    k3: bool = False
    outliers: Outliers = "gross"

    def __post_init__(self) -> None:
        object.__setattr__(self, "fixed", frozenset(self.fixed))
        unknown = self.fixed - {"k1", "k2", "p1", "p2"}
        if unknown:
            raise ValueError(f"only k1, k2, p1 and p2 can be fixed, not {', '.join(sorted(unknown))}")

    @property
    def free(self) -> NDArray[np.intp]:
        """Indices of the free parameters in CAMERA_PARAMETERS."""
        zero = self.fixed | (set() if self.skew else {"gamma"}) | (set() if self.k3 else {"k3"})
        return np.array([i for i, name in enumerate(CAMERA_PARAMETERS) if name not in zero], dtype=np.intp)
