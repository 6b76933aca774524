"""The cloud as the 3D view holds it: shuffled once and cut into chunks, so that any few chunks are a fair sample.

Chunks are gathered and coloured when they are first drawn: a cloud of millions is taken over in a few milliseconds,
and a growing one is never copied as a whole while it is being watched.
"""

from __future__ import annotations

from itertools import count

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.model.arrays import Array
from workbench.views.scene_view_colours import Colouring

CHUNK = 25_000
"""Points in a chunk."""

SEED, BLOCK = 20230, 65_536
"""The shuffle is one random order of a block, used for every block of so many points."""

MEASURED_FOR_LIMITS = 100_000
"""So many values are looked at for the ends of the colour bar."""


_serials = count()


class SceneCloud:
    """Points with their colours.

    `serial` tells clouds apart, `generation` changes when all chunks do, `version(k)` when points were added to
    chunk k.
    """

    def __init__(self, points: ArrayLike, values: ArrayLike | None, colouring: Colouring) -> None:
        self._points: Array = _checked(points)
        self._values: Array | None = None if values is None else _values(values, len(self._points))
        self._colouring = colouring
        self._given = len(self._points)
        self.serial, self.generation = next(_serials), 0
        self._shuffle()
        self._widen(self._points)

    # ---- what there is

    @property
    def given(self) -> int:
        """Points that were given."""
        return self._given

    @property
    def points(self) -> Array:
        """All points (N, 3) as given, in mm."""
        return self._points[: self._given]

    @property
    def colouring(self) -> Colouring:
        """How values become colours, with limits that are known."""
        return self._limited

    @property
    def chunks(self) -> int:
        """How many chunks there are."""
        return -(-self.drawn // CHUNK)

    @property
    def drawn(self) -> int:
        """Points that can be drawn: those that are finite."""
        return len(self._order) + self._given - self._ordered

    @property
    def corners(self) -> Array:
        """Two opposite corners (2, 3) of the box round all points; NaN when there are none."""
        return np.array([self._low, self._high])

    def version(self, chunk: int) -> int:
        """How many points are in a chunk: all that can change within one generation."""
        return min(self.drawn - chunk * CHUNK, CHUNK)

    def sample(self, at_most: int = 20_000) -> Array:
        """A fair sample (n, 3) of the points."""
        chunks = self.spread(8) if self.drawn else []
        each = at_most // max(len(chunks), 1)
        parts = [self.indices(k)[-each:] for k in chunks]  # the ends: in the last chunk those are the newest
        some: Array = self._points[np.concatenate(parts)] if parts else np.empty((0, 3))
        return some

    def spread(self, chunks: int) -> list[int]:
        """So many chunks, evenly over all: those added last are in no random order yet."""
        if chunks >= self.chunks:
            return list(range(self.chunks))
        return sorted({int(k) for k in np.linspace(0, self.chunks - 1, max(chunks, 1))})

    def indices(self, chunk: int) -> NDArray[np.int64]:
        """Which of the given points are in a chunk."""
        start, stop = chunk * CHUNK, min((chunk + 1) * CHUNK, self.drawn)
        shuffled = self._order[start:stop].astype(np.int64)
        tail = np.arange(max(start, len(self._order)), stop) - len(self._order) + self._ordered
        return np.concatenate([shuffled, tail]) if len(tail) else shuffled

    def chunk(self, number: int) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        """Points (n, 3) in mm and colours (n, 3) of a chunk."""
        indices = self.indices(number)
        points = self._points[indices].astype(np.float32)
        if self._values is not None:
            return points, self._limited.of(self._values[indices])
        return points, self._limited.plain(indices)

    # ---- growing

    def add(self, points: ArrayLike, values: ArrayLike | None) -> None:
        """Append points; those that are not finite are given a number but never drawn."""
        more = _checked(points)
        if not len(more):
            return
        if (values is None) != (self._values is None) and self._given:
            raise ValueError("points of a cloud with values need values, others must have none")
        new_values = None if values is None else _values(values, len(more))
        if self._values is None and new_values is not None:
            self._values = np.empty(0)
        total = self._given + len(more)
        regrown = total > len(self._points)
        if regrown:
            self._points = _roomier(self._points, self._given, total)
            if self._values is not None:
                self._values = _roomier(self._values, self._given, total)
        self._points[self._given : total] = more
        if self._values is not None and new_values is not None:
            self._values[self._given : total] = new_values
        self._given = total
        self._widen(more)
        if regrown or not np.isfinite(more.sum()):
            self._shuffle()

    def recolour(self, colouring: Colouring) -> None:
        """Show the values otherwise."""
        self._colouring = colouring
        self._limit()
        self.generation += 1

    # ---- inside

    def _shuffle(self) -> None:
        """A new random order of all finite points, and limits that hold for them."""
        self._order = _shuffled(self._given)
        points = self.points
        if not np.isfinite(points.sum()):
            self._order = self._order[finite_rows(points)[self._order]]
        self._ordered = self._given
        self._limit()
        self.generation += 1

    def _limit(self) -> None:
        if self._values is None:
            self._limited = self._colouring
            return
        some = self._values[self._order[:MEASURED_FOR_LIMITS]]
        self._limited = self._colouring.limited(some)

    def _widen(self, points: Array) -> None:
        low, high = _extent(points)
        if not hasattr(self, "_low"):
            self._low, self._high = low, high
        else:
            self._low, self._high = np.fmin(self._low, low), np.fmax(self._high, high)


def finite_rows(points: Array) -> NDArray[np.bool_]:
    """Which points (N, 3) have three finite coordinates."""
    return np.asarray(np.isfinite(points).all(axis=1))


def _checked(points: ArrayLike) -> Array:
    array = np.asarray(points, dtype=np.float64)
    if array.size == 0:
        return np.empty((0, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"points have shape {array.shape}, not n × 3")
    return array


def _values(values: ArrayLike, count: int) -> Array:
    array = np.asarray(values, dtype=np.float64).ravel()
    if len(array) != count:
        raise ValueError(f"{len(array)} values for {count} points")
    return array


def _roomier(array: Array, used: int, needed: int) -> Array:
    """A copy with room for twice what is needed."""
    roomy: Array = np.empty((max(2 * needed, CHUNK), *array.shape[1:]))
    roomy[:used] = array[:used]
    return roomy


def _shuffled(count: int) -> NDArray[np.int32]:
    """All numbers below `count` in an order of which every beginning is spread over the whole."""
    block = min(BLOCK, max(count, 1))
    table = np.random.default_rng(SEED).permutation(block).astype(np.int32)
    starts = np.arange(0, count, block, dtype=np.int32)
    order: NDArray[np.int32] = (table[:, None] + starts[None, :]).ravel()
    return order[order < count]


def _extent(points: Array) -> tuple[Array, Array]:
    """Smallest and largest coordinates of the finite points, (3,) each; NaN without any."""
    if not len(points):
        return np.full(3, np.nan), np.full(3, np.nan)
    if not np.isfinite(points.sum()):
        points = points[finite_rows(points)]
        return _extent(points)
    # Long rows are reduced many times faster than rows of three.
    side = 128
    whole = len(points) // side * side
    wide, rest = np.ascontiguousarray(points[:whole]).reshape(-1, 3 * side), points[whole:]
    low = [array for array in (wide.min(axis=0).reshape(-1, 3) if whole else None, rest) if array is not None]
    high = [array for array in (wide.max(axis=0).reshape(-1, 3) if whole else None, rest) if array is not None]
    return np.concatenate(low).min(axis=0), np.concatenate(high).max(axis=0)
