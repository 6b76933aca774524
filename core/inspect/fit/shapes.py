"""The surfaces that are fitted: signed distance of points, and how it follows the surface's few parameters.

All distances are positive outwards, where the camera sees the surface from. `design` holds by how much the surface
moves outwards at a point for a unit step of each parameter, so misfit ≈ design · step; `moved` takes that step. Steps
are in mm and rad about a place amid the points, so the parameters hardly hang together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from core.model.arrays import Array, frozen_array, set_field
from core.model.directions import square_to

Parts = NDArray[np.int64]


class Shape(Protocol):
    """Surface of p parameters; `part` (N,) tells points of several faces apart."""

    def misfit(self, points: Array, part: Parts) -> Array:
        """Compute the signed distances (N,) in mm of `points` (N, 3) from the surface, positive outside."""
        ...

    def outward(self, points: Array, part: Parts) -> Array:
        """Compute the outward unit normals (N, 3) of the surface at `points` (N, 3) in mm."""
        ...

    def design(self, points: Array, part: Parts) -> Array:
        """Compute the derivatives (N, p) of the surface's outward motion at `points` (N, 3) by its p parameters."""
        ...

    def moved(self, step: Array) -> Self:
        """Return the surface with its parameters changed by `step` (p,)."""
        ...

    def values(self) -> dict[str, Any]:
        """Return the surface's parameters in the camera frame, lengths in mm, under the names used in result files."""
        ...


S = TypeVar("S", bound=Shape)


def nearest_to(shape: S, points: Array, part: Parts, *, least: float | None = None) -> S:
    """Fit a shape to `points` (N, 3) in mm by unweighted least squares, starting from `shape`.

    What the points fix by less than `least` of what they fix best stays as it is; None: by rounding errors only.
    """
    for _ in range(10):
        design, misfit = shape.design(points, part), shape.misfit(points, part)
        step = np.linalg.lstsq(design, misfit, rcond=least)[0]
        size = float(np.abs(step).max())
        shape = shape.moved(np.asarray(step * min(1.0, 5.0 / max(size, 1e-12)), dtype=np.float64))
        if size < 1e-6:
            break
    return shape


@dataclass(frozen=True, eq=False, slots=True)
class ParallelPlanes:
    """Parallel faces: one outward unit normal `outward_normal` (3,), a point amid each of L faces `centres` (L, 3).

    Parameters: L heights along the normal at the centres, then a tilt about each of the `axes` (3, t), unit vectors
    square to the normal: two of them for faces, one for lines in a section.
    """

    outward_normal: Array
    centres: Array
    axes: Array

    def __post_init__(self) -> None:
        set_field(self, "outward_normal", frozen_array(self.outward_normal, (3,), "outward_normal"))
        set_field(self, "centres", frozen_array(self.centres, (None, 3), "centres"))
        set_field(self, "axes", frozen_array(self.axes, (3, None), "axes"))

    @classmethod
    def through(cls, normal: Array, centres: Array) -> ParallelPlanes:
        """Make parallel planes with the normal `normal` (3,) through `centres` (L, 3) in mm; both tilts are free."""
        return cls(normal, np.atleast_2d(centres), square_to(normal))

    @property
    def normal_gradient(self) -> Array:
        """Derivatives (3, p) of the common normal by the p parameters."""
        return np.hstack([np.zeros((3, len(self.centres))), self.axes])

    def misfit(self, points: Array, part: Parts) -> Array:
        distance: Array = self._away(points, part) @ self.outward_normal
        return distance

    def outward(self, points: Array, part: Parts) -> Array:
        return np.broadcast_to(self.outward_normal, points.shape)

    def design(self, points: Array, part: Parts) -> Array:
        height = (part[:, None] == np.arange(len(self.centres))).astype(np.float64)
        return np.hstack([height, -self._away(points, part) @ self.axes])

    def _away(self, points: Array, part: Parts) -> Array:
        """(N, 3) from the centre of each point's face; one for all is not looked up for each."""
        return points - (self.centres if len(self.centres) == 1 else self.centres[part])

    def moved(self, step: Array) -> ParallelPlanes:
        count = len(self.centres)
        centres = self.centres + step[:count, None] * self.outward_normal
        normal = self.outward_normal + self.axes @ step[count:]
        normal /= np.linalg.norm(normal)
        return ParallelPlanes(normal, centres, _turned(self.axes, normal))

    def values(self) -> dict[str, Any]:
        return {"normal": self.outward_normal, "centres": self.centres}

    def height(self, upper: int, lower: int) -> tuple[float, Array]:
        """Compute the distance in mm between the faces numbered `upper` and `lower`, and its gradient (p,)."""
        between = self.centres[upper] - self.centres[lower]
        gradient = np.concatenate([np.zeros(len(self.centres)), between @ self.axes])
        gradient[upper], gradient[lower] = 1.0, -1.0
        return float(between @ self.outward_normal), gradient


@dataclass(frozen=True, eq=False, slots=True)
class Sphere:
    """Sphere with the centre's three coordinates and the radius as parameters, in mm."""

    centre: Array
    radius: float

    def misfit(self, points: Array, part: Parts) -> Array:
        return np.asarray(np.linalg.norm(points - self.centre, axis=1) - self.radius)

    def outward(self, points: Array, part: Parts) -> Array:
        return _unit(points - self.centre)

    def design(self, points: Array, part: Parts) -> Array:
        return np.column_stack([self.outward(points, part), np.ones(len(points))])

    def moved(self, step: Array) -> Sphere:
        return Sphere(self.centre + step[:3], self.radius + float(step[3]))

    def values(self) -> dict[str, Any]:
        return {"centre": self.centre, "radius_mm": self.radius}


@dataclass(frozen=True, eq=False, slots=True)
class Cylinder:
    """Cylinder: `direction` (3,) unit, `centre` (3,) on its axis amid the points.

    Parameters: the axis moved along each of `axes` (3, 2), turned towards each of them (`turns`, else it keeps its
    direction: a circle in a section), and the radius.
    """

    centre: Array
    direction: Array
    axes: Array
    radius: float
    turns: bool = True

    @classmethod
    def along(cls, centre: Array, direction: Array, radius: float, *, turns: bool = True) -> Cylinder:
        """Make a cylinder from its centre (3,), direction (3,) and radius in mm; `turns`: its direction is free."""
        return cls(centre, direction, square_to(direction), radius, turns)

    @property
    def centre_gradient(self) -> Array:
        """Derivatives (3, p) of the axis' point `centre` by the p parameters."""
        return np.hstack([self.axes, np.zeros((3, 3 if self.turns else 1))])

    @property
    def direction_gradient(self) -> Array:
        """Derivatives (3, p) of the axis' direction by the p parameters."""
        return np.hstack([np.zeros((3, 2)), self.axes, np.zeros((3, 1))])

    def misfit(self, points: Array, part: Parts) -> Array:
        return np.asarray(np.linalg.norm(self._across(points), axis=1) - self.radius)

    def outward(self, points: Array, part: Parts) -> Array:
        return _unit(self._across(points))

    def design(self, points: Array, part: Parts) -> Array:
        aside = self.outward(points, part) @ self.axes
        along = (points - self.centre) @ self.direction
        columns = [aside, along[:, None] * aside] if self.turns else [aside]
        return np.column_stack([*columns, np.ones(len(points))])

    def moved(self, step: Array) -> Cylinder:
        centre = self.centre + self.axes @ step[:2]
        radius = self.radius + float(step[-1])
        if not self.turns:
            return replace(self, centre=centre, radius=radius)
        direction = self.direction + self.axes @ step[2:4]
        direction /= np.linalg.norm(direction)
        return Cylinder(centre, direction, _turned(self.axes, direction), radius)

    def values(self) -> dict[str, Any]:
        return {"centre": self.centre, "direction": self.direction, "radius_mm": self.radius}

    def _across(self, points: Array) -> Array:
        away = points - self.centre
        across: Array = away - (away @ self.direction)[:, None] * self.direction
        return across


def _turned(axes: Array, normal: Array) -> Array:
    """Axes (3, t) nearest to those given that are square to `normal` and to each other."""
    flat = axes - np.outer(normal, normal @ axes)
    left, _, right = np.linalg.svd(flat, full_matrices=False)
    return np.asarray(left @ right)


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1e-12)[:, None])
