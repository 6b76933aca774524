"""Parallelism and perpendicularity of a face or an axis to a datum, as widths of their tolerance zones.

Of a face: the distance of two planes in the direction the datum gives that hold 95 % of its points, as flatness is that
in the best direction. Of an axis: how far it leaves that direction over the length of it that was scanned; the zone of
an axis parallel to an axis, or perpendicular to a plane, is a cylinder, that of the other two lies between planes. The
datum is the plane or the axis fitted, its own form left aside.

References
----------
ISO 1101:2017, Geometrical tolerancing, 17.11 and 17.12. ISO 5459:2011, Datums and datum systems.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.errors import InputError
from core.inspect.features.derived import derived_result, directions_of
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.fit.elements import Derived, Element, angle
from core.inspect.fit.surface_fit import range_of
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.uncertainty.budget import budget_of, effects
from core.inspect.uncertainty.error_sources import Sources
from core.inspect.uncertainty.point_errors import patches
from core.messages import Message

MOST_ASKEW = np.pi / 4
"""Rad from the direction asked for: what lies farther off was meant for the other tolerance, or for another datum."""


def measure_parallelism(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure the parallelism of a feature to a second one, its datum, as the width of the tolerance zone in mm.

    InputError if one of them is a point or was not measured, or they lie more than 45° from parallel.
    """
    return _measured(spec, scene, 0.0)


def measure_perpendicularity(spec: FeatureSpec, scene: Scene) -> FeatureResult:
    """Measure the perpendicularity of a feature to a second one, its datum, as the width of the tolerance zone in mm.

    InputError if one of them is a point or was not measured, or they lie more than 45° from perpendicular.
    """
    return _measured(spec, scene, np.pi / 2)


def _measured(spec: FeatureSpec, scene: Scene, asked: float) -> FeatureResult:
    """The zone's width of a feature that should lie at 0 or π/2 to its datum."""
    item, datum = directions_of(spec, scene)
    lies = angle(item, datum)
    if abs(lies.value - asked) > MOST_ASKEW:
        raise InputError(
            Message(
                "feature.far_from_direction",
                "{name} lies at {angle_deg:.0f}° to {datum}",
                name=spec.of[0],
                angle_deg=np.degrees(lies.value),
                datum=spec.of[1],
            ),
            todo=Message("feature.advice_other_datum", "choose another datum, or the other kind of tolerance"),
        )
    found = scene.found[spec.of[0]]
    zone = (
        _of_axis(item, found, scene, lies, asked) if item.kind == "axis" else _of_face(item, datum, found, scene, asked)
    )
    return derived_result(spec, scene, spec.kind, zone)


def _of_face(item: Element, datum: Element, found: FeatureResult, scene: Scene, asked: float) -> Derived:
    cloud = scene.cloud.select(found.indices)
    normal, direction = item.direction, datum.direction
    along = float(normal @ direction)
    # The zone's planes are square to the datum's direction, or they contain it and turn about it as the face does best.
    square = (datum.kind == "plane") == (asked == 0.0)
    across = np.sign(along) * direction if square else normal - along * direction
    across = across / np.linalg.norm(across)
    heights = (cloud.points - item.position) @ across
    width = range_of(cloud, heights, found.spec.filters.cell_mm)
    between = width.weight @ cloud.points  # from the lowest to the highest
    turned = np.sign(along) * between if square else -(between @ direction) * across
    one = np.zeros(len(cloud), dtype=np.int64)
    normals = np.broadcast_to(across, cloud.points.shape)
    sources = Sources.of(cloud, normals, np.ones(len(cloud)), one, patches(cloud.uv, one), scene.errors)
    gain = np.asarray(np.bincount(sources.stretch, width.weight, minlength=len(sources.own)), dtype=np.float64)
    acting = effects(gain[None, :], sources, calibrations=scene.errors.calibrations)
    rows = budget_of([(np.ones(1), acting), (turned @ datum.direction_gradient, datum.effects)])
    rule = (
        Message(
            "feature.rule_parallel_face",
            "width of the zone parallel to the datum that holds 95 % of the face's points, or of its cells' means",
        )
        if asked == 0.0
        else Message(
            "feature.rule_perpendicular_face",
            "width of the zone perpendicular to the datum that holds 95 % of the face's points, or of its cells' means",
        )
    )
    return Derived(width.value, (width.sampling, *rows), rule)


def _of_axis(item: Element, found: FeatureResult, scene: Scene, lies: Derived, asked: float) -> Derived:
    length = float(np.ptp(scene.cloud.points[found.indices] @ item.direction))
    askew = abs(lies.value - asked)
    rule = (
        Message(
            "feature.rule_parallel_axis",
            "how far the axis is from parallel to the datum over the {length_mm:.1f} mm of it that were scanned",
            length_mm=length,
        )
        if asked == 0.0
        else Message(
            "feature.rule_perpendicular_axis",
            "how far the axis is from perpendicular to the datum over the {length_mm:.1f} mm of it that were scanned",
            length_mm=length,
        )
    )
    rows = tuple(replace(row, u_mm=length * np.cos(askew) * row.u_mm) for row in lies.budget)
    return Derived(length * float(np.sin(askew)), rows, rule)
