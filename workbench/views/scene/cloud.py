"""The point cloud of a 3D view, cut into chunks of which any few are a fair sample of the whole."""

from __future__ import annotations

from itertools import count

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.model.arrays import Array
from workbench.views.scene.colours import Colouring

CHUNK = 25_000
"""Points in a chunk: software OpenGL draws so many within a frame."""

MEASURED_FOR_LIMITS = 100_000
"""So many values are looked at for the ends of the colour bar: enough for percentiles, a few ms."""

_serials = count()


class SceneCloud:
    """Cloud of points (N, 3) in mm with a value (N,) or a colour each; more can be added.

    The points given first are dealt out to as many chunks as they fill, one after the other, so that each chunk is
    spread over the whole; added points fill further chunks in their order. `serial` tells clouds and recoloured
    clouds apart. With unit normals (N, 3), zero where unknown, the points are shaded; none can be added to these.

    Raises
    ------
    ValueError
        If the shapes do not match.
    """

    def __init__(
        self,
        points: ArrayLike,
        values: ArrayLike | None,
        colouring: Colouring,
        normals: NDArray[np.float32] | None = None,
    ) -> None:
        self._points: Array = as_points(points)
        if normals is not None and normals.shape != self._points.shape:
            raise ValueError(f"normals have shape {normals.shape}, points {self._points.shape}")
        self._normals = normals
        self._values: Array | None = None if values is None else _values(values, len(self._points))
        self.given = self._first = len(self._points)
        self._dealt = -(-self._first // CHUNK)
        self.corners = _extent(self._points)
        """Two opposite corners (2, 3) of the box round all points; NaN when there are none."""
        self._asked = colouring
        self._colour()

    @property
    def points(self) -> Array:
        """Points (N, 3) of the cloud in mm, as given."""
        return self._points[: self.given]

    @property
    def drawable(self) -> bool:
        """Whether any point of the cloud has finite coordinates."""
        return bool(np.isfinite(self.corners).all())

    @property
    def chunks(self) -> int:
        """Number of chunks that the cloud is divided into for drawing."""
        return self._dealt + -(-(self.given - self._first) // CHUNK)

    def rows(self, chunk: int) -> slice:
        """Return the slice of `points` that chunk number `chunk` holds."""
        if chunk < self._dealt:
            return slice(chunk, self._first, self._dealt)
        start = self._first + (chunk - self._dealt) * CHUNK
        return slice(start, min(start + CHUNK, self.given))

    def size(self, chunk: int) -> int:
        """Return how many points chunk number `chunk` has."""
        return len(range(*self.rows(chunk).indices(self.given)))

    def chunk(self, number: int) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.float32] | None]:
        """Return the finite points (n, 3) in mm of a chunk, their colours (n, 3), and their normals (n, 3) or None."""
        rows = self.rows(number)
        points = self._points[rows].astype(np.float32)
        if self._values is not None:
            colours = self.colouring.of(self._values[rows])
        else:
            colours = self.colouring.plain(np.arange(*rows.indices(self.given)))
        normals = None if self._normals is None else _towards_camera(self._normals[rows], points)
        finite = finite_rows(points)
        if finite.all():
            return points, colours, normals
        return points[finite], colours[finite], None if normals is None else normals[finite]

    def spread(self, chunks: int) -> list[int]:
        """Choose the numbers of `chunks` chunks, evenly over the whole cloud."""
        if chunks >= self.chunks:
            return list(range(self.chunks))
        return sorted({int(k) for k in np.linspace(0, self.chunks - 1, max(chunks, 1))})

    def sample(self, at_most: int = 20_000) -> Array:
        """Return an even sample (n, 3) of the points in mm, at most `at_most` of them, the newest included."""
        return self.points[:: -max(1, -(-self.given // at_most))]

    def add(self, points: ArrayLike, values: ArrayLike | None) -> None:
        """Append points (M, 3) in mm with their values (M,); points that are not finite are never drawn.

        Raises
        ------
        ValueError
            If there are values for some points only, or normals.
        """
        more = as_points(points)
        if not len(more):
            return
        if self._normals is not None:
            raise ValueError("points of a cloud with normals are all given at once")
        if (values is None) != (self._values is None) and self.given:
            raise ValueError("points of a cloud with values need values, others must have none")
        new_values = None if values is None else _values(values, len(more))
        if self._values is None and new_values is not None:
            self._values = np.empty(0)
        total = self.given + len(more)
        regrown = total > len(self._points)
        if regrown:  # room for twice as many: points that come one by one are not copied each time
            self._points = _roomier(self._points, self.given, 2 * total)
            if self._values is not None:
                self._values = _roomier(self._values, self.given, 2 * total)
        self._points[self.given : total] = more
        if self._values is not None and new_values is not None:
            self._values[self.given : total] = new_values
        self.given = total
        low, high = _extent(more)
        self.corners = np.array([np.fmin(self.corners[0], low), np.fmax(self.corners[1], high)])
        if regrown and self._asked.limits is None:
            self._colour()

    def _colour(self) -> None:
        """Find the limits of the colours for the values there are now."""
        self.serial = next(_serials)
        self.colouring = self._asked
        """How values become colours, with limits that are known."""
        if self._values is not None:
            step = max(1, self.given // MEASURED_FOR_LIMITS)
            self.colouring = self._asked.limited(self._values[: self.given : step])


def _towards_camera(normals: NDArray[np.float32], points: NDArray[np.float32]) -> NDArray[np.float32]:
    """The normals; where one is unknown the direction to the camera that measured the point, which is the origin."""
    unknown = ~normals.any(axis=1)
    if not unknown.any():
        return normals
    known = normals.copy()
    known[unknown] = -points[unknown] / np.maximum(np.linalg.norm(points[unknown], axis=1, keepdims=True), 1e-6)
    return known


def as_points(points: ArrayLike, what: str = "points") -> Array:
    """Convert points to an array (N, 3) of float64; ValueError, naming `what`, for any other shape.

    Raises
    ------
    ValueError
        If the shape does not match; the message names `what`.
    """
    array = np.asarray(points, dtype=np.float64)
    if array.size == 0:
        return np.empty((0, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{what} have shape {array.shape}, not n × 3")
    return array


def finite_rows(points: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Compute flags (N,) of the points (N, 3) with three finite coordinates."""
    return np.asarray(np.isfinite(points).all(axis=1))


def _values(values: ArrayLike, count: int) -> Array:
    array = np.asarray(values, dtype=np.float64).ravel()
    if len(array) != count:
        raise ValueError(f"{len(array)} values for {count} points")
    return array


def _roomier(array: Array, used: int, room: int) -> Array:
    roomy: Array = np.empty((max(room, CHUNK), *array.shape[1:]))
    roomy[:used] = array[:used]
    return roomy


def _extent(points: Array) -> Array:
    """Smallest and largest coordinates (2, 3) of the finite points; NaN without any."""
    if len(points) and not np.isfinite(points.sum()):
        points = points[finite_rows(points)]
    if not len(points):
        return np.full((2, 3), np.nan)
    # Column by column: numpy reduces rows of three many times slower.
    return np.array([[column.min() for column in points.T], [column.max() for column in points.T]])
