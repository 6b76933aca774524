"""Position of a hole, a pin or a ball to the part's datums, as the diameter of its tolerance zone.

The datums are the features the part's coordinates rest on. Of a sphere the zone is a sphere round the true place. Of a
cylinder it is a cylinder round the true axis, which goes through the true place along x, y or z, whichever is nearest;
what counts is the end, of the length that was scanned, that lies farther off. Along a direction that no datum fixes the
zone is free, as ISO 5459 has it.

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
from core.inspect.plan.alignment import NAME_OTHERS, three_two_one, unfixed
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.temperature import correction_to_reference
from core.inspect.uncertainty.budget import budget_of
from core.messages import Message
from core.model.arrays import Array

STEP = 1e-4
"""Mm, or rad, by which datums are moved to see how coordinates follow them."""


def measure_position(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure the position of a sphere or a cylinder: twice the distance in mm of its centre or axis from nominal.

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
    into_part, true_place = scene.pose_camera_part.inverse(), np.asarray(asked.at_mm)
    fixed = np.ones(3)
    if (free := unfixed(datums[1], datums[2] if len(datums) > 2 else None)) is not None:
        fixed[free] = 0.0
    rule, ends = _RULE_BALL, np.zeros(1)
    if element.kind == "axis":
        rule = _RULE_AXIS
        fixed[np.argmax(np.abs(into_part.rotation @ element.direction))] = 0.0
        along = (scene.cloud.points[found.indices] - element.position) @ element.direction
        ends = np.array([along.min(), along.max()])
    off_ends = [fixed * (into_part.apply(element.position + end * element.direction) - true_place) for end in ends]
    worst = int(np.argmax(np.linalg.norm(off_ends, axis=1)))
    off_mm, end = off_ends[worst], ends[worst]
    place = element.position + end * element.direction
    gradient = element.position_gradient + end * element.direction_gradient
    at = into_part.apply(place)
    distance = float(np.linalg.norm(off_mm))
    towards = off_mm / distance if distance > PARALLEL else np.eye(3)[np.argmax(fixed)]
    parts = [(2 * (towards @ into_part.rotation) @ gradient, element.effects)]
    for number, datum in enumerate(datums):
        moved, turned = _following(datums, number, place)
        parts.append(
            (2 * towards @ (moved @ datum.position_gradient + turned @ datum.direction_gradient), datum.effects)
        )
    value, rows, notes, at_20 = 2 * distance, budget_of(parts), found.notes, False
    if scene.temperature is not None:
        change, more, said = correction_to_reference(2 * float(towards @ at), scene.temperature)
        value, rows, notes = value + change, (*rows, *more), (*notes, *said)
        at_20 = not scene.temperature.celsius_assumed
    row = scene.characteristic(spec, "position", abs(value), rows, rule=rule, notes=notes)
    return FeatureResult(spec, characteristics=(replace(row, at_20=at_20),))


_RULE_AXIS = Message(
    "feature.rule_position_axis",
    "diameter of the cylinder round the true axis that holds the axis over the length that was scanned",
)
_RULE_BALL = Message(
    "feature.rule_position_ball", "diameter of the sphere round the true place that has the centre on it"
)


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
