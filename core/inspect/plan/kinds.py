"""The kinds of features there are. A new kind is an entry here, its fit in `core.inspect.features`, and its test.

Wings and other packages bring kinds of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import TypeGuard

from core.door import Brought, Origin
from core.inspect.characteristic import Characteristic
from core.inspect.plan.feature_kind import ChoiceField, ElementKind, FeatureKind, NumberField, ResultKind, TextField
from core.inspect.plan.feature_spec import FeatureSpec
from core.messages import Message, label
from core.wing import OUR_KINDS, rows_of_wings

MOST_FACES = 8
"""Plane faces found by their number, and levels of steps: `core.inspect.fit.plane_search` looks for as many."""
WIDEST_MM = 5000.0
"""Lengths in forms go up to here: no rig sees farther."""

FILTERS: tuple[NumberField, ...] = (
    NumberField(
        "sigma_max_mm", label("σ up to"), label("Points with a larger standard uncertainty are left out."),
        "mm", 0.0001, WIDEST_MM, 4, 0.01, none=label("any"), first=0.1,
    ),
    NumberField(
        "margin_mm", label("Margin at edges"), label("Points so near to a plane face's edge are left out."),
        "mm", 0.0, 100.0, 2, 0.1,
    ),
    NumberField(
        "outliers", label("Outliers beyond"), label("Robust standard deviations from the fit; 4.685 is usual."),
        "σ", 2.0, 100.0, 3, 0.5,
    ),
    NumberField(
        "cell_mm", label("Form from"), label("Shorter forms count as noise; 0: a fifth of the face."),
        "mm", 0.0, 100.0, 2, 0.5,
    ),
)  # fmt: skip
"""Which points of their regions features use: in the form of every kind that is not made of others."""

_SECTION = (
    NumberField(
        "half_width_mm", label("Half width"), label("Points so near to the cut are taken for points in it."),
        "mm", 0.01, WIDEST_MM, 2, 0.1,
    ),
    NumberField(
        "step_mm", label("Profile in steps of"), label("The profile drawn is averaged over so much."),
        "mm", 0.01, WIDEST_MM, 2, 0.1,
    ),
)  # fmt: skip
_DIAMETER = ResultKind(label("diameter"), expands=True)
_FORM = ResultKind(label("form"), one_sided=True)
_HEIGHT = ResultKind(label("height"), expands=True)
_DISTANCE = ResultKind(label("distance"), expands=True)

WITH_DIRECTION: tuple[ElementKind, ...] = ("plane", "axis")
"""What an angle can be measured from."""

KINDS: tuple[FeatureKind, ...] = (
    FeatureKind(
        "plane",
        "core.inspect.features.plane:measure_plane",
        label("Plane, flatness"),
        label("A plane fitted to a face: its flatness, and what other features are measured from"),
        "mdi6.square-outline",
        results=(ResultKind(label("flatness"), one_sided=True, symbol="flatness"),),
        element="plane",
        automatic="numbered",
    ),
    FeatureKind(
        "sphere",
        "core.inspect.features.round:measure_sphere",
        label("Sphere, diameter"),
        label("A sphere fitted robustly: its diameter and form"),
        "mdi6.sphere",
        results=(_DIAMETER, _FORM),
        element="point",
    ),
    FeatureKind(
        "cylinder",
        "core.inspect.features.round:measure_cylinder",
        label("Cylinder, diameter"),
        label("A cylinder fitted robustly: its diameter and form"),
        "mdi6.cylinder",
        results=(_DIAMETER, replace(_FORM, symbol="cylindricity")),
        element="axis",
    ),
    FeatureKind(
        "point",
        "core.inspect.features.plane:measure_point",
        label("Point"),
        label("The middle of a small region, on the surface: something to measure distances from"),
        "mdi6.crosshairs",
        element="point",
        automatic="numbered",
    ),
    FeatureKind(
        "thickness",
        "core.inspect.features.thickness:measure_thickness",
        label("Thickness of two faces"),
        label("The distance of two parallel faces, as the thickness above, with regions of its own"),
        "mdi6.ruler-square",
        results=(ResultKind(label("thickness"), expands=True),),
        automatic="numbered",
        most_regions=2,
        part_titles=(label("Upper face"), label("Lower face")),
    ),
    FeatureKind(
        "steps",
        "core.inspect.features.steps:measure_steps",
        label("Step heights"),
        label("The heights of many parallel faces over the lowest or the previous one"),
        "mdi6.stairs",
        results=(ResultKind(label("height"), expands=True, numbered=True),),
        automatic="numbered",
        most_regions=MOST_FACES,
        fields=(
            ChoiceField(
                "over",
                label("Heights over"),
                label("From which level each height is measured."),
                (("lowest", label("the lowest")), ("previous", label("the previous"))),
            ),
            TextField(
                "nominal_heights",
                label("Nominal heights in mm"),
                label("From the lowest up, with semicolons; empty: no verdict."),
                "10; 20; 30",
            ),
        ),
    ),
    FeatureKind(
        "distance",
        "core.inspect.features.derived:measure_distance",
        label("Distance of two features"),
        label("Point to point, or point to plane, of two features that are in the list"),
        "mdi6.arrow-expand-horizontal",
        results=(_DISTANCE,),
        made_of=2,
    ),
    FeatureKind(
        "angle",
        "core.inspect.features.derived:measure_angle",
        label("Angle of two features"),
        label("Between the planes or axes of two features that are in the list"),
        "mdi6.angle-acute",
        results=(ResultKind(label("angle"), "angle"),),
        made_of=2,
        made_from=WITH_DIRECTION,
    ),
    FeatureKind(
        "section",
        "core.inspect.features.section:measure_section",
        label("Cross-section"),
        label("A profile across the surface, with heights, distances and radii measured in it"),
        "mdi6.chart-line-variant",
        results=(_HEIGHT, _DISTANCE, ResultKind(label("radius"), expands=True)),
        automatic="all points",
        settings="section",
        fields=_SECTION,
        plotted=True,
    ),
)


def kind_of(spec: FeatureSpec) -> FeatureKind:
    """Find the feature kind of a plan's feature by its `kind`; KeyError if there is none of that name."""
    return kind_named(spec.kind)


def kind_named(name: str) -> FeatureKind:
    """Find the feature kind called `name`, built in or brought; KeyError if there is none.

    One of our own wing that is not there is a `missing` kind.
    """
    own = {kind.name: kind for kind in KINDS}
    if name in own:
        return own[name]
    if name in OUR_KINDS and name not in brought_kinds():
        return _missing(name)
    return brought_kinds()[name][0]


def every_kind() -> tuple[FeatureKind, ...]:
    """Return all feature kinds: the built-in ones, then those from wings and other packages."""
    return (*KINDS, *(kind for kind, _ in brought_kinds().values()))


def brought_kinds() -> Mapping[str, tuple[FeatureKind, Origin | None]]:
    """Find the feature kinds from wings and other packages, by name, except names that are taken.

    With each is the package it comes from; None: the program itself.
    """
    from core.inspect.plan.plugins import plugins  # looking for packages takes time that most never need

    taken = {*(kind.name for kind in KINDS), *OUR_KINDS, *_of_wings()[0]}
    others = {name: brought for name, brought in plugins().kinds.items() if name not in taken}
    return {**_of_wings()[0], **others}


def unusable_kinds() -> tuple[Brought, ...]:
    """What wings name as kinds of features and cannot be used."""
    return _of_wings()[1]


@cache
def _of_wings() -> tuple[Mapping[str, tuple[FeatureKind, Origin | None]], tuple[Brought, ...]]:
    taken = {kind.name for kind in KINDS}
    return rows_of_wings(lambda wing: wing.feature_kinds, _is_kind, lambda kind: kind.name, taken, _why_unusable)


def _is_kind(row: object) -> TypeGuard[FeatureKind]:
    return isinstance(row, FeatureKind)


def _why_unusable(name: str) -> Message:
    if not name:
        return Message("plugin.why_no_feature_kind", "one of its kinds of features is no FeatureKind")
    return Message("plugin.why_kind_taken", "the name of its kind of feature {name} is taken", name=name)


def _missing(name: str) -> FeatureKind:
    """The kind of a wing that is not there: plans keep its features, and none is measured."""
    return FeatureKind(
        name,
        "core.inspect.features.missing:measure_missing",
        label("Feature of a wing that is not there"),
        label("It stays in the plan as it is, and is not measured"),
        "mdi6.puzzle-remove-outline",
        missing=True,
    )


def results_of(spec: FeatureSpec) -> Mapping[str, ResultKind]:
    """Return the kind of each result of a feature, by the result's name; a section's results are its cuts."""
    kind = kind_of(spec)
    if kind.settings == "section" and spec.section is not None:
        return {cut.name: kind.result(cut.kind) for cut in spec.section.cuts}
    return {result.name: result for result in kind.results}


def expanding() -> frozenset[str]:
    """Return the names of the results of all feature kinds that grow with the part's temperature."""
    return frozenset(result.name for kind in every_kind() for result in kind.results if result.expands)


def expands(characteristic: Characteristic) -> bool:
    """Whether a characteristic is a length that grows with the part's temperature, and no angle or form deviation."""
    return characteristic.kind in expanding() and characteristic.quantity == "length"
