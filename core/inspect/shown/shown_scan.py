"""A scan as it is looked at: points in the order of their σ, each with all it can be coloured by. Light to import."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.inspect.results import GaugeResult
from core.messages import Message
from core.model.arrays import Array

Values = NDArray[np.float32]

HEIGHT, DEPTH = "height", "depth"
NO_FACE, UPPER, LOWER = 0, 1, 2
"""Numbers of `InspectionView.face`."""


@dataclass(frozen=True, eq=False, slots=True)
class Relief:
    """Surface as a picture: grey levels (rows, columns) of cells of `cell_px` × `cell_px` camera pixels."""

    picture: NDArray[np.uint8]
    cell_px: float


@dataclass(frozen=True, eq=False, slots=True)
class NextPair:
    """Pair of faces that could be meant as well as the one that was measured.

    Parameters
    ----------
    thickness_mm
        How far apart they are.
    outlines_px
        Outlines (n, 2) in pixels of those of its faces that are not of the measured pair as well.
    outlines
        The same (n, 3) in mm on the surface, camera frame.
    """

    thickness_mm: float
    outlines_px: tuple[Array, ...]
    outlines: tuple[Array, ...]


@dataclass(frozen=True, eq=False, slots=True)
class ShownMesh:
    """Mesh of a scan; triangles in the order of the largest σ of their corners.

    Parameters
    ----------
    vertices
        (V, 3) in mm, camera frame.
    sigma, height, deviation
        (V,) as in `InspectionView`.
    triangles
        (T, 3) indices into the vertices.
    triangle_sigma
        (T,) ascending.
    """

    vertices: Array
    sigma: Values
    height: Values
    deviation: Values
    triangles: NDArray[np.int64]
    triangle_sigma: Values

    def up_to(self, sigma_mm: float) -> int:
        """Count the leading triangles, sorted by σ, whose corners all have a σ of at most `sigma_mm`."""
        return int(np.searchsorted(self.triangle_sigma, np.float32(sigma_mm), side="right"))


@dataclass(frozen=True, eq=False, slots=True)
class InspectionView:
    """View of a scan and its thickness, with everything the window shows, ready to be drawn.

    Points come in the order of their σ, so that those up to some σ are the first ones and no array need be copied.

    Parameters
    ----------
    points
        (N, 3) in mm, camera frame.
    normals
        (N, 3) unit normals, zero where unknown.
    number
        (N,) index of each in the cloud.
    uv
        (N, 2) pixel each was seen at.
    sigma
        (N,) standard uncertainty of the depth in mm, ascending.
    height
        (N,) mm over the lower face's plane, towards the camera; without a thickness, the depth.
    height_is
        HEIGHT or DEPTH.
    deviation
        (N,) mm from the plane of the face it was used for, towards the camera; NaN for points not used.
    face
        (N,) UPPER, LOWER or NO_FACE: which face a point was used for.
    frame
        (N,) number of the frame, from 1; NaN for points that the fan measured itself.
    frames
        Names of the frames, as "scan/frame0007.png".
    ranges
        By name of a value ("sigma", "height", "deviation", "frame"): the ends of its colour bar.
    mesh
        The surface; None if there is none.
    gauge
        The thickness; its faces' indices are into the points above, ascending. None if none was measured.
    outlines
        Outlines (n, 2) in pixels of the upper and the lower face's points; None without a thickness.
    next_pair
        The next best of several pairs of faces that could be meant; None where there was no choice.
    used_uv
        Pixels (n, 2) of some of the points used on the upper and on the lower face.
    relief
        The surface as a picture.
    image_size
        (width, height) of the camera's picture in pixels.
    pictures
        Names of the recorded pictures, the reference first.
    shown
        Which of them shows most.
    notes
        Sentences for the technician, of the measurement.
    problems
        Why a result that is there is not shown.
    calibration_id
        Names the calibrations the scan was measured with.
    """

    points: Array
    normals: NDArray[np.float32]
    number: NDArray[np.int32]
    uv: NDArray[np.float32]
    sigma: Values
    height: Values
    height_is: str
    deviation: Values
    face: NDArray[np.int8]
    frame: Values
    frames: tuple[str, ...]
    ranges: Mapping[str, tuple[float, float]]
    mesh: ShownMesh | None
    gauge: GaugeResult | None
    outlines: tuple[Array, Array] | None
    next_pair: NextPair | None
    used_uv: tuple[Array, Array] | None
    relief: Relief
    image_size: tuple[int, int]
    pictures: tuple[str, ...] = ()
    shown: str = ""
    notes: tuple[Message, ...] = ()
    problems: tuple[Message, ...] = ()
    calibration_id: str = ""

    def __len__(self) -> int:
        return len(self.points)

    def up_to(self, sigma_mm: float) -> int:
        """Count the leading points, sorted by σ, that have a σ of at most `sigma_mm`."""
        return int(np.searchsorted(self.sigma, np.float32(sigma_mm), side="right"))

    def used_up_to(self, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Select the points used on the upper and on the lower face among the first `count` points; return indices."""
        if self.gauge is None:
            return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
        upper, lower = self.gauge.upper.indices, self.gauge.lower.indices
        return upper[: np.searchsorted(upper, count)], lower[: np.searchsorted(lower, count)]

    def frame_name(self, point: int) -> str:
        """Return the name of the frame that point number `point` was measured in; "" for a point of the fan."""
        number = float(self.frame[point])
        return self.frames[int(number) - 1] if 1 <= number <= len(self.frames) else ""
