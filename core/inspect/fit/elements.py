"""Points, planes and axes that features are derived from: their place and direction, and how sure they are.

Of each the gradient by the fitted parameters is kept with what acts on these, so that a distance or an angle of two
features of one scan has its true uncertainty: light planes and calibrations err in both at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from core.inspect.fit.shapes import Cylinder, ParallelPlanes, Sphere
from core.inspect.fit.surface_fit import SurfaceFit
from core.inspect.results import Contribution
from core.inspect.uncertainty.budget import Effect, budget_of
from core.messages import Message
from core.model.arrays import Array
from core.model.directions import square_to

PARALLEL = 1e-9
"""Sine of an angle, or a distance in mm, below which a direction is not known from it."""


@dataclass(frozen=True, eq=False, slots=True)
class Element:
    """Plane, axis or point, with the derivatives of its place and direction by the parameters of the surface fitted.

    Parameters
    ----------
    kind
        "plane": position amid its points, direction outwards. "axis": position amid its points, direction along it.
        "point": its direction is that of the surface it was taken from.
    position, direction
        (3,) in mm in the camera frame; unit.
    position_gradient, direction_gradient
        (3, p) by the fitted parameters.
    effects
        What acts on these.
    """

    kind: Literal["plane", "axis", "point"]
    position: Array
    direction: Array
    position_gradient: Array
    direction_gradient: Array
    effects: tuple[Effect, ...]

    @classmethod
    def of_plane(cls, fit: SurfaceFit[ParallelPlanes], kind: Literal["plane", "point"] = "plane") -> Element:
        """Make the element, place and direction with derivatives, of a fitted plane face or the point in its middle."""
        levels = fit.shape
        gradient = levels.normal_gradient
        along = np.zeros_like(gradient)
        along[:, 0] = levels.outward_normal
        return cls(kind, levels.centres[0], levels.outward_normal, along, gradient, fit.effects)

    @classmethod
    def of_sphere(cls, fit: SurfaceFit[Sphere]) -> Element:
        """Make the element, place with derivatives, of a fitted sphere: its centre as a point."""
        gradient = np.hstack([np.eye(3), np.zeros((3, 1))])
        away = fit.shape.centre / np.linalg.norm(fit.shape.centre)
        return cls("point", fit.shape.centre, -away, gradient, np.zeros((3, 4)), fit.effects)

    @classmethod
    def of_cylinder(cls, fit: SurfaceFit[Cylinder]) -> Element:
        """Make the element, place and direction with derivatives, of a fitted cylinder: its axis."""
        tube = fit.shape
        return cls("axis", tube.centre, tube.direction, tube.centre_gradient, tube.direction_gradient, fit.effects)


class Derived(NamedTuple):
    """Quantity of two elements: `value` in mm or rad, the budget of its uncertainty, and the rule it is measured by."""

    value: float
    budget: tuple[Contribution, ...]
    rule: Message


def distance(a: Element, b: Element) -> Derived:
    """Compute the distance in mm between two elements (plane, axis or point), with its uncertainty budget.

    From a plane square to it, from an axis square to it, from a point straight. Of two of which one is a plane (else an
    axis), the distance is that of the other's place from it; of two planes, of the first one's middle from the second.
    """
    rank = {"plane": 2, "axis": 1, "point": 0}
    if rank[a.kind] > rank[b.kind]:
        a, b = b, a
    between = a.position - b.position
    of_direction = np.zeros(3)
    if b.kind == "plane":
        length = float(between @ b.direction)
        sign = 1.0 if length >= 0 else -1.0
        length, towards, of_direction = abs(length), sign * b.direction, sign * between
        rule = Message("feature.rule_from_plane", "distance square to the plane")
    else:
        along = float(between @ b.direction) if b.kind == "axis" else 0.0
        across = between - along * b.direction if b.kind == "axis" else between
        length = float(np.linalg.norm(across))
        towards = across / length if length > PARALLEL else square_to(b.direction)[:, 0]
        of_direction = -along * towards
        rule = (
            Message("feature.rule_from_axis", "distance square to the axis")
            if b.kind == "axis"
            else Message("feature.rule_two_points", "distance of two points")
        )
    second = -towards @ b.position_gradient + of_direction @ b.direction_gradient
    rows = budget_of([(towards @ a.position_gradient, a.effects), (second, b.effects)])
    return Derived(length, rows, rule)


def angle(a: Element, b: Element) -> Derived:
    """Compute the angle in rad, 0 to π/2, between two planes, two axes or an axis and a plane, and its uncertainty."""
    first, second = a.direction, b.direction
    second = second if first @ second >= 0 else -second
    flip = 1.0 if second is b.direction else -1.0
    cosine = float(np.clip(first @ second, -1.0, 1.0))
    across = second - cosine * first
    sine = float(np.linalg.norm(across))
    turn_a = across / sine if sine > PARALLEL else square_to(first)[:, 0]
    turn_b = first - cosine * second
    turn_b = turn_b / sine if sine > PARALLEL else -turn_a
    rows = budget_of([(-turn_a @ a.direction_gradient, a.effects), (-flip * turn_b @ b.direction_gradient, b.effects)])
    value = float(np.arctan2(sine, cosine))
    if {a.kind, b.kind} == {"plane", "axis"}:
        return Derived(np.pi / 2 - value, rows, Message("feature.rule_axis_plane", "angle of an axis and a plane"))
    if a.kind == "plane":
        return Derived(value, rows, Message("feature.rule_two_planes", "angle of two planes, 0 to 90°"))
    return Derived(value, rows, Message("feature.rule_two_axes", "angle of two axes, 0 to 90°"))
