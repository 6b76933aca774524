"""What was measured as geometry for CAD: outlines of planes, spheres, cylinders and section curves, in mm.

A plane has no end: its outline is the convex hull of the points it rests on, laid into it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from core.inspect.profile import averaged
from core.inspect.shown.view_frame import FrameKind
from core.model import Pose
from core.model.arrays import Array

LONGEST_GAP = 10.0
"""Steps without a point that a section's curve goes across; a longer gap, as a shadow, parts it."""


@dataclass(frozen=True, eq=False, slots=True)
class Outline:
    """Outline of a plane face: corners (n, 3) in mm, once round."""

    name: str
    corners: Array


@dataclass(frozen=True, eq=False, slots=True)
class SphereShape:
    """Sphere: its centre (3,) and radius, in mm."""

    name: str
    centre: Array
    radius: float


@dataclass(frozen=True, eq=False, slots=True)
class CylinderShape:
    """Cylinder as far as it was measured: both ends (2, 3) of its axis, and its radius, in mm."""

    name: str
    ends: Array
    radius: float


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """Piece of a section: places (n, 3) in mm, n ≥ 2, along it."""

    name: str
    places: Array


Shape: TypeAlias = Outline | SphereShape | CylinderShape | Curve


@dataclass(frozen=True, eq=False, slots=True)
class Geometry:
    """Shapes to be drawn, in coordinates of a `frame` of that kind."""

    drawn: tuple[Shape, ...]
    frame: FrameKind


def outlines(name: str, normal: Array, centres: Array, points: Array) -> list[Outline]:
    """Compute the convex outlines of planes square to `normal` (3,) through `centres` (c, 3) by their points."""
    away = np.abs((points[:, None] - centres[None]) @ normal)
    nearest = np.argmin(away, axis=1)
    across = np.linalg.svd(normal[None])[2][1:]
    made = []
    for number, centre in enumerate(centres):
        flat = (points[nearest == number] - centre) @ across.T
        try:
            corners = flat[ConvexHull(flat).vertices]
        except (QhullError, ValueError):  # too few points, or all on one line
            continue
        made.append(Outline(name, centre + corners @ across))
    return made


def cylinder(name: str, centre: Array, direction: Array, radius: float, points: Array) -> CylinderShape:
    """Make the shape of a cylinder, as long as its points (n, 3), n ≥ 1, reach along the axis; lengths in mm."""
    along = (points - centre) @ direction
    return CylinderShape(name, centre + np.outer([along.min(), along.max()], direction), radius)


def curves(name: str, origin: Array, axes: Array, profile: Array, step_mm: float) -> list[Curve]:
    """Compute the mean curve of a section, in pieces, from positions and heights along `axes` (2, 3), in mm."""
    position, height = averaged(profile[:, 0], profile[:, 1], step_mm)
    ends = np.flatnonzero(np.diff(position) > LONGEST_GAP * step_mm) + 1
    places = origin + np.column_stack([position, height]) @ axes
    return [Curve(name, piece) for piece in np.split(places, ends) if len(piece) > 1]


def moved(drawn: Sequence[Shape], pose: Pose) -> list[Shape]:
    """Transform shapes by a pose, in mm."""
    made: list[Shape] = []
    for one in drawn:
        match one:
            case Outline():
                made.append(Outline(one.name, pose.apply(one.corners)))
            case SphereShape():
                made.append(SphereShape(one.name, pose.apply(one.centre[None])[0], one.radius))
            case CylinderShape():
                made.append(CylinderShape(one.name, pose.apply(one.ends), one.radius))
            case Curve():
                made.append(Curve(one.name, pose.apply(one.places)))
    return made
