"""Position of a hole, a pin or a ball to the part's datums, as the diameter of its tolerance zone.

The datums are the features the part's coordinates rest on. Of a sphere the zone is a sphere round the true place. Of a
cylinder it is a cylinder round the true axis, which goes through the true place along x, y or z, whichever is nearest;
what counts is the end, of the length that was scanned, that lies farther off.

References
----------
ISO 1101:2017, Geometrical tolerancing, 17.13. ISO 5458:2018, Pattern and combined geometrical specification.
ISO 5459:2011, Datums and datum systems.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.errors import InputError
from core.inspect.features.derived import elements_of
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.fit.elements import PARALLEL, Element
from core.inspect.fit.shapes import Sphere
from core.inspect.plan.alignment import NAME_OTHERS, three_two_one
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.temperature import correction_to_reference
from core.inspect.uncertainty.budget import budget_of
from core.messages import Message
from core.model.arrays import Array
from core.model.directions import square_to

STEP = 1e-4
"""Mm, or rad, by which datums are moved to see how coordinates follow them."""


def measure_position(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Twice the distance of a sphere's centre or a cylinder's axis from its true place.

    Raises
    ------
    InputError
        If the plan has no part coordinates, they rest on the feature itself, or it is neither sphere nor cylinder.
    """
    (element,) = elements_of(spec, scene)
    found, asked = scene.found[spec.of[0]], spec.position
    assert asked is not None
    if element.kind == "plane" or (element.kind == "point" and not isinstance(found.shape, Sphere)):
        raise InputError(
            Message("feature.position_of_other", "{name} is neither a cylinder nor a sphere", name=spec.of[0]),
            todo=Message("feature.advice_deviation", "compare a face with a nominal surface (deviation)"),
        )
    if scene.frame is None or scene.pose_camera_part is None:
        raise InputError(
            Message("feature.position_without_datums", "the plan has no part coordinates, whose datums it refers to"),
            todo=Message("feature.advice_frame", "say which features part coordinates rest on"),
        )
    if spec.of[0] in scene.frame.names:
        raise InputError(
            Message("feature.position_of_datum", "part coordinates rest on {name} itself", name=spec.of[0]),
            todo=NAME_OTHERS,
        )
    datums = [one.element for name in scene.frame.names if (one := scene.found[name]).element is not None]
    into_part, rule, true_axis = scene.pose_camera_part.inverse(), _RULE_BALL, None
    place, gradient = element.position, element.position_gradient
    if element.kind == "axis":
        rule, true_axis = _RULE_AXIS, int(np.argmax(np.abs(into_part.rotation @ element.direction)))
        along = (scene.cloud.points[found.indices] - element.position) @ element.direction
        ends = element.position + np.outer([along.min(), along.max()], element.direction)
        off = [np.linalg.norm(_off(into_part.apply(end), asked.at_mm, true_axis)) for end in ends]
        place = ends[int(np.argmax(off))]
        gradient = gradient + (along.min(), along.max())[int(np.argmax(off))] * element.direction_gradient
    at = into_part.apply(place)
    off_mm = _off(at, asked.at_mm, true_axis)
    distance = float(np.linalg.norm(off_mm))
    free = np.eye(3)[2] if true_axis is None else np.eye(3)[true_axis]
    towards = off_mm / distance if distance > PARALLEL else square_to(free)[:, 0]
    parts = [(2 * (towards @ into_part.rotation) @ gradient, element.effects)]
    for number, datum in enumerate(datums):
        moved, turned = _following(datums, number, place)
        parts.append(
            (2 * towards @ (moved @ datum.position_gradient + turned @ datum.direction_gradient), datum.effects)
        )
    value, rows, notes = 2 * distance, budget_of(parts), found.notes
    if scene.temperature is not None:
        change, more, said = correction_to_reference(2 * float(towards @ at), scene.temperature)
        value, rows, notes = value + change, (*rows, *more), (*notes, *said)
    row = scene.characteristic(spec, "position", abs(value), rows, rule=rule, notes=notes)
    return FeatureResult(spec, characteristics=(row,))


_RULE_AXIS = Message(
    "feature.rule_position_axis",
    "diameter of the cylinder round the true axis that holds the axis over the length that was scanned",
)
_RULE_BALL = Message(
    "feature.rule_position_ball", "diameter of the sphere round the true place that has the centre on it"
)


def _off(at: Array, true: Sequence[float], axis: int | None) -> Array:
    """From the true place (3,) to a place, both in part coordinates; only square to the true axis if there is one."""
    off: Array = at - np.asarray(true)
    if axis is not None:
        off[axis] = 0.0
    return off


def _following(datums: Sequence[Element], number: int, place: Array) -> tuple[Array, Array]:
    """How a place's part coordinates follow (3, 3) the position and (3, 3) the direction of one datum."""

    def coordinates(datum: Element) -> Array:
        moved = [*datums[:number], datum, *datums[number + 1 :]]
        found: Array = three_two_one(moved[0], moved[1], moved[2] if len(moved) > 2 else None).inverse().apply(place)
        return found

    def gradient(key: str) -> Array:
        lies: Array = getattr(datums[number], key)
        ends = [
            np.array([coordinates(replace(datums[number], **{key: lies + by})) for by in sign * STEP * np.eye(3)])
            for sign in (1.0, -1.0)
        ]
        follows: Array = (ends[0] - ends[1]).T / (2 * STEP)
        return follows

    return gradient("position"), gradient("direction")
