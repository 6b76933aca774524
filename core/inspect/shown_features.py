"""Features as a window shows them: their rows, the points they used and what is drawn of them. Light to import."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.inspect.characteristic import Characteristic
from core.inspect.deviation_map import DeviationMap
from core.inspect.profile import Profile


@dataclass(frozen=True, eq=False, slots=True)
class ShownFeature:
    """One feature of a plan as it was measured.

    Parameters
    ----------
    name, kind
        As the plan has them.
    rows
        Its characteristics.
    used
        How many points of the cloud were used.
    places, uv
        (M, 3) in mm in the camera frame and (M, 2) in pixels: these points, or as many of them as can be drawn.
    problem
        Why it could not be measured, or "".
    profile
        Of a section.
    deviations
        Of a comparison with a nominal surface.
    """

    name: str
    kind: str
    rows: tuple[Characteristic, ...]
    used: int
    places: NDArray[np.float32]
    uv: NDArray[np.float32]
    problem: str = ""
    profile: Profile | None = None
    deviations: DeviationMap | None = None


@dataclass(frozen=True, eq=False, slots=True)
class ShownInspection:
    """A plan measured on the scan of a project; `verdict` is the worst of all, "" where nothing is asked."""

    features: tuple[ShownFeature, ...]
    verdict: str
    notes: tuple[str, ...]
    calibration_id: str
