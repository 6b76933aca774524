"""Distances and angles of features measured before."""

from __future__ import annotations

from core.errors import InputError
from core.inspect.elements import Element, angle, distance
from core.inspect.feature_spec import FeatureSpec
from core.inspect.features.measured import FeatureResult, Scene


def measure_distance(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Distance of two points, of a point from a plane or an axis, of a plane's middle from another plane."""
    value, rows, rule = distance(*_elements(spec, scene))
    return FeatureResult(spec, characteristics=(scene.characteristic(spec, "distance", value, rows, rule=rule),))


def measure_angle(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Angle of two planes, two axes, or an axis and a plane."""
    a, b = _elements(spec, scene)
    if "point" in (a.kind, b.kind):
        raise InputError("a point has no direction, so there is no angle to it", todo="name planes or cylinders")
    value, rows, rule = angle(a, b)
    return FeatureResult(
        spec, characteristics=(scene.characteristic(spec, "angle", value, rows, rule=rule, angle=True),)
    )


def _elements(spec: FeatureSpec, scene: Scene) -> tuple[Element, Element]:
    a, b = (scene.found[name].element for name in spec.of)
    if a is None or b is None:
        missing = spec.of[0] if a is None else spec.of[1]
        raise InputError(f"{missing} was not measured", todo=f"mend {missing} first")
    return a, b
