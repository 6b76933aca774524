"""Faces grown from clicked points, as a window proposes them. Light to import."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.inspect.plan.feature_spec import FaceAt


@dataclass(frozen=True, eq=False, slots=True)
class ClickedFace:
    """Face grown from a clicked point.

    Parameters
    ----------
    kind
        "plane", "sphere" or "cylinder": the kind of feature that measures it.
    used
        How many points of the cloud lie on it.
    rms_mm
        Root mean square of their distances from it.
    places
        (M, 3) in mm in the camera frame: these points, or as many of them as can be drawn.
    seeds
        The regions it can be kept as, the better one first: at the place in part coordinates, where there are any, and
        at the pixel that was clicked.
    """

    kind: str
    used: int
    rms_mm: float
    places: NDArray[np.float32]
    seeds: tuple[FaceAt, ...]


@dataclass(frozen=True, eq=False, slots=True)
class ClickedFaces:
    """Faces of one click or two; `parallel` are two planes with a distance, the one nearer to the camera first."""

    faces: tuple[ClickedFace, ...]
    parallel: bool = False
