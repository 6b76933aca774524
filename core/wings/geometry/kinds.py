"""The kinds of features that the wing measures: orientation, position, deviation. Light to import."""

from __future__ import annotations

from core.inspect.plan.feature_kind import ChoiceField, FeatureKind, NumberField, ResultKind, TextField
from core.inspect.plan.kinds import WIDEST_MM, WITH_DIRECTION
from core.messages import label

_ALIGNED = (
    ("best fit", label("best fit")),
    ("frame", label("part coordinates")),
    ("as measured", label("as measured")),
)
_DEVIATION = (
    TextField("nominal", label("Nominal surface"), label("STEP, or STL in mm, in the project's folder or elsewhere.")),
    ChoiceField("align", label("Aligned by"), label("How the nominal surface is laid on the scan."), _ALIGNED),
    NumberField(
        "tolerance_mm", label("Colours up to ±"), label("Marks + ++ +++ are its quarters, ! lies beyond."),
        "mm", 0.0001, WIDEST_MM, 4, 0.01,
    ),
    NumberField(
        "reach_mm", label("Part within"), label("Points farther off belong to a table or a clamp."),
        "mm", 0.01, WIDEST_MM, 2, 0.5,
    ),
)  # fmt: skip
_TO_A_DATUM = (label("Feature"), label("Datum"))

KINDS: tuple[FeatureKind, ...] = (
    FeatureKind(
        "parallelism",
        "core.wings.geometry.features.orientation:measure_parallelism",
        label("Parallelism to a datum"),
        label("Of the first feature to the second, its datum (ISO 1101): planes or cylinders that are in the list"),
        "mdi6.equal",
        results=(ResultKind(label("parallelism"), one_sided=True, symbol="parallelism"),),
        made_of=2,
        part_titles=_TO_A_DATUM,
        made_from=WITH_DIRECTION,
    ),
    FeatureKind(
        "perpendicularity",
        "core.wings.geometry.features.orientation:measure_perpendicularity",
        label("Perpendicularity to a datum"),
        label("Of the first feature to the second, its datum (ISO 1101): planes or cylinders that are in the list"),
        "mdi6.angle-right",
        results=(ResultKind(label("perpendicularity"), one_sided=True, symbol="perpendicularity"),),
        made_of=2,
        part_titles=_TO_A_DATUM,
        made_from=WITH_DIRECTION,
    ),
    FeatureKind(
        "position",
        "core.wings.geometry.features.position:measure_position",
        label("Position to the datums"),
        label("Of a cylinder or a sphere that is in the list, to the datums of the part's coordinates (ISO 1101)"),
        "mdi6.target",
        results=(ResultKind(label("position"), one_sided=True, symbol="position"),),
        made_of=1,
        part_titles=(label("Feature"),),
        made_from=("axis", "point"),
        settings="position",
        fields=(
            TextField(
                "at_mm",
                label("True place in mm"),
                label("Where its axis or centre should be: x; y; z in part coordinates."),
                "10; 20; 0",
            ),
        ),
    ),
    FeatureKind(
        "deviation",
        "core.wings.geometry.features.deviation:measure_deviation",
        label("Deviation from a nominal surface"),
        label("How far the surface lies off a nominal one from a STEP or STL file"),
        "mdi6.compare",
        results=(
            ResultKind(label("profile"), one_sided=True, symbol="profile of a surface"),
            ResultKind(label("mean")),
        ),
        automatic="all points",
        settings="deviation",
        fields=_DEVIATION,
        nominal_file=True,
        plotted=True,
    ),
)
