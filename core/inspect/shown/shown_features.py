"""Features as a window shows them: their rows, the points they used and what is drawn of them. Light to import."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.inspect.characteristic import Characteristic
from core.messages import Message
from core.model import Pose
from core.model.arrays import Array

UNSEEN_STEPS = 3
"""Over more steps of a section without points no line is drawn."""


@dataclass(frozen=True, eq=False, slots=True)
class ShownProfile:
    """Cross-section as it is drawn: positions along it and heights, in mm.

    Parameters
    ----------
    position, height
        (M,) of its points, or of as many as can be drawn.
    mean_position, mean_height
        (K,) of the profile averaged over steps.
    mean_piece
        (K,) counts from 0, one more after each long stretch without points.
    """

    position: Array
    height: Array
    mean_position: Array
    mean_height: Array
    mean_piece: NDArray[np.int64]

    @classmethod
    def of(cls, position: Array, height: Array, means: tuple[Array, Array], step_mm: float, most: int) -> ShownProfile:
        """Make a profile to draw from points (N,) in mm, thinned out to `most`, and `means` over `step_mm`."""
        order = np.argsort(position, kind="stable")[:: max(1, -(-len(position) // most))]
        far = np.diff(means[0], prepend=means[0][:1]) > UNSEEN_STEPS * step_mm
        return cls(position[order], height[order], *means, np.cumsum(far))

    @property
    def mean_line(self) -> tuple[Array, Array]:
        """Positions and heights in mm of the profile's mean line, with NaN at its gaps."""
        ends = np.flatnonzero(np.diff(self.mean_piece)) + 1
        return np.insert(self.mean_position, ends, np.nan), np.insert(self.mean_height, ends, np.nan)


@dataclass(frozen=True, eq=False, slots=True)
class ShownClass:
    """Class of deviations: its `mark` as "++", both ends in mm, the share of places in it, and some of them.

    `low_mm`, `high_mm`: −inf and inf for those beyond the tolerance. `share` of all places. `places` (M, 3) in mm.
    """

    mark: str
    number: int
    low_mm: float
    high_mm: float
    share: float
    places: NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True)
class ShownDeviations:
    """Comparison with a nominal surface as it is drawn.

    Parameters
    ----------
    classes
        From the farthest inwards to the farthest outwards.
    edges, counts
        (B + 1,) in mm and (B,): the histogram.
    tolerance_mm
        What the classes are quarters of.
    nominal
        (T, 3, 3) in mm in the camera frame: triangles of the nominal surface, or as many of them as can be drawn.
    """

    classes: tuple[ShownClass, ...]
    edges: Array
    counts: NDArray[np.int64]
    tolerance_mm: float
    nominal: NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True)
class ShownFeature:
    """Feature of a plan as it was measured.

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
        Why it could not be measured; None if it was.
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
    problem: Message | None = None
    profile: ShownProfile | None = None
    deviations: ShownDeviations | None = None


@dataclass(frozen=True, eq=False, slots=True)
class ShownInspection:
    """Plan measured on the scan of a project.

    `unmeasured`: whether a feature with limits could not be measured. `pose_camera_part` maps part coordinates into the
    camera frame, where there are any.
    """

    features: tuple[ShownFeature, ...]
    unmeasured: bool
    notes: tuple[Message, ...]
    calibration_id: str
    pose_camera_part: Pose | None = None
