"""Distances and angles of features measured before."""

from __future__ import annotations

from core.errors import InputError
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.fit.elements import Derived, Element, angle, distance
from core.inspect.plan.feature_spec import FeatureSpec
from core.messages import Message


def measure_distance(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure the distance in mm between two points, from a point to a plane or an axis, or between two planes."""
    a, b = elements_of(spec, scene)
    return derived_result(spec, scene, "distance", distance(a, b))


def measure_angle(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure the angle between two planes, two axes, or an axis and a plane."""
    return derived_result(spec, scene, "angle", angle(*directions_of(spec, scene)))


def derived_result(spec: FeatureSpec, scene: Scene, kind: str, found: Derived) -> FeatureResult:
    """Make the result of a feature that is computed from other features, with the notes on those features."""
    notes = tuple(note for name in dict.fromkeys(spec.of) for note in scene.found[name].notes)
    row = scene.characteristic(spec, kind, found.value, found.budget, rule=found.rule, notes=notes)
    return FeatureResult(spec, characteristics=(row,))


def elements_of(spec: FeatureSpec, scene: Scene) -> tuple[Element, ...]:
    """Collect the plane, axis or point of each feature that `spec` refers to; InputError if one was not measured."""
    elements = []
    for name in spec.of:
        element = scene.found[name].element
        if element is None:
            raise InputError(
                Message("feature.was_not_measured", "{name} was not measured", name=name),
                todo=Message("feature.advice_mend_first", "mend {name} first", name=name),
            )
        elements.append(element)
    return tuple(elements)


def directions_of(spec: FeatureSpec, scene: Scene) -> tuple[Element, Element]:
    """Collect the two planes or axes that `spec` refers to; InputError if one is a point or was not measured."""
    a, b = elements_of(spec, scene)
    if "point" in (a.kind, b.kind):
        raise InputError(
            Message("feature.point_has_no_direction", "a point has no direction, so there is no angle to it"),
            todo=Message("feature.advice_name_planes", "name planes or cylinders"),
        )
    return a, b
